import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sim import speckle_pair

FC, B = 100e3, 30e3


def patch(rows=400, samples=90, *, coherence=0.6, delay=0.0, sample_rate=40e3, seed=1):
    return speckle_pair(
        (rows, samples),
        coherence=coherence,
        delay=delay,
        centre_frequency=FC,
        bandwidth=B,
        sample_rate=sample_rate,
        rng=np.random.default_rng(seed),
    )


@pytest.mark.parametrize("coherence", [0.0, 0.3, 0.9])
def test_coherence_and_power_are_as_asked(coherence):
    # 27,000 looks; the false-alarm rate of 5 standard errors is 6e-7 each.
    pair = patch(coherence=coherence)
    looks = 400 * 67.5
    cross = np.mean(pair.primary.conj() * pair.secondary)
    assert cross.real == pytest.approx(coherence, abs=5 * np.sqrt((1 + coherence**2) / (2 * looks)))
    assert cross.imag == pytest.approx(0.0, abs=5 * np.sqrt((1 - coherence**2) / (2 * looks)))
    for series in (pair.primary, pair.secondary):
        assert np.mean(np.abs(series) ** 2) == pytest.approx(1.0, abs=5 / np.sqrt(looks))


def test_full_coherence_without_delay_gives_equal_series():
    pair = patch(coherence=1.0)
    np.testing.assert_array_equal(pair.primary, pair.secondary)


@settings(max_examples=20, deadline=None)
@given(st.integers(-30, 30), st.integers(0, 2**32 - 1))
def test_delay_of_whole_samples_rolls_the_series_and_turns_the_carrier(shift, seed):
    delay = shift / 40e3
    still, moved = patch(4, coherence=1.0, seed=seed), patch(4, coherence=1.0, delay=delay, seed=seed)
    expected = np.roll(still.secondary, shift, axis=1) * np.exp(-2j * np.pi * FC * delay)
    np.testing.assert_allclose(moved.secondary, expected, atol=1e-9)


def test_one_delay_for_each_row():
    delays = np.linspace(-1e-5, 1e-5, 5)
    pair = patch(5, delay=delays)
    np.testing.assert_array_equal(pair.truth.delay[:, 0], delays)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"coherence": 1.2}, "coherence is 1.2; it must lie between 0 and 1"),
        ({"coherence": np.nan}, "coherence is nan; it must be finite"),
        ({"bandwidth": -30e3}, "bandwidth is -30000 Hz; it must be above 0 Hz"),
        ({"bandwidth": 50e3}, "sample_rate is 40000 Hz; it must be at least the bandwidth, 50000 Hz"),
        ({"centre_frequency": 10e3}, "bandwidth is 30000 Hz; it must be below twice the centre frequency, 20000 Hz"),
        ({"delay": np.zeros(3)}, "delay has 3 values; it must have 1, or one for each of the 2 rows"),
        ({"delay": np.nan}, r"delay has 1 samples that are not finite, the first at \(\); all must be finite"),
    ],
)
def test_bad_values_are_named(change, message):
    good = {"coherence": 0.5, "delay": 0.0, "centre_frequency": FC, "bandwidth": B, "sample_rate": 40e3}
    with pytest.raises(ValueError, match=f"^{message}$"):
        speckle_pair((2, 64), **{**good, **change}, rng=np.random.default_rng(0))


def test_randomness_must_be_a_generator():
    with pytest.raises(TypeError, match=r"rng is 3; it must be a numpy\.random\.Generator"):
        speckle_pair((2, 64), coherence=0.5, delay=0.0, centre_frequency=FC, bandwidth=B, sample_rate=40e3, rng=3)
