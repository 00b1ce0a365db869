"""The wrap from a large window, the phase from a small one."""

import numpy as np
import pytest

from estimators import CrossCorrelation, FixedWindow, FullBandPhaseSlope, TwoWindow, bounds
from estimators.moving_sum import window_sum
from sim import SONARS, Box, Scene, Wedge, simulate, speckle_pair

FC, B = 100e3, 30e3
SEED = 20261124
SCENE = Scene((15.0, 215.0), (Box(35, 5, 2), Box(70, 8, 2.5), Box(110, 10, 3), Wedge(165, 20, 2)))


@pytest.fixture(scope="module")
def boxes():
    """Paper A's scene without noise, and the single-pixel phase slope of it."""
    pair = simulate(SCENE, SONARS["hisas-100khz"], rng=np.random.default_rng(SEED), rows=4)
    return pair, (FullBandPhaseSlope().estimate(pair).delay - pair.truth.delay) * FC


@pytest.mark.parametrize("samples", [33, 81])
def test_box_scene_at_one_pixel(boxes, samples):
    pair, by_slope = boxes
    estimate = TwoWindow(CrossCorrelation(FixedWindow(1, samples))).estimate(pair)
    # Where the large window, and a resolution cell to either side of it, holds neither shadow nor layover.
    clear = window_sum(np.isnan(pair.truth.delay).astype(float)[None], 1, samples + 4, circular=True)[0] == 0
    error, by_slope = ((estimate.delay - pair.truth.delay) * FC)[:, clear], by_slope[:, clear]
    right, right_by_slope = np.abs(error) < 0.5, np.abs(by_slope) < 0.5
    assert right.size > 20_000
    assert 0.66 < right_by_slope.mean() < 0.775
    assert right.mean() > 0.99
    # Of the pixels that the phase slope got right, one may be lost; on all others the spread is compared as it is.
    both = right & right_by_slope
    assert both.sum() >= right_by_slope.sum() - 1
    assert error[both].std() <= by_slope[both].std()
    assert estimate.valid[:, clear].all()


def patch(coherence, delay, rows=400):
    rng = np.random.default_rng([SEED, round(100 * coherence)])
    return speckle_pair(
        (rows, 512), coherence=coherence, delay=delay, centre_frequency=FC, bandwidth=B, sample_rate=4 / 3 * B, rng=rng
    )


@pytest.mark.parametrize("samples", [1, 3])
def test_the_phase_is_read_where_the_echoes_meet(samples):
    # Full coherence, one wrap off zero lag, where speckle is decorrelated by sinc(.3): only interpolation errs.
    estimate = TwoWindow(CrossCorrelation(FixedWindow(1, 33)), FixedWindow(1, samples)).estimate(patch(1.0, 0.3 / B, 8))
    np.testing.assert_allclose(estimate.delay, 0.3 / B, atol=2e-5 / FC)


@pytest.mark.parametrize("coherence", [0.9, 0.97])
@pytest.mark.parametrize("samples", [1, 3, 9])
def test_spread_is_that_of_the_small_windows_phase_and_is_predicted(coherence, samples):
    delay = 0.3 / B
    estimator = TwoWindow(CrossCorrelation(FixedWindow(1, 81)), FixedWindow(1, samples))
    estimate = estimator.estimate(patch(coherence, delay))
    # The phase's error, whatever the wrap; standard errors from independent rows, false-alarm rate 1e-6 each.
    error = np.angle(np.exp(2j * np.pi * FC * (estimate.delay - delay)))
    by_row = (error**2).mean(axis=1)
    spread = np.sqrt(by_row.mean())
    tolerance = 4.9 * by_row.std(ddof=1) / np.sqrt(len(by_row)) / (2 * spread)
    if samples == 1:
        # The exact density knows one look; a few samples of speckle are not a whole number of independent looks.
        assert spread == pytest.approx(float(bounds.multilook_phase_std(1, coherence)), abs=tolerance)
    predicted = 2 * np.pi * FC * np.sqrt((estimate.delay_std**2).mean())
    assert predicted == pytest.approx(spread, rel=0.1)


def test_the_wrap_is_the_large_windows():
    # 33 samples hold 25 looks; at coherence .7 some per cent are in a wrong wrap.
    pair, wide = patch(0.7, 0.0, 100), CrossCorrelation(FixedWindow(1, 33))
    by_wide = wide.estimate(pair)
    assert 0.01 < (np.abs(by_wide.delay) > 0.5 / FC).mean() < 0.2
    estimate = TwoWindow(wide, FixedWindow(1, 9)).estimate(pair)
    assert np.abs(estimate.delay - by_wide.delay).max() <= 0.5 / FC * (1 + 1e-9)
    np.testing.assert_array_equal(estimate.wrap_error_probability, by_wide.wrap_error_probability)
