import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sim.band import Band, TimeGrid

SAMPLES = st.integers(1, 200)
OVERSAMPLING = st.floats(1.0, 20.0)


def test_period_is_a_whole_number_of_samples_and_cannot_be_given():
    assert TimeGrid(7, 4.0).period == 1.75
    with pytest.raises(TypeError):
        TimeGrid(7, 4.0, period=1.7)
    with pytest.raises(ValueError, match=r"samples is 7\.5; it must be a whole number"):
        TimeGrid(7.5, 4.0)


@given(SAMPLES, OVERSAMPLING)
def test_weights_hold_the_whole_band_below_nyquist(samples, oversampling):
    grid = TimeGrid(samples, 1.0)
    bandwidth = 1 / oversampling
    if bandwidth * samples < 1:
        with pytest.raises(ValueError, match="the series lasts"):
            Band(grid, bandwidth)
        return
    band = Band(grid, bandwidth)
    nyquist_bins = samples - (samples + 1) % 2
    assert band.weights.sum() == pytest.approx(min(bandwidth * samples, nyquist_bins), abs=1 + 1e-9)
    if bandwidth * samples <= samples - 1:
        assert band.weights.sum() == pytest.approx(bandwidth * samples, abs=1e-6)
    assert np.all(band.harmonics == -band.harmonics[::-1])
    assert np.all((band.weights >= 0) & (band.weights <= 1))


@pytest.mark.parametrize("samples", [9, 33, 81, 603])
def test_critically_sampled_record_has_as_many_looks_as_samples(samples):
    assert Band(TimeGrid(samples, 30e3), 30e3).looks == pytest.approx(samples, rel=1e-12)


def test_series_is_the_plain_sum_of_its_harmonics():
    rng = np.random.default_rng(1)
    band = Band(TimeGrid(20, 3.0, start=5.0), 2.0)
    spectrum = rng.normal(size=(2, len(band.harmonics))) + 0j
    since_start = np.arange(20) / 3.0
    direct = spectrum @ np.exp(2j * np.pi * np.outer(band.harmonics / (20 / 3.0), since_start))
    np.testing.assert_allclose(band.series(spectrum), direct, atol=1e-12)
