"""
Probability that a delay estimator picks a wrong carrier period.

The envelope pair compares correlation envelopes at the true delay and one wrap (`1 / fc`) away; twice its
probability predicts the cross-correlation with phase refinement and the coherent maximum-likelihood search.
Source of the equations: theory section 3.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .conventions import MOST_LOOKS, Floats, open_ratio, within
from .envelope_pair import log_exponent_curve

Curve = Callable[[int, Floats], Floats]

NODES = np.unique(np.concatenate([np.arange(2, 21), np.round(np.geomspace(21, 1.3e9, 100))])).astype(np.int64)


def wrap_error_probability(looks: ArrayLike, coherence: ArrayLike, relative_bandwidth: ArrayLike) -> Floats:
    """
    Predicted wrap-error probability of a cross-correlation with phase refinement, and of coherent
    likelihood.

    `2 E[P_env]` at lag `1 / fc`: the nearest wrap on either side only, averaged over the speckle
    spectra of N lines of exponential power. That is the rate of the unrefined envelope peak; where the phase
    refines it, and of the likelihood, the rate is up to 1.15 times as high at `B / fc` = .3 and 1.45 times at
    .6, at 1e-6: `cross_correlation_wrap_error_probability` and `likelihood_wrap_error_probability` have that.

    One look cannot tell wraps apart and gives 1.
    Within 1e-3 of the exact average at whole looks for rates down to 1e-20, at up to 14 looks to 1e-60; above,
    within 6 % to 1e-35, and no more than the order of magnitude below.
    Real looks are interpolated smoothly between whole ones. It falls with coherence and, for bands up to the centre
    frequency, with looks and bandwidth; beyond, so few as two and three lines may alias.
    Source: theory section 3, envelope pair.

    Parameters
    ----------
    looks, coherence
        Independent looks, real, 1 to 1e9; coherence magnitude, 0 to 1. NaN elsewhere.
    relative_bandwidth
        `B / fc`, above 0 and below 2; NaN elsewhere.

    Returns
    -------
    ndarray
        Probability, 0 to 1; of the broadcast shape.
    """
    return 2.0 * envelope_pair_probability(looks, coherence, relative_bandwidth)


def envelope_pair_probability(looks: ArrayLike, coherence: ArrayLike, relative_bandwidth: ArrayLike) -> Floats:
    """
    Probability that the envelope one wrap away exceeds the one at the true delay, averaged over speckle.

    One half of `wrap_error_probability`.
    Source: theory section 3, envelope pair.

    Parameters
    ----------
    looks, coherence, relative_bandwidth
        As for `wrap_error_probability`.

    Returns
    -------
    ndarray
        Probability, 0 to 1/2; of the broadcast shape.
    """
    n, gamma, ratio = np.broadcast_arrays(
        within(looks, 1.0, MOST_LOOKS), within(coherence, 0.0, 1.0), open_ratio(relative_bandwidth)
    )
    result = np.full(n.shape, np.nan)
    valid = np.isfinite(n + gamma + ratio)
    for value in np.unique(ratio[valid]):
        chosen = valid & (ratio == value)
        result[chosen] = 0.5 * np.exp(-_exponent(n[chosen], gamma[chosen], float(value)))
    return result


def several_wraps_error_probability(
    looks: ArrayLike, coherence: ArrayLike, relative_bandwidth: ArrayLike, wraps: int
) -> Floats:
    """
    Union of the wrap errors: `2 sum_m E[P_env]` at lags `m / fc`, m = 1 to `wraps`, at most 1.

    An upper bound of the probability that any of `wraps` whole wraps on either side wins; a search, which
    also ends between them, may err more often in bands about as wide as the centre frequency.
    Lags beyond half the window, `m B / fc > N / 2`, are left out.
    Source: theory section 3, envelope pair.

    Parameters
    ----------
    looks, coherence, relative_bandwidth
        As for `wrap_error_probability`.
    wraps
        Whole wraps on either side, at least 1.

    Returns
    -------
    ndarray
        Probability, 0 to 1; of the broadcast shape.

    Raises
    ------
    ValueError
        For less than one wrap.
    """
    if wraps < 1:
        raise ValueError(f"wraps is {wraps}; it must be at least 1")
    nearest = wrap_error_probability(looks, coherence, relative_bandwidth)
    n, gamma, ratio = np.broadcast_arrays(within(looks, 1.0, MOST_LOOKS), coherence, open_ratio(relative_bandwidth))
    total = np.array(nearest)
    for m in range(2, wraps + 1):
        near = np.isfinite(nearest) & (m * ratio <= 0.5 * n)
        for value in np.unique(ratio[near]):
            chosen = near & (ratio == value)
            total[chosen] += np.exp(-_exponent(n[chosen], gamma[chosen], float(m * value)))
    return np.minimum(total, 1.0)


def _exponent(looks: Floats, gamma: Floats, ratio: float) -> Floats:
    """`-log(2 E[P])`; its ratio to `N - 1` is interpolated in logs over N between whole looks."""
    with np.errstate(divide="ignore"):
        log_q = np.clip(2.0 * np.log(gamma) - np.log1p(-gamma) - np.log1p(gamma), -1e3, 1e3)
    height = over_looks(looks, NODES, log_q, lambda whole, x: log_exponent_curve(whole, ratio)(x) - np.log(whole - 1.0))
    exponent = np.where(gamma < 1.0, np.exp(np.minimum(height, 700.0)), np.inf)
    exponent = np.where(looks > 1.0, exponent, 0.0) * (looks - 1.0)
    few = (looks > 1.0) & (looks < 2.0) & (gamma < 1.0)
    if np.any(few):
        exponent[few] = _between_one_and_two(looks[few], gamma[few], ratio)
    return exponent


def _between_one_and_two(looks: Floats, gamma: Floats, ratio: float) -> Floats:
    """The parabola from zero at one look that joins with its slope at two, kept from falling."""
    step = 1e-3
    two = _exponent(np.full(looks.shape, 2.0), gamma, ratio)
    slope = np.clip((_exponent(np.full(looks.shape, 2.0 + step), gamma, ratio) - two) / step, 0.0, 2.0 * two)
    u = looks - 1.0
    result: Floats = u * (2.0 * two - slope - (two - slope) * u)
    return result


def over_looks(looks: Floats, nodes: NDArray[np.int64], log_q: Floats, curve: Curve) -> Floats:
    """A curve of `log q` that is known at whole looks, interpolated in log N between them; one-dimensional."""
    first, weights = stencil(looks, nodes)
    height = np.zeros(looks.shape)
    for node in range(int(np.min(first)), int(np.max(first)) + 4):
        member = node - first
        used = np.flatnonzero((member >= 0) & (member < 4))
        weight = weights[used, member[used]]
        used, weight = used[weight != 0.0], weight[weight != 0.0]
        if used.size:
            height[used] += weight * curve(int(nodes[node]), log_q[used])
    return height


def stencil(looks: Floats, nodes: NDArray[np.int64]) -> tuple[NDArray[np.int64], Floats]:
    """First of four neighbouring nodes and their Lagrange weights in log N; below two looks, those of two."""
    x = np.log(np.maximum(looks, 2.0))
    first = np.clip(np.searchsorted(nodes, looks, side="right") - 2, 0, nodes.size - 4)
    at = np.log(nodes)[first[:, None] + np.arange(4)]
    weights = np.ones(at.shape)
    for i in range(4):
        for j in range(4):
            if i != j:
                weights[:, i] *= (x - at[:, j]) / (at[:, i] - at[:, j])
    return first, weights
