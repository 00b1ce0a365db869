"""How often the single-pixel phase slope lands in the right wrap (theory.md section 5, B/fc = 0.3)."""

import numpy as np
import pytest

from estimators import FullBandPhaseSlope
from sim import speckle_pair

FC, B = 100e3, 30e3
ROWS, SAMPLES, SPACING = 1000, 512, 24


def right_wrap(estimator, delay, snr_db):
    """Share of pixels, and its standard error between rows; pixels 18 resolution cells apart."""
    coherence = 1.0 if snr_db is None else 1 / (1 + 10 ** (-snr_db / 10))
    pair = speckle_pair(
        (ROWS, SAMPLES),
        coherence=coherence,
        delay=delay / B,
        centre_frequency=FC,
        bandwidth=B,
        sample_rate=4 / 3 * B,
        rng=np.random.default_rng([20261124, round(100 * delay), snr_db or 0]),
    )
    found = estimator.estimate(pair).delay[:, ::SPACING]
    right = np.abs(found - delay / B) < 0.5 / FC
    return right.mean(), right.mean(axis=1).std(ddof=1) / np.sqrt(ROWS)


@pytest.mark.parametrize(
    ("delay", "snr_db", "expected", "rounding"),
    [
        (0.0, None, 0.775, 0.0005),
        (0.3, None, 0.70, 0.005),
        (0.3, 30, 0.67, 0.005),
        (0.0, 15, 0.55, 0.005),
        (0.3, 15, 0.51, 0.005),
        (0.3, 5, 0.24, 0.005),
    ],
)
def test_climb_from_zero(delay, snr_db, expected, rounding):
    # Three standard errors, and the rounding of the reference: a false-alarm rate of at most 0.27 % each.
    share, error = right_wrap(FullBandPhaseSlope(refine=False), delay, snr_db)
    assert share == pytest.approx(expected, abs=3 * error + rounding), f"standard error {error:.2g}"


def test_strongest_peak_without_noise():
    share, error = right_wrap(FullBandPhaseSlope(refine=False, peak="strongest"), 0.0, None)
    assert share == pytest.approx(0.42, abs=3 * error + 0.005), f"standard error {error:.2g}"
