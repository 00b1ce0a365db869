"""Spread and wrap errors of many sub-bands, and the line through their phases against a plain fit.

Tolerances are 4.9 standard errors, from independent rows: a false-alarm rate of 1e-6 a number.
"""

import numpy as np
import pytest

from estimators import CrossCorrelation, FixedWindow, MultiChromatic, bounds
from sim import speckle_pair

FC, B = 100e3, 30e3
TRIALS, BATCHES = 40_000, 40


def patch(looks, coherence, delay=0.0, trials=TRIALS):
    rng = np.random.default_rng([20261124, looks, round(1000 * coherence)])
    return speckle_pair(
        (trials, looks), coherence=coherence, delay=delay, centre_frequency=FC, bandwidth=B, sample_rate=B, rng=rng
    )


def half_width(values):
    low, high = np.percentile(values, [100 * 0.158655, 100 * 0.841345])
    return (high - low) / 2


@pytest.fixture(scope="module")
def strong():
    """Records of 81 looks at coherence .9, and the group delay of their cross-correlation."""
    pair = patch(81, 0.9)
    window = FixedWindow(1, 81)
    return pair, CrossCorrelation(window, refine=False).estimate(pair).delay[:, 0]


def test_two_bands_have_the_bound_of_split_spectrum_with_half_bands(strong):
    pair, _ = strong
    found = MultiChromatic(FixedWindow(1, 81), bands=2, refine=False).estimate(pair).delay[:, 0]
    bound = bounds.split_spectrum_crlb(81, 0.9, B, B / 2)
    assert bound / bounds.group_delay_crlb(81, 0.9, B) == pytest.approx(2 / np.sqrt(3))
    # A phase of 40.5 looks has a spread 1.2 % above its bound; a spread's standard error is near 1 / sqrt(2 n).
    excess = bounds.multilook_phase_std(40.5, 0.9) / bounds.phase_crlb(40.5, 0.9)
    assert 1.01 < excess < 1.02
    assert found.std() / bound == pytest.approx(excess, abs=4.9 * 1.1 / np.sqrt(2 * TRIALS))


@pytest.mark.parametrize("bands", [2, 3, 5, 9, 27])
def test_bands_lose_what_lies_within_them(strong, bands):
    # C bands of equal phases: sum (f_c - mean)^2 = (B / C)^2 C (C^2 - 1) / 12, with the variance C K each, against K
    # and B^2 / 12 of the whole: 1 / (1 - 1 / C^2). On the same echoes, so that most of the excess over bounds cancels.
    pair, whole = strong
    found = MultiChromatic(FixedWindow(1, 81), bands=bands, refine=False).estimate(pair).delay[:, 0]
    batches = (np.array_split(x, BATCHES) for x in (found, whole))
    ratios = [half_width(a) / half_width(b) for a, b in zip(*batches, strict=True)]
    error = np.std(ratios, ddof=1) / np.sqrt(BATCHES)
    assert error < 0.006
    # Many bands: the group-delay bound, but for what the correlation of 81 looks is above it.
    assert half_width(found) * np.sqrt(1 - 1 / bands**2) / bounds.group_delay_crlb(81, 0.9, B) < 1.03
    assert half_width(found) / half_width(whole) == pytest.approx(1 / np.sqrt(1 - 1 / bands**2), abs=4.9 * error)


def test_refinement_reaches_the_coherent_bound(strong, oracle):
    pair, _ = strong
    estimate = MultiChromatic(FixedWindow(1, 81)).estimate(pair)
    error = estimate.delay[:, 0]
    assert np.abs(error).max() < 0.5 / FC
    # Between coherent likelihood and the phase alone, whose bound lacks B^2 / 12.
    table = oracle("efficiency").set_index(["looks", "coherence"]).loc[(81, 0.9)]
    ratio = error.std() / bounds.coherent_delay_crlb(81, 0.9, FC, B)
    tolerance = 4.9 * np.sqrt(1 / (2 * TRIALS) + 1 / (2 * 20_000))
    assert table.coherent - tolerance < ratio < table.phase * np.hypot(1, 0.3 / np.sqrt(12)) + tolerance
    assert np.median(estimate.delay_std) == pytest.approx(error.std(), rel=0.03)


@pytest.mark.parametrize("bands", [2, 3, 5])
def test_predicted_spread_of_the_group_delay(strong, bands):
    pair, _ = strong
    estimate = MultiChromatic(FixedWindow(1, 81), bands=bands, refine=False).estimate(pair)
    assert np.median(estimate.delay_std) == pytest.approx(half_width(estimate.delay[:, 0]), rel=0.04)


@pytest.mark.parametrize(
    ("bands", "looks", "coherence", "rel"),
    # Two bands by their exact formula. More as a band of the same rms width: sixteen looks a band, then eleven.
    [(2, 81, 0.5, 0.0), (5, 81, 0.5, 0.1), (3, 33, 0.5, 0.1)],
)
def test_wrap_errors_are_predicted(bands, looks, coherence, rel):
    pair = patch(looks, coherence)
    estimate = MultiChromatic(FixedWindow(1, looks), bands=bands, refine=False).estimate(pair)
    rate = (np.abs(estimate.delay[:, 0]) > 0.5 / FC).mean()
    narrower = B / FC * np.sqrt(1 - 1 / bands**2)
    expected = (
        bounds.split_spectrum_wrap_error_probability(looks, coherence, B / FC, sub_band_share=0.5)
        if bands == 2
        else bounds.wrap_error_probability(looks, coherence, narrower)
    )
    assert rate == pytest.approx(float(expected), abs=4.9 * np.sqrt(rate / TRIALS) + rel * rate)


@pytest.mark.parametrize("delay", [-2.2, 0.9, 2.2])
def test_more_bands_reach_further(delay):
    # Five bands are ambiguous beyond 2.5 / B, two beyond 1 / B.
    estimate = MultiChromatic(FixedWindow(1, 81), bands=5).estimate(patch(81, 0.99, delay / B, 200))
    np.testing.assert_allclose(estimate.delay[:, 0], delay / B, atol=0.1 / FC)
