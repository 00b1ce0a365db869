"""What coherence, signal-to-noise ratio and looks mean to each other."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.special import sici

Floats = NDArray[np.float64]
MOST_LOOKS = 1e9
MOST_STRENGTH = 1e200


def within(value: ArrayLike, low: float, high: float) -> Floats:
    """`value` as floats, NaN where it is not in [low, high]."""
    x = np.asarray(value, dtype=np.float64)
    return np.where((x >= low) & (x <= high), x, np.nan)


def open_ratio(relative_bandwidth: ArrayLike) -> Floats:
    """`B / fc` as floats, NaN where it is not above 0 and below 2."""
    ratio = np.asarray(relative_bandwidth, dtype=np.float64)
    return np.where((ratio > 0.0) & (ratio < 2.0), ratio, np.nan)


def sub_band_looks(looks: ArrayLike, share: float) -> Floats:
    """Looks of a sub-band of `share` of the band, in [1, 1e9] and NaN elsewhere."""
    n = np.asarray(looks, dtype=np.float64) * share
    # A third of three may round to less than one.
    return within(np.where(np.abs(n - 1.0) < 1e-12, 1.0, n), 1.0, MOST_LOOKS)


def checked_looks_and_coherence(looks: ArrayLike, coherence: ArrayLike) -> tuple[Floats, Floats]:
    """Looks in [1, 1e9] and coherence in [0, 1] of one shape, for a sampler; ValueError elsewhere."""
    n, gamma = np.broadcast_arrays(within(looks, 1.0, MOST_LOOKS), within(coherence, 0.0, 1.0))
    if np.any(np.isnan(n)):
        raise ValueError(f"looks is {np.asarray(looks)}; it must be in [1, {MOST_LOOKS:g}]")
    if np.any(np.isnan(gamma)):
        raise ValueError(f"coherence is {np.asarray(coherence)}; it must be in [0, 1]")
    return n, gamma


def signal_strength(gamma: Floats) -> Floats:
    """`q = gamma^2 / (1 - gamma^2)`, held at 1e200 where gamma is one."""
    with np.errstate(divide="ignore"):
        return np.minimum(gamma / (1.0 - gamma) * (gamma / (1.0 + gamma)), MOST_STRENGTH)


def positive(name: str, value: ArrayLike, unit: str) -> Floats:
    """`value` as floats; ValueError unless every element is finite and above zero."""
    x = np.asarray(value, dtype=np.float64)
    bad = ~(np.isfinite(x) & (x > 0))
    if np.any(bad):
        raise ValueError(f"{name} is {x[bad].flat[0]:g} {unit}; it must be finite and positive")
    return x


def coherence_from_snr(snr: ArrayLike) -> Floats:
    """
    Coherence magnitude `gamma = rho / (1 + rho)` of two equally noisy channels.

    An infinite ratio gives 1.
    Source: common signal, independent noise of equal power in both channels (theory section 2).

    Parameters
    ----------
    snr
        Power ratio of one channel, 0 to infinity; NaN where negative.

    Returns
    -------
    ndarray
        Coherence, 0 to 1; of the same shape.
    """
    rho = within(snr, 0.0, np.inf)
    with np.errstate(divide="ignore"):
        return 1.0 / (1.0 + 1.0 / rho)


def snr_from_coherence(coherence: ArrayLike) -> Floats:
    """
    Signal-to-noise ratio `rho = gamma / (1 - gamma)` (power ratio) of two equally noisy channels.

    Full coherence gives infinity.
    Source: paper B (Saebo and Hansen 2023), eq. 4.

    Parameters
    ----------
    coherence
        Magnitude, 0 to 1; NaN elsewhere.

    Returns
    -------
    ndarray
        Power ratio, not in dB; of the same shape.
    """
    gamma = within(coherence, 0.0, 1.0)
    with np.errstate(divide="ignore"):
        return gamma / (1.0 - gamma)


def effective_looks(time_bandwidth: ArrayLike) -> Floats:
    """
    Equivalent independent looks `N_eff` of a boxcar window of length T on speckle of flat bandwidth B.

    A window of no length has one look.
    `1 / N_eff = 2 int_0^1 (1 - u) sinc(B T u)^2 du`, which with `x = pi B T` is
    `2 Si(2 x) / x - 2 (sin(x) / x)^2 - Cin(2 x) / x^2`, where `Cin(z) = int_0^z (1 - cos t) / t dt`.
    Source: theory section 2, the variance of a mean of correlated intensities.

    Parameters
    ----------
    time_bandwidth
        `B T`, 0 to 1e300; NaN elsewhere.

    Returns
    -------
    ndarray
        Looks, 1 or more; of the same shape.
    """
    x = np.pi * within(time_bandwidth, 0.0, 1e300)
    # Cin = euler + log - Ci cancels near zero, where three terms of the series are exact to rounding.
    small = x < 0.01
    y = np.where(small, 1.0, x)
    si, ci = sici(2.0 * y)
    cin = np.euler_gamma + np.log(2.0 * y) - ci
    inverse = 2.0 * si / y - 2.0 * (np.sin(y) / y) ** 2 - cin / y / y
    z = np.where(small, x, 0.0)
    series = 1.0 - z**2 / 18.0 + 2.0 * z**4 / 675.0
    return 1.0 / np.where(small, series, inverse)
