"""From coherence and looks to the spread that an estimate has to expect."""

import numpy as np

from estimators import bounds
from estimators.lag_product import power, scale_of
from estimators.peak import Peak
from estimators.posterior import ROUNDING, Looks, phase_std
from estimators.windows import Window
from sim import EchoPair
from sim.band import Real


def debiased_coherence(sample_coherence: Real, looks: Looks) -> Real:
    """Coherence that a sample coherence stands for; a single look, which says nothing, stands for none."""
    if np.ndim(looks) == 0:
        return bounds.debias_coherence(sample_coherence, looks) if looks > 1 else np.zeros_like(sample_coherence)
    # A number of looks by itself costs a fifth of an array of them.
    debiased = np.empty(np.broadcast_shapes(np.shape(sample_coherence), np.shape(looks)))
    of_all = np.broadcast_to(sample_coherence, debiased.shape)
    distinct, which = np.unique(looks, return_inverse=True)
    for number, n in enumerate(distinct.tolist()):
        at = which == number
        debiased[..., at] = debiased_coherence(of_all[..., at], n)
    return debiased


def predicted_std(bound: Real, search: float) -> Real:
    """A bound's standard deviation, at most that of a guess anywhere in `-search` to `search` [s]."""
    std: Real = np.minimum(bound, search / np.sqrt(3))
    return std


def small_window_std(pair: EchoPair, peak: Peak, small: Window, large: Window, coherence: Real) -> Real:
    """Standard deviation of the delay [s] from the phase of a small window, whose coherence a large one tells.

    Given the magnitudes in the small window the phase has von Mises' density, of concentration
    `2 gamma |C| / ((1 - gamma^2) E)` with the product `C` summed over its looks and the mean energy `E` of a look:
    dark pixels have poor phases.

    Parameters
    ----------
    pair
        The echoes.
    peak
        The small window's lag product at the delay.
    small, large
        The windows.
    coherence
        The large window's, debiased, shape (rows, time).
    """
    # On the scale of the peak.
    scaled = (np.asarray(x * scale_of(x), dtype=np.complex128) for x in (pair.primary, pair.secondary))
    powers = [large.sum(power(series)) for series in scaled]
    mean = np.sqrt(powers[0]) * np.sqrt(powers[1]) / large.pixels
    here = np.abs(peak.product) / small.pixels
    relative = np.divide(here, mean, out=np.zeros(pair.shape), where=mean > 0)
    # The mean of 1 / (1 - g^2) of N looks is (N - 1) / (N - 2) times what it estimates.
    freedom = np.maximum(large.looks(pair), 3.0)
    noise = np.maximum((1 - coherence) * (1 + coherence), ROUNDING**2) * (freedom - 1) / (freedom - 2)
    concentration = 2 * coherence / noise * relative * small.looks(pair)
    std: Real = phase_std(concentration) / (2 * np.pi * pair.centre_frequency)
    return std
