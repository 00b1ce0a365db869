"""Ziv-Zakai bound: the least spread of a delay estimate, wraps included."""

import numpy as np
from numpy.typing import ArrayLike
from scipy.special import log_ndtr

from sim.band import Real

DELAYS = 4000
"""Delays at which the error probability of a pair is taken."""


def coherent_pair_error(looks: float, coherence: float, cycles: Real, relative_bandwidth: float) -> Real:
    """Probability that coherent maximum likelihood prefers a delay that is off to the right one.

    The difference of the two correlations is a quadratic form of Gaussian numbers with the cumulant function
    `K(s) = -sum_k ln(1 - x_k (2 gamma s + (1 - gamma^2) s^2))`, `x_k = sin^2(pi cycles (1 + f_k / fc))`. Its saddle
    point is `s = -gamma / (1 - gamma^2)` whatever the delay, where `K = -sum ln(1 + q x_k)` with
    `q = gamma^2 / (1 - gamma^2)`, and `K'' = 2 (1 - gamma^2) sum x_k / (1 + q x_k)`. The probability that the
    difference is negative follows from these (Lugannani and Rice 1980): within 1 % at 9 looks and 0.1 % at 81.

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
    x = np.sin(half_turn) ** 2
    incoherent = (1 - coherence) * (1 + coherence)
    q = coherence**2 / incoherent
    scale = looks / bins
    w = -np.sqrt(2 * scale * np.log1p(q * x).sum(axis=1))
    u = -coherence * np.sqrt(2 * scale * (x / (1 + q * x)).sum(axis=1) / incoherent)
    # Towards no delay both vanish, and neither delay is preferred.
    apart = w < -1e-4
    w, u = np.where(apart, w, -1.0), np.where(apart, u, -1.0)
    tail = np.exp(log_ndtr(w)) + np.exp(-(w**2) / 2) / np.sqrt(2 * np.pi) * (1 / w - 1 / u)
    probability: Real = np.where(apart, np.clip(tail, 0.0, 0.5), 0.5)
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
