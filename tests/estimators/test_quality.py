"""Metrics of quality on cases whose answer is known, and the area under a ROC against its definition."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from estimators import CrossCorrelation, FixedWindow, FullBandPhaseSlope
from estimators.quality import METRICS, agreement, brightness, coherence, curvature, likelihood, peak_ratio, roc_area
from sim import speckle_pair

FC, B = 100e3, 30e3
PIXEL, NINE = FixedWindow(1, 1), FixedWindow(1, 9)


@settings(max_examples=50, deadline=None)
@given(st.integers(2, 30), st.integers(2, 30), st.integers(1, 6), st.integers(0, 2**32 - 1))
def test_the_area_counts_pairs(right, wrong, values, seed):
    rng = np.random.default_rng(seed)
    good, bad = rng.integers(0, values, right) / values, rng.integers(0, values, wrong) / values
    pairs = (good[:, None] > bad).mean() + 0.5 * (good[:, None] == bad).mean()
    metric, is_right = np.concatenate([good, bad]), np.arange(right + wrong) < right
    assert roc_area(metric, is_right)[0] == pytest.approx(pairs)


def test_the_error_of_the_area_is_its_spread():
    # 400 samples of normal scores one standard deviation apart, whose area is Phi(1 / sqrt(2)) = .7602.
    rng = np.random.default_rng(20261124)
    right = np.arange(300) < 200
    found = np.array([roc_area(rng.normal(size=300) + right, right) for _ in range(400)])
    spread = found[:, 0].std(ddof=1)
    assert found[:, 0].mean() == pytest.approx(0.76025, abs=4.9 * spread / 20)
    # A standard deviation of 400 samples has a relative error of 3.5 %; 4.9 of these.
    assert found[:, 1].mean() == pytest.approx(spread, rel=0.18)


def test_an_area_needs_both():
    assert np.isnan(roc_area(np.ones(3), np.ones(3, dtype=bool))).all()


def patch(rows=4, level=1 / (1 + 10**-1.5), circular=True):
    pair = speckle_pair(
        (rows, 256),
        coherence=level,
        delay=0.3 / B,
        centre_frequency=FC,
        bandwidth=B,
        sample_rate=4 / 3 * B,
        rng=np.random.default_rng(1),
    )
    return replace(pair, circular=circular)


@pytest.mark.parametrize("metric", METRICS.values(), ids=METRICS)
@pytest.mark.parametrize("circular", [True, False])
def test_metrics_are_shares_of_the_shape_of_the_pair(metric, circular):
    pair = patch(circular=circular)
    estimate = FullBandPhaseSlope().estimate(pair)
    for window in (PIXEL, FixedWindow(3, 9)):
        found = metric(pair, estimate, window)
        assert found.shape == pair.shape
        assert np.isfinite(found).all()
        assert found.min() >= 0
        assert found.max() <= 1


@pytest.mark.parametrize("metric", METRICS.values(), ids=METRICS)
def test_silence_has_no_quality_that_is_no_number(metric):
    pair = patch()
    silent = replace(pair, primary=0 * pair.primary)
    assert np.isfinite(metric(silent, CrossCorrelation(NINE).estimate(silent), NINE)).all()


@pytest.mark.parametrize("gain", [1e-155, 1e150])
def test_brightness_does_not_depend_on_the_gain(gain):
    pair = patch()
    estimate = CrossCorrelation(NINE).estimate(pair)
    loud = replace(pair, primary=gain * pair.primary, secondary=gain * pair.secondary)
    np.testing.assert_allclose(brightness(loud, estimate, NINE), brightness(pair, estimate, NINE), rtol=1e-12)


def test_what_they_say_of_echoes_without_noise():
    pair = patch(level=1.0)
    whole = FixedWindow(1, 256)
    estimate = CrossCorrelation(whole).estimate(pair)
    np.testing.assert_allclose(coherence(pair, estimate, whole), 1, atol=1e-4)
    np.testing.assert_allclose(likelihood(pair, estimate, whole), 1, atol=1e-6)
    np.testing.assert_array_equal(agreement(pair, estimate, NINE), 1)
    # 192 looks of a flat band: the curvature of sinc^2, whose first side lobe lies beyond 1 / B.
    np.testing.assert_allclose(curvature(pair, estimate, whole), 0.5, atol=0.05)
    np.testing.assert_array_equal(peak_ratio(pair, estimate, whole), np.ones(pair.shape))
    assert np.mean(brightness(pair, estimate, PIXEL)) < 0.5


def test_the_coherence_of_a_single_look_is_one():
    pair = patch()
    np.testing.assert_array_equal(coherence(pair, FullBandPhaseSlope().estimate(pair), PIXEL), 1.0)


def test_agreement_counts_the_others():
    pair = replace(patch(1), circular=False)
    estimate = CrossCorrelation(NINE).estimate(pair)
    delay = np.where(np.arange(256) % 4 == 0, 1.0, 0.0)[None]
    found = agreement(pair, replace(estimate, delay=delay), FixedWindow(1, 5))
    # Of two neighbours on either side: at an odd one out none agree; next to it three do, and in between two of four.
    np.testing.assert_array_equal(found[0, 8:12], [0, 0.75, 0.5, 0.75])
    np.testing.assert_array_equal(found[0, :2], [0, 2 / 3])


def test_the_quality_of_a_pixel_tells_outliers():
    # Half of the single pixels are in a wrong wrap at 15 dB; brightness alone tells them with .73.
    pair = patch(40)
    estimate = FullBandPhaseSlope().estimate(pair)
    right = np.abs(estimate.delay - 0.3 / B) < 0.5 / FC
    assert 0.4 < right.mean() < 0.6
    assert roc_area(estimate.quality, right)[0] > 0.999
    assert 0.68 < roc_area(brightness(pair, estimate, PIXEL), right)[0] < 0.78
