"""Neighbours combined to a requested accuracy."""

from dataclasses import replace

import numpy as np
import pytest

from estimators import (
    CombinedNeighbours,
    CrossCorrelation,
    FixedWindow,
    FullBandPhaseSlope,
    TwoWindow,
    VaryingWindow,
    bounds,
    conformance,
)
from sim import speckle_pair

FC, B = 100e3, 30e3


@pytest.fixture(scope="module")
def speckle():
    """Single pixels at 15 dB, half of which are in a wrong wrap."""
    pair = speckle_pair(
        (40, 256),
        coherence=float(bounds.coherence_from_snr(10**1.5)),
        delay=0.3 / B,
        centre_frequency=FC,
        bandwidth=B,
        sample_rate=4 / 3 * B,
        rng=np.random.default_rng(20261124),
    )
    return pair, FullBandPhaseSlope().estimate(pair)


@pytest.mark.parametrize("std", [0.02, 0.01, 0.006])
def test_single_pixels_are_combined_to_what_was_asked_for(speckle, std):
    pair, single = speckle
    assert 0.4 < np.mean(np.abs(single.delay - 0.3 / B) < 0.5 / FC) < 0.6
    combined = CombinedNeighbours(std=std / FC).estimate(pair)
    error = (combined.delay - 0.3 / B) * FC
    assert combined.valid.mean() > 0.99
    # Few neighbours, enough for a spread of .02, leave one wrong wrap in a thousand; more leave none.
    assert (np.abs(error) < 0.5)[combined.valid].mean() > (0.998 if std > 0.01 else 0.9999)
    by_row = (error**2).mean(axis=1)
    spread = np.sqrt(by_row.mean())
    # Rows are independent; false-alarm rate 1e-6.
    noise = 4.9 * by_row.std(ddof=1) / np.sqrt(len(by_row)) / (2 * spread)
    assert spread < std + noise
    claimed = FC * np.sqrt((combined.delay_std**2).mean())
    assert spread == pytest.approx(claimed, rel=0.25, abs=noise)


def test_what_cannot_be_reached_is_said(speckle):
    pair, _ = speckle
    combined = CombinedNeighbours(std=1e-4 / FC).estimate(pair)
    assert not combined.valid.any()
    assert np.all(combined.delay_std > 1e-4 / FC)
    # The largest window is taken all the same.
    assert np.std(combined.delay) < 0.005 / FC


def test_more_is_not_averaged_than_is_needed(speckle):
    pair, single = speckle
    alone = CombinedNeighbours(std=1.0).estimate(pair)
    sure = single.valid & (single.wrap_error_probability < 0.1)
    assert 0.4 < sure.mean() < 0.6
    np.testing.assert_allclose(alone.delay[sure], single.delay[sure], rtol=0, atol=1e-12 / FC)
    np.testing.assert_allclose(alone.delay_std[sure], single.delay_std[sure], rtol=0.1)


@pytest.mark.parametrize(
    "estimator", [CombinedNeighbours(std=5e-7), CombinedNeighbours(CrossCorrelation(FixedWindow(1, 9)), std=2e-7)]
)
def test_it_does_what_every_estimator_must(estimator):
    assert conformance.findings(estimator) == []


def test_neighbours_of_windows_that_vary_claim_no_more_than_of_fixed_ones(speckle):
    """Windows of 9 x 9 at every time, said either way, are the same windows."""
    pair, _ = speckle
    fixed = FixedWindow(9, 9)
    sizes = np.full(pair.shape[1], 9)
    one, other = (
        CombinedNeighbours(CrossCorrelation(window), std=1e-4 / FC, windows=(fixed,)).estimate(pair)
        for window in (fixed, VaryingWindow(sizes, sizes))
    )
    np.testing.assert_allclose(other.delay_std, one.delay_std, rtol=1e-9)


def test_neighbours_of_two_windows_share_that_of_the_phase(speckle):
    pair, _ = speckle
    method = TwoWindow(CrossCorrelation(FixedWindow(9, 9)), phase=FixedWindow(5, 5))
    combined = CombinedNeighbours(method, std=1e-5 / FC, windows=(FixedWindow(5, 5),)).estimate(pair)
    inner = slice(8, -8)
    spread = np.sqrt(np.mean((combined.delay[inner] - 0.3 / B) ** 2))
    claimed = np.sqrt(np.mean(combined.delay_std[inner] ** 2))
    # 24 rows of 256 samples have 300 windows of both sizes side by side: 5 standard errors of 1 / sqrt(2 n).
    assert spread < claimed * (1 + 5 / np.sqrt(2 * 300))


def test_combinations_that_cannot_be():
    with pytest.raises(ValueError, match=r"^std is 0 s; it must be above 0 s$"):
        CombinedNeighbours(std=0.0)
    with pytest.raises(ValueError, match=r"^estimator is 3; it must have a method estimate\(pair\)$"):
        CombinedNeighbours(3)
    with pytest.raises(ValueError, match=r"^windows are empty; there must be one or more$"):
        CombinedNeighbours(windows=())


def test_neighbours_that_are_not_valid_are_not_counted():
    """Of a window of 65 with one valid neighbour in 64, one counts. 1e-6 of false alarm, the spread of few dozen."""
    pair = speckle_pair(
        (1500, 256),
        coherence=0.95,
        delay=0.2 / FC,
        centre_frequency=FC,
        bandwidth=B,
        sample_rate=B,
        rng=np.random.default_rng(65),
    )
    masked = CombinedNeighbours(FewValid(), std=1.0 / FC, windows=[FixedWindow(1, 65)]).estimate(pair)
    at = masked.valid[:, 128] & (masked.wrap_error_probability[:, 128] < 0.01)
    ratio = (masked.delay[at, 128] - 0.2 / FC) / masked.delay_std[at, 128]
    rms = np.sqrt(np.mean(ratio[np.abs(ratio) < 6] ** 2))
    assert at.sum() > 1000
    # The claims of single windows hold to 5 %; a rms of n has a standard error of 1 / sqrt(2 n).
    assert abs(rms - 1) < 0.05 + 4.9 / np.sqrt(2 * at.sum())


class FewValid:
    """Cross-correlations of which one in 64 is valid."""

    window = FixedWindow(1, 17)

    def estimate(self, pair):
        estimate = CrossCorrelation(self.window).estimate(pair)
        return replace(estimate, valid=estimate.valid & (np.arange(pair.shape[1]) % 64 == 0))
