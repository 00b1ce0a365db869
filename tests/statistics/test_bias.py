"""Bias against the fraction of a lag that a delay lies off the lags: below 1 % of the bound's standard deviation.

Full coherence leaves the method's own error; bounds are those at a coherence of .9. That of zero delay, where no method
but for chance has a bias, is taken from the same speckle. The standard error of a mean is asked to be below a fifth of
what is allowed, so that a method without bias fails with a chance of 1e-6.
"""

import numpy as np
import pytest

from estimators import (
    CrossCorrelation,
    FixedWindow,
    FullBandPhaseSlope,
    MaximumLikelihood,
    MultiChromatic,
    SplitSpectrum,
    TwoWindow,
    bounds,
)
from sim import speckle_pair

FC, B = 100e3, 30e3
LAG = 1 / (4 * B)
LOOKS = 81
WINDOW = FixedWindow(1, LOOKS)

REFINED = bounds.coherent_delay_crlb(LOOKS, 0.9, FC, B)
GROUP = bounds.group_delay_crlb(LOOKS, 0.9, B)
SPLIT = bounds.split_spectrum_crlb(LOOKS, 0.9, B, B / 3)
PHASE_OF_NINE = bounds.phase_crlb(9, 0.9) / (2 * np.pi * FC)

METHODS = {
    "cross-correlation": (CrossCorrelation(WINDOW), REFINED),
    "cross-correlation-group": (CrossCorrelation(WINDOW, refine=False), GROUP),
    "maximum-likelihood": (MaximumLikelihood(WINDOW), REFINED),
    "phase-slope": (FullBandPhaseSlope(WINDOW, lags_per_resolution=8), REFINED),
    "split-spectrum": (SplitSpectrum(WINDOW), REFINED),
    "split-spectrum-group": (SplitSpectrum(WINDOW, refine=False), SPLIT),
    "multi-chromatic": (MultiChromatic(WINDOW), REFINED),
    "multi-chromatic-group": (MultiChromatic(WINDOW, refine=False), GROUP),
    "two-window": (TwoWindow(CrossCorrelation(WINDOW), FixedWindow(1, 9)), PHASE_OF_NINE),
}


def errors(estimator, delay, trials):
    pair = speckle_pair(
        (trials, LOOKS),
        coherence=1.0,
        delay=delay,
        centre_frequency=FC,
        bandwidth=B,
        sample_rate=B,
        rng=np.random.default_rng(20261124),
    )
    return np.broadcast_to(estimator.estimate(pair).delay, pair.shape)[:, 0] - delay


def cases():
    for name, (estimator, bound) in METHODS.items():
        marks = [pytest.mark.long] if isinstance(estimator, SplitSpectrum | MultiChromatic) else []
        yield pytest.param(estimator, bound, id=name, marks=marks)


@pytest.mark.parametrize(("estimator", "bound"), list(cases()))
def test_bias_against_fractional_delay(estimator, bound):
    # Those that start from zero lag have an error of their own.
    trials = {SplitSpectrum: 15_000, MultiChromatic: 4_000}.get(type(estimator), 500)
    still = errors(estimator, 0.0, trials)
    for fraction in (0.1, 0.37, 0.5):
        moved = errors(estimator, fraction * LAG, trials) - still
        assert moved.std() / np.sqrt(trials) < 0.002 * bound, fraction
        assert abs(moved.mean()) < 0.01 * bound, fraction
