"""The interferogram: phase at zero lag, without a search for the wrap."""

from dataclasses import dataclass, field, replace

import numpy as np
from scipy.special import ndtr

from estimators import bounds
from estimators.estimate import DelayEstimate
from estimators.interference import interferogram_with_energy
from estimators.lag_product import power
from estimators.peak import Peak
from estimators.search import describe
from estimators.uncertainty import debiased_coherence
from estimators.windows import FixedWindow
from sim import EchoPair
from sim.band import Complex


def zero_lag(primary: Complex, secondary: Complex, window: FixedWindow) -> Peak:
    """Windowed product of the series at zero delay."""
    return Peak(
        delay=np.zeros(()),
        product=window.sum(primary.conj() * secondary),
        energy=np.sqrt(window.sum(power(primary)) * window.sum(power(secondary))),
        inside=np.ones((), dtype=np.bool_),
    )


@dataclass(frozen=True)
class Interferogram:
    """Delay within half a wrap of zero, from the phase of the windowed zero-lag interferogram.

    `delay = -arg(sum over the window of p* s) / (2 pi fc)` (paper A, equations 3 to 5). It cannot tell the wrap: a
    delay beyond half a wrap comes out in the wrong one.

    Parameters
    ----------
    window
        What to average over; a single pixel by default.
    """

    window: FixedWindow = field(default_factory=lambda: FixedWindow(1, 1))

    def estimate(self, pair: EchoPair) -> DelayEstimate:
        """Estimate the delay at every sample; ValueError where the window exceeds the pair.

        The predicted wrap-error probability takes the true delay to lie within half a wrap of zero: it is that of
        Gaussian noise carrying the phase over the edge.
        """
        self.window.check(pair)
        product, energy = interferogram_with_energy(
            pair.primary, pair.secondary, self.window.rows, self.window.samples, circular=pair.circular
        )
        peak = Peak(np.zeros(()), product, energy, np.ones((), dtype=np.bool_))
        estimate = describe(pair, self.window, peak, refine=True, search=0.5 / pair.centre_frequency)
        looks = self.window.looks(pair)
        std = bounds.phase_crlb(looks, debiased_coherence(estimate.coherence, looks))
        to_edge = np.pi - np.abs(estimate.phase)
        crossing = np.where(std > 0, ndtr(-to_edge / np.maximum(std, 1e-300)), 0.0)
        return replace(estimate, wrap_error_probability=np.minimum(crossing, 0.5))
