"""
Cramer-Rao lower bounds of interferometric phase, delay and depth, as standard deviations.

All start from the phase-variance bound `K = (1 - gamma^2) / (2 N gamma^2)` [rad^2] of N independent looks
at coherence gamma. `looks` (N > 0, real) and `coherence` (magnitude in [0, 1]) broadcast with all other
arguments; outside these ranges the result is NaN. Zero coherence gives infinity, full coherence gives zero.
Frequencies and lengths that are not finite and positive raise ValueError.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from .conventions import Floats, positive, within


def phase_crlb(looks: ArrayLike, coherence: ArrayLike) -> Floats:
    """
    Bound of the interferometric phase [rad]: `sqrt(K)`.

    Source: Seymour and Cumming 1994; paper B (Saebo and Hansen 2023), eq. 3 without its geometry.

    Parameters
    ----------
    looks, coherence
        Independent looks N, real, above 0; coherence magnitude, 0 to 1. NaN elsewhere.

    Returns
    -------
    ndarray
        In radians; of the broadcast shape.
    """
    n = within(looks, 0.0, np.inf)
    gamma = within(coherence, 0.0, 1.0)
    # (1 - g)(1 + g) keeps all digits near g = 1, and no square underflows near g = 0.
    with np.errstate(divide="ignore", over="ignore"):
        one_look: Floats = np.sqrt(0.5 * (1.0 - gamma) * (1.0 + gamma)) / gamma
    return one_look / np.sqrt(np.where(n > 0.0, n, np.nan))


def group_delay_crlb(looks: ArrayLike, coherence: ArrayLike, bandwidth: ArrayLike) -> Floats:
    """
    Bound of the delay [s] when the phase offset is unknown: `sqrt(12 K) / (2 pi B)`, flat bandwidth B [Hz].

    Source: Fisher information of a flat band, whose mean square frequency about its centre is `B^2 / 12`.

    Parameters
    ----------
    looks, coherence
        As for `phase_crlb`.
    bandwidth
        Flat bandwidth B [Hz].

    Returns
    -------
    ndarray
        In seconds; of the broadcast shape.

    Raises
    ------
    ValueError
        For a bandwidth that is not finite and positive.
    """
    b = positive("bandwidth", bandwidth, "Hz")
    bound: Floats = phase_crlb(looks, coherence) * (12.0**0.5 / (2.0 * np.pi)) / b
    return bound


def coherent_delay_crlb(
    looks: ArrayLike, coherence: ArrayLike, centre_frequency: ArrayLike, bandwidth: ArrayLike
) -> Floats:
    """
    Bound of the delay [s] from carrier phase and band together, the wrap being known.

    `sqrt(K) / (2 pi sqrt(fc^2 + B^2 / 12))`.
    Source: Fisher information of a flat band about zero frequency.

    Parameters
    ----------
    looks, coherence
        As for `phase_crlb`.
    centre_frequency, bandwidth
        `fc` and flat bandwidth B [Hz].

    Returns
    -------
    ndarray
        In seconds; of the broadcast shape.

    Raises
    ------
    ValueError
        For a frequency that is not finite and positive.
    """
    fc = positive("centre_frequency", centre_frequency, "Hz")
    b = positive("bandwidth", bandwidth, "Hz")
    rms_frequency: Floats = np.hypot(fc, b / np.sqrt(12.0))
    return phase_crlb(looks, coherence) / (2.0 * np.pi * rms_frequency)


def split_spectrum_crlb(
    looks: ArrayLike, coherence: ArrayLike, bandwidth: ArrayLike, sub_bandwidth: ArrayLike
) -> Floats:
    """
    Bound of the delay [s] from the phase difference of the two outer sub-bands of width b [Hz].

    Group-delay bound times `sqrt(B^3 / (6 b (B - b)^2))`, least at `b = B / 3`, there `sqrt(9 / 8)`.
    `looks` counts the full band.
    Source: two independent phases of `N b / B` looks each, `B - b` apart.

    Parameters
    ----------
    looks, coherence
        As for `phase_crlb`.
    bandwidth, sub_bandwidth
        B and b [Hz].

    Returns
    -------
    ndarray
        In seconds; of the broadcast shape.

    Raises
    ------
    ValueError
        For a width that is not finite and positive, and sub-bands that overlap, `b > B / 2`.
    """
    total = positive("bandwidth", bandwidth, "Hz")
    sub = positive("sub_bandwidth", sub_bandwidth, "Hz")
    share = sub / total
    if np.any(share > 0.5):
        raise ValueError(f"sub_bandwidth is {np.max(share):g} of the bandwidth; it must be at most one half")
    loss = 1.0 / (np.sqrt(6.0 * share) * (1.0 - share))
    return group_delay_crlb(looks, coherence, total) * loss


def intensity_delay_crlb(looks: ArrayLike, coherence: ArrayLike, bandwidth: ArrayLike) -> Floats:
    """
    Bound of the delay [s] from speckle intensities alone (incoherent tracking), flat bandwidth B [Hz].

    `sqrt(3 / (10 N)) sqrt(2 + 5 gamma^2 - 7 gamma^4) / (pi gamma^2 B)`.
    Source: Bamler and Eineder 2005; the polynomial is factored as `(1 - gamma^2)(2 + 7 gamma^2)`.

    Parameters
    ----------
    looks, coherence
        As for `phase_crlb`.
    bandwidth
        Flat bandwidth B [Hz].

    Returns
    -------
    ndarray
        In seconds; of the broadcast shape.

    Raises
    ------
    ValueError
        For a bandwidth that is not finite and positive.
    """
    b = positive("bandwidth", bandwidth, "Hz")
    gamma = within(coherence, 0.0, 1.0)
    with np.errstate(divide="ignore", over="ignore"):
        excess: Floats = np.sqrt(2.0 + 7.0 * gamma**2) / gamma
        bound: Floats = 0.6**0.5 / (np.pi * b) * phase_crlb(looks, coherence) * excess
    return bound


def depth_crlb(
    looks: ArrayLike,
    coherence: ArrayLike,
    centre_frequency: ArrayLike,
    slant_range: ArrayLike,
    baseline: ArrayLike,
    sound_speed: ArrayLike = 1500.0,
) -> Floats:
    """
    Bound of the depth [m] from phase alone, the wrap being known: `(r c / D) sqrt(K) / (2 pi fc)`.

    Source: paper B (Saebo and Hansen 2023), eq. 3.

    Parameters
    ----------
    looks, coherence
        As for `phase_crlb`.
    centre_frequency, slant_range, baseline, sound_speed
        `fc` [Hz], r [m], vertical baseline D [m] and c [m/s].

    Returns
    -------
    ndarray
        In metres; of the broadcast shape.

    Raises
    ------
    ValueError
        For a frequency, length or speed that is not finite and positive.
    """
    return phase_crlb(looks, coherence) * depth_of_phase(centre_frequency, slant_range, baseline, sound_speed)


def depth_of_phase(
    centre_frequency: ArrayLike, slant_range: ArrayLike, baseline: ArrayLike, sound_speed: ArrayLike
) -> Floats:
    """Depth that a phase of one radian stands for [m]: `r c / (2 pi fc D)`; arguments as in `depth_crlb`."""
    fc = positive("centre_frequency", centre_frequency, "Hz")
    r = positive("slant_range", slant_range, "m")
    d = positive("baseline", baseline, "m")
    c = positive("sound_speed", sound_speed, "m/s")
    depth: Floats = (r * c / d) / (2.0 * np.pi * fc)
    return depth
