"""Ziv-Zakai bound: the least spread of a delay estimate, wraps included."""

import numpy as np
from numpy.typing import ArrayLike
from scipy.special import log_ndtr

from sim.band import Real

DELAYS = 4000
"""Delays at which the error probability of a pair is taken."""


def coherent_pair_error(looks: float, coherence: float, cycles: Real, relative_bandwidth: float) -> Real:
    """Probability that coherent maximum likelihood prefers a delay that is off to the right one.

    The difference of the two correlations is a quadratic form of Gaussian numbers: with
    `c_k = 1 - exp(2 pi i cycles (1 + f_k / fc))` it has for each Fourier bin the weights
    `l = (gamma Re c +- sqrt(gamma^2 (Re c)^2 + (1 - gamma^2) |c|^2)) / 2`. The probability that it is negative comes
    from the cumulant function `K(s) = -sum ln(1 - l s)` at its saddle point (Lugannani and Rice 1980): within 1 % at 9
    looks and 0.1 % at 81.

    Parameters
    ----------
    looks
        Independent looks, `N`; a number that is not whole scales the sum over the next whole number of bins.
    coherence
        `gamma`, 0 to 1.
    cycles
        How far off the delay is, times the centre frequency; shape (delay,).
    relative_bandwidth
        `B / fc`.

    Returns
    -------
    array
        Shape (delay,), 0 to 1/2 or a little above where coherence is low.
    """
    bins = max(int(np.ceil(looks)), 1)
    share = (np.arange(bins) - (bins - 1) / 2) / bins
    half_turn = np.pi * cycles[:, None] * (1 + relative_bandwidth * share)
    # Re c = 2 sin^2 and |c|^2 = 4 sin^2 of half the angle.
    sine = np.abs(np.sin(half_turn))
    root = np.sqrt((coherence * sine) ** 2 + (1 - coherence) * (1 + coherence))
    weights = np.concatenate([sine * (coherence * sine + root), sine * (coherence * sine - root)], axis=1)
    return _probability_below_zero(weights, looks / bins)


def _probability_below_zero(weights: Real, scale: float) -> Real:
    """P(sum of `weights` times exponential numbers < 0), the cumulants scaled; a weight sum above zero."""
    largest = np.abs(weights).max(axis=1, keepdims=True)
    weights = weights / np.where(largest > 0, largest, 1.0)
    low = 1 / np.minimum(weights.min(axis=1), -1e-300)
    point = np.zeros(len(weights))
    upper, lower = np.zeros(len(weights)), np.maximum(low, -1e12)
    for _ in range(60):
        point = (upper + lower) / 2
        slope = (weights / (1 - weights * point[:, None])).sum(axis=1)
        upper, lower = np.where(slope > 0, point, upper), np.where(slope > 0, lower, point)
    terms = weights / (1 - weights * point[:, None])
    cumulant = -scale * np.log1p(-weights * point[:, None]).sum(axis=1)
    curvature = scale * (terms**2).sum(axis=1)
    w = -np.sqrt(np.maximum(-2 * cumulant, 0.0))
    u = point * np.sqrt(curvature)
    regular = (w < -1e-4) & (u < 0)
    with np.errstate(divide="ignore", invalid="ignore"):
        tail = np.exp(log_ndtr(w)) + np.exp(-(w**2) / 2) / np.sqrt(2 * np.pi) * (1 / w - 1 / u)
    probability: Real = np.clip(np.where(regular, tail, 0.5), 0.0, 0.5)
    return probability


def ziv_zakai_delay_std(
    looks: ArrayLike, coherence: ArrayLike, centre_frequency: ArrayLike, bandwidth: ArrayLike, prior_width: ArrayLike
) -> Real:
    """Least root mean square error of a delay that is uniform over a known width, wraps included.

    `MSE >= int_0^T h V{(1 - h / T) P(h)} dh` with the pair error `P` of `coherent_pair_error` and valley filling `V`
    (Ziv and Zakai 1969; Bellini and Tartara 1974).

    Parameters
    ----------
    looks, coherence
        `N` and `gamma`.
    centre_frequency, bandwidth
        `fc` and `B` [Hz].
    prior_width
        Width of the range that the delay is known to lie in, `T` [s].

    Returns
    -------
    array
        [s]; broadcast. At most the prior's own `T / sqrt(12)`, and 0 at coherence 1. NaN outside the limits.
    """
    std: Real = np.vectorize(_scalar, otypes=[float])(looks, coherence, centre_frequency, bandwidth, prior_width)
    return std


def _scalar(looks: float, coherence: float, centre_frequency: float, bandwidth: float, prior_width: float) -> float:
    if not (looks > 0 and 0 <= coherence <= 1 and centre_frequency > 0 and bandwidth > 0 and prior_width > 0):
        return np.nan
    if coherence in (0, 1):
        return 0.0 if coherence else float(prior_width / np.sqrt(12))
    cycles = prior_width * centre_frequency
    # Spacing grows from far below the spread within a wrap to a small part of a wrap.
    spread = np.sqrt((1 - coherence) * (1 + coherence) / (2 * looks)) / coherence / (2 * np.pi)
    start = min(spread, cycles) * 1e-3
    offsets = np.unique(
        np.concatenate([np.geomspace(start, cycles, DELAYS // 2), np.linspace(0, cycles, DELAYS // 2)[1:]])
    )
    error = (1 - offsets / cycles) * coherent_pair_error(looks, coherence, offsets, bandwidth / centre_frequency)
    filled = np.maximum.accumulate(error[::-1])[::-1]
    variance = float(np.trapezoid(offsets * filled, offsets))
    return float(min(np.sqrt(variance), cycles / np.sqrt(12)) / centre_frequency)
