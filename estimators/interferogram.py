"""The interferogram: phase at zero lag, without a search for the wrap."""

from dataclasses import dataclass, field, replace

import numpy as np

from estimators.estimate import DelayEstimate
from estimators.interference import interferogram_with_energy
from estimators.lag_product import power, scale_of
from estimators.moving_sum import product_sum, window_sum
from estimators.peak import Peak
from estimators.posterior import beyond_edge
from estimators.search import describe
from estimators.windows import FixedWindow, Window, WindowPolicy
from sim import EchoPair


@dataclass(frozen=True)
class Interferogram:
    """Delay within half a wrap of zero, from the phase of the windowed zero-lag interferogram.

    `delay = -arg(sum over the window of p* s) / (2 pi fc)` (paper A, equations 3 to 5). It cannot tell the wrap: a
    delay beyond half a wrap comes out in the wrong one. Time grows as the pixels do, and not with the window.

    Parameters
    ----------
    window
        What to average over, or the policy that says it for a pair; a single pixel by default.
    """

    window: WindowPolicy = field(default_factory=lambda: FixedWindow(1, 1))

    def estimate(self, pair: EchoPair) -> DelayEstimate:
        """Estimate the delay at every sample; ValueError where the window exceeds the pair.

        The predicted wrap-error probability takes the true delay to lie within half a wrap of zero: it is that of
        noise carrying the phase over the edge, Student's t of `sin(phi) g sqrt(2N - 2) / sqrt(1 - g^2)`.
        """
        window = self.window.on(pair)
        window.check(pair)
        estimate = describe(pair, window, at_zero_lag(pair, window), refine=True, search=0.5 / pair.centre_frequency)
        crossing = beyond_edge(estimate.coherence, estimate.phase, window.looks(pair))
        return replace(estimate, wrap_error_probability=crossing, quality=1 - crossing)


def at_zero_lag(pair: EchoPair, window: Window) -> Peak:
    """Windowed product of the series of a pair at zero delay, and its energy, on a scale near 1."""
    if isinstance(window, FixedWindow):
        product, energy = interferogram_with_energy(
            pair.primary, pair.secondary, window.rows, window.samples, circular=pair.circular
        )
    else:
        sizes = window.rows, window.samples
        p, s = (np.asarray(series * scale_of(series), np.complex128) for series in (pair.primary, pair.secondary))
        product = product_sum(p, s, *sizes, circular=pair.circular)
        # Both energies as one complex sum.
        energies = window_sum(power(p) + 1j * power(s), *sizes, circular=pair.circular)
        energy = np.sqrt(energies.real * energies.imag)
    return Peak(np.zeros(()), product, energy, np.ones((), dtype=np.bool_))
