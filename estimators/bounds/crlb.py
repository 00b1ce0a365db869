"""Cramér-Rao bounds of phase and delay, as standard deviations."""

import numpy as np
from numpy.typing import ArrayLike

from sim.band import Real


def phase_crlb(looks: ArrayLike, coherence: ArrayLike) -> Real:
    """Bound of the interferometric phase.

    `sqrt(K)` with `K = (1 - gamma^2) / (2 N gamma^2)` (Rodriguez and Martin 1992; paper B, equation 3).

    Parameters
    ----------
    looks
        Independent looks, `N`, above 0.
    coherence
        Magnitude of the complex coherence, `gamma`, 0 to 1.

    Returns
    -------
    array
        [rad]; broadcast. Infinite at coherence 0, 0 at coherence 1, NaN outside the limits.
    """
    looks, coherence = np.asarray(looks, dtype=float), np.asarray(coherence, dtype=float)
    allowed = (looks > 0) & (coherence >= 0) & (coherence <= 1)
    with np.errstate(divide="ignore", invalid="ignore"):
        bound = np.sqrt((1 - coherence) * (1 + coherence) / (2 * looks)) / coherence
    std: Real = np.where(allowed, bound, np.nan)
    return std


def group_delay_crlb(looks: ArrayLike, coherence: ArrayLike, bandwidth: ArrayLike) -> Real:
    """Bound of the group delay, the phase offset being unknown.

    `sqrt(12 K) / (2 pi B)` with `K` of `phase_crlb`: that of a delay from the slope of the phase over a flat band.

    Parameters
    ----------
    looks, coherence
        As for `phase_crlb`.
    bandwidth
        `B` [Hz].

    Returns
    -------
    array
        [s]; broadcast.
    """
    std: Real = phase_crlb(looks, coherence) * np.sqrt(12) / (2 * np.pi * np.asarray(bandwidth, dtype=float))
    return std


def coherent_delay_crlb(
    looks: ArrayLike, coherence: ArrayLike, centre_frequency: ArrayLike, bandwidth: ArrayLike
) -> Real:
    """Bound of the delay from phase and slope together, the wrap being known.

    `sqrt(K) / (2 pi sqrt(fc^2 + B^2 / 12))` with `K` of `phase_crlb`.

    Parameters
    ----------
    looks, coherence
        As for `phase_crlb`.
    centre_frequency, bandwidth
        `fc` and `B` [Hz].

    Returns
    -------
    array
        [s]; broadcast.
    """
    centre_frequency, bandwidth = np.asarray(centre_frequency, dtype=float), np.asarray(bandwidth, dtype=float)
    std: Real = phase_crlb(looks, coherence) / (2 * np.pi * np.hypot(centre_frequency, bandwidth / np.sqrt(12)))
    return std


def split_spectrum_crlb(looks: ArrayLike, coherence: ArrayLike, bandwidth: ArrayLike, sub_bandwidth: ArrayLike) -> Real:
    """Bound of the group delay from the phases of two sub-bands at the ends of the band.

    The group-delay bound times `sqrt(B^3 / (6 b (B - b)^2))`; least, `sqrt(9 / 8)`, at `b = B / 3`.

    Parameters
    ----------
    looks, coherence
        As for `phase_crlb`; looks of the full band.
    bandwidth, sub_bandwidth
        `B` and `b` [Hz], `0 < b <= B / 2`.

    Returns
    -------
    array
        [s]; broadcast. NaN outside the limits.
    """
    bandwidth, sub_bandwidth = np.asarray(bandwidth, dtype=float), np.asarray(sub_bandwidth, dtype=float)
    share = sub_bandwidth / bandwidth
    allowed = (share > 0) & (share <= 0.5)
    share = np.where(allowed, share, np.nan)
    std: Real = group_delay_crlb(looks, coherence, bandwidth) / np.sqrt(6 * share * (1 - share) ** 2)
    return std
