"""Coherence over range: measured without bias, from a curve, from the sonar equation."""

from dataclasses import replace

import numpy as np
import pytest
from paper_b import FC, GEOMETRY, SONAR, B, C, D, H, pair_at, patch

from estimators import FixedWindow, Interferogram, KnownCoherence, MeasuredCoherence, ModelledCoherence, bounds
from sim import expected_coherence


def test_what_debiasing_does_to_the_predicted_spread():
    # Theory section 6: 32.4 looks of coherence .187 read .231, and the spread is then promised 21 % too small.
    read = float(bounds.sample_coherence_mean(32.4, 0.187))
    assert read == pytest.approx(0.231, abs=0.0005)
    slant = np.hypot(400.0, H)
    promised, true = (float(bounds.depth_crlb(32.4, g, FC, slant, D, C)) for g in (read, 0.187))
    assert promised / true == pytest.approx(0.802, abs=0.002)
    debiased = float(bounds.depth_crlb(32.4, bounds.debias_coherence(read, 32.4), FC, slant, D, C))
    assert debiased == pytest.approx(true, rel=1e-6)


@pytest.mark.parametrize("coherence", [0.05, 0.187, 0.7, 0.999])
def test_measured_coherence_is_not_biased(coherence):
    pair = patch(coherence)
    found = MeasuredCoherence(9, 5, smoothing=20.0).over_time(pair, GEOMETRY)
    looks = FixedWindow(9, 5).looks(pair)
    # Of the whole patch, windows of so many looks beside each other; those that overlap tell a little more. Their mean
    # is off by 4.9 standard errors once in 1e6, and moves the coherence by the slope of its mean sample coherence.
    independent = 81 * 20.0 / (C / 2) * B / looks / 1.5
    step = 1e-3 * (1 - coherence)
    slope = np.diff(bounds.sample_coherence_mean(looks, [coherence, coherence + step])).item() / step
    tolerance = 4.9 * float(bounds.sample_coherence_std(looks, coherence) / slope) / np.sqrt(independent)
    assert found.mean() == pytest.approx(coherence, abs=tolerance)
    # The sample coherence as it is would fail by far where the coherence is low.
    if coherence < 0.2:
        assert Interferogram(FixedWindow(9, 5)).estimate(pair).coherence.mean() > coherence + 2 * tolerance


def test_measured_coherence_of_what_is_silent_or_small():
    pair = patch(0.9, rows=2, samples=40)
    nothing = np.zeros(pair.shape, dtype=complex)
    over_time = MeasuredCoherence().over_time
    np.testing.assert_array_equal(over_time(replace(pair, primary=nothing), GEOMETRY), 0.0)
    # Where half of it is silent, the other half says it.
    half = np.arange(40) < 20
    found = over_time(replace(pair, primary=pair.primary * half, secondary=pair.secondary * half), GEOMETRY)
    assert (found[:15] > 0.5).all()
    assert (found[30:35] > 0.5).all()
    one = patch(0.9, rows=1, samples=2)
    one = replace(one, primary=one.primary[:, :1], secondary=one.secondary[:, :1], circular=False)
    np.testing.assert_array_equal(over_time(one, GEOMETRY), 0.0)


def test_coherence_from_a_curve_and_from_the_sonar_equation():
    pair = pair_at(100.0, (3, 4096))
    ground = np.sqrt((C / 2 * pair.grid.times) ** 2 - H**2)
    curve = KnownCoherence([0.9, 0.5], [110.0, 130.0]).over_time(pair, pair.geometry)
    np.testing.assert_allclose(curve, np.clip(0.9 - 0.02 * (ground - 110.0), 0.5, 0.9), rtol=1e-12)
    of_silt = ModelledCoherence("silt").over_time(pair, pair.geometry)
    np.testing.assert_allclose(of_silt, expected_coherence(SONAR, "silt", ground))


def test_a_curve_that_falls_back_is_refused_in_one_line():
    with pytest.raises(ValueError, match=r"^ground_range has 0 m behind 0 m; it must rise$"):
        KnownCoherence(np.zeros(50), np.zeros(50))
