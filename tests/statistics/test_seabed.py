"""Coherence of simulated echoes of a seabed against the one that sonar equation and geometry predict.

The whole swath is cut into windows. In each, rows are independent, and leaving them out one by one gives the standard
error of the debiased coherence whatever its causes: baseline decorrelation takes away an edge of the band, as narrow as
30 Hz at long range, so that its loss is one speckle pattern over tens of metres and looks do not count it.
"""

import numpy as np
import pytest
from scipy import stats

from estimators import FixedWindow, bounds
from sim import SONARS, Scene, expected_coherence, simulate

SONAR = SONARS["hisas-1032"]
ROWS, SAMPLES = 80, 64
SWATH = (42.0, 400.0)


def swath_windows(pair):
    """Starts of windows side by side, and ground range of every sample."""
    slant = pair.grid.times * SONAR.sound_speed / 2
    ground_range = np.sqrt(np.maximum(slant**2 - SONAR.altitude**2, 0.0))
    first, last = np.searchsorted(ground_range, SWATH)
    return np.arange(first, last - SAMPLES, SAMPLES), ground_range


def debiased(cross, energies, looks):
    """Coherence from sums, whose bias is that of the looks in them."""
    return bounds.debias_coherence(np.abs(cross) / np.sqrt(energies[0] * energies[1]), looks)


def measured(pair, starts):
    """Debiased coherence of each window, and its standard error by leaving out rows."""
    series = [part[:, starts[:, None] + np.arange(SAMPLES)] for part in (pair.primary, pair.secondary)]
    cross = np.sum(series[0].conj() * series[1], axis=2)
    energies = [np.sum(np.abs(part) ** 2, axis=2) for part in series]
    looks = FixedWindow(1, SAMPLES).looks(pair)
    whole = debiased(cross.sum(0), [energy.sum(0) for energy in energies], ROWS * looks)
    without = debiased(cross.sum(0) - cross, [energy.sum(0) - energy for energy in energies], (ROWS - 1) * looks)
    # In the hyperbolic arctangent the spread does not depend on the coherence.
    values = np.arctanh(without)
    error = np.sqrt((ROWS - 1) / ROWS * np.sum((values - values.mean(axis=0)) ** 2, axis=0))
    return np.arctanh(whole), error


@pytest.mark.parametrize(
    ("name", "model"), [("coarse sand", "small-slope"), ("silt", "small-slope"), ("rock", "apl-uw")]
)
def test_debiased_coherence_follows_the_prediction_over_the_whole_swath(name, model):
    scene = Scene((35.0, 412.0), sediment=name, scattering=model)
    pair = simulate(scene, SONAR, rng=np.random.default_rng(20261124), rows=ROWS)
    starts, ground_range = swath_windows(pair)
    found, error = measured(pair, starts)
    middle = starts[:, None] + np.arange(SAMPLES)
    predicted = np.mean(expected_coherence(SONAR, name, ground_range[middle], model=model), axis=1)
    deviation = (found - np.arctanh(predicted)) / error
    assert len(starts) > 250
    # Student's t of 79 degrees of freedom. No window of them all deviates at a false-alarm rate of 1e-6,
    limit = stats.t.isf(0.5e-6 / len(starts), ROWS - 1)
    assert np.abs(deviation).max() < limit
    # nor do they on average, where noise prevails and windows are independent: 1e-6 each for mean and spread.
    noisy = deviation[predicted < 0.97]
    assert len(noisy) > 20
    assert abs(noisy.mean()) < 4.9 / np.sqrt(len(noisy))
    low, high = stats.chi2.ppf([0.5e-6, 1 - 0.5e-6], len(noisy)) / len(noisy)
    assert low < np.mean(noisy**2) * (ROWS - 3) / (ROWS - 1) < high
