"""Climbs from a prior delay: against a plain walk, and against what theory says of single pixels."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from estimators import CrossCorrelation, FixedWindow, FullBandPhaseSlope
from estimators.climb import first_from
from estimators.peak import first_from_zero
from sim import speckle_pair

FC, B = 100e3, 30e3


def walk(heights, place):
    """Up the steeper side, step by step, until no neighbour is higher."""
    up = [heights[place + step] if 0 <= place + step < len(heights) else -np.inf for step in (1, -1)]
    if max(up) <= heights[place]:
        return place
    step = 1 if up[0] >= up[1] else -1
    while 0 <= place + step < len(heights) and heights[place + step] > heights[place]:
        place += step
    return place


@settings(max_examples=100, deadline=None)
@given(st.integers(1, 12), st.integers(0, 2**32 - 1))
def test_the_climb_is_a_walk(reach, seed):
    rng = np.random.default_rng(seed)
    # Few values, so that neighbours are often equal.
    heights = rng.integers(0, 5, (2 * reach + 1, 2, 3)).astype(float)
    start = rng.integers(-2, 2 * reach + 3, (2, 3))
    found = first_from(heights, start)
    for place in np.ndindex(2, 3):
        begin = min(max(start[place], 0), 2 * reach)
        assert found[place] == walk(heights[:, *place], begin)
    np.testing.assert_array_equal(first_from(heights, np.full((2, 3), reach)), first_from_zero(heights))


def patch(delay, rows=200):
    return speckle_pair(
        (rows, 512),
        coherence=1.0,
        delay=delay,
        centre_frequency=FC,
        bandwidth=B,
        sample_rate=4 / 3 * B,
        rng=np.random.default_rng([20261124, round(1e9 * delay)]),
    )


def test_from_the_true_delay_every_delay_is_as_good_as_zero():
    # A climb that begins at the truth stays in its wrap for .775 of pixels without noise, as theory says of zero;
    # one from zero to 0.3 / B ends there for .70. Rows are independent; false-alarm rate 1e-6.
    delay = 0.3 / B
    found = FullBandPhaseSlope(refine=False, start=delay).estimate(patch(delay)).delay[:, ::24]
    right = (np.abs(found - delay) < 0.5 / FC).mean(axis=1)
    assert right.mean() == pytest.approx(0.775, abs=4.9 * right.std(ddof=1) / np.sqrt(len(right)) + 0.0005)


def test_a_prior_is_a_number_an_array_or_another_estimator():
    pair, window = patch(0.2 / B, 4), FixedWindow(1, 33)
    prior = CrossCorrelation(window).estimate(pair)
    by_array, by_estimator = (
        FullBandPhaseSlope(start=start).estimate(pair) for start in (prior.delay, CrossCorrelation(window))
    )
    np.testing.assert_array_equal(by_array.delay, by_estimator.delay)
    plain, from_zero = (FullBandPhaseSlope(start=start).estimate(pair) for start in (None, 0.0))
    np.testing.assert_array_equal(plain.delay, from_zero.delay)
    np.testing.assert_array_equal(plain.valid, from_zero.valid)
    assert np.mean(by_array.delay != plain.delay) > 0.02


def test_a_prior_that_is_no_number_gives_nothing_valid_and_one_beyond_the_search_begins_at_its_end():
    pair = patch(0.0, 2)
    start = np.where(np.arange(512) < 100, np.nan, 0.0)
    estimate = FullBandPhaseSlope(start=start).estimate(pair)
    assert not estimate.valid[:, :100].any()
    assert estimate.valid[:, 100:].mean() > 0.9
    assert np.isfinite(estimate.delay).all()
    far, end = (FullBandPhaseSlope(start=delay, search=1 / B).estimate(pair).delay for delay in (1.0, 1 / B))
    np.testing.assert_array_equal(far, end)


def test_priors_that_cannot_be():
    with pytest.raises(ValueError, match=r"^start has the shape \(3,\); it must broadcast to that of the pair, .*$"):
        FullBandPhaseSlope(start=np.zeros(3)).estimate(patch(0.0, 2))
    with pytest.raises(ValueError, match=r"^start is given and peak is 'strongest'; it must be 'first', .*$"):
        FullBandPhaseSlope(start=0.0, peak="strongest")
