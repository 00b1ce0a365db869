"""
Probability that one wrong delay is more likely than the true one, for a coherent likelihood.

Both likelihoods differ by a quadratic form of Gaussians, with `K(s) = -sum_k ln((1 - l_k+ s)(1 - l_k-
s))`. Its saddle point `-gamma / (1 - gamma^2)` is common to all lines, and on the vertical through it
the integrand is real:

    P = (1 / pi) int_0^inf dt / (1 + t^2) prod_k (1 + q (1 + t^2) sin^2(theta_k / 2))^-1,

with `q = gamma^2 / (1 - gamma^2)` and theta_k the phase of line k over the lag. It equals the inversion
integral of theory section 3, and keeps its relative accuracy in the tail. Real looks N stand for the
Gauss rule of N lines.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike
from scipy.special import ndtr

from .conventions import MOST_LOOKS, Floats, signal_strength, within
from .envelope_pair import band_lines

Pair = Callable[[Floats, Floats, Floats], Floats]

STEP = 0.25


def pair_probability(sine2: Floats, shapes: Floats, q: Floats) -> Floats:
    """P for line values `sin^2(theta_k / 2)` and `shapes`, both (..., lines), and `q` (...)."""
    weighted = q[..., None] * sine2
    level = np.sum(shapes * np.log1p(weighted), axis=-1)
    curvature = np.sum(shapes * weighted / (1.0 + weighted), axis=-1)
    scale = 1.0 / np.sqrt(np.maximum(1.0, curvature))
    total = np.full(level.shape, 0.5)
    share = weighted / (1.0 + weighted)
    for w in STEP * np.arange(1, 89):
        t2 = (scale * np.sinh(w)) ** 2
        fall = np.sum(shapes * np.log1p(share * t2[..., None]), axis=-1)
        total += np.cosh(w) / (1.0 + t2) * np.exp(-fall)
    result: Floats = np.exp(-level) * total * scale * STEP / np.pi
    return result


def coherent_pair_probability(looks: ArrayLike, coherence: ArrayLike, relative_bandwidth: ArrayLike) -> Floats:
    """
    Exact probability that the likelihood one wrap away exceeds the one at the true delay.

    `looks` N is real, 1 to 1e9, `coherence` in [0, 1], `relative_bandwidth` `B / fc` above 0 and below
    2; they broadcast, and outside these ranges the result is NaN. Twice it is the two-sided
    nearest-wrap rate.
    """
    return _over_lines(looks, coherence, relative_bandwidth, pair_probability)


def lugannani_rice_pair_probability(looks: ArrayLike, coherence: ArrayLike, relative_bandwidth: ArrayLike) -> Floats:
    """
    Saddle-point approximation of `coherent_pair_probability`, with the same arguments.

    `Q(r) + phi(r) (1 / v - 1 / r)`, `r^2 = 2 sum ln(1 + x_k)`, `v^2 = 2 sum x_k / (1 + x_k)`,
    `x_k = q sin^2(theta_k / 2)` (Lugannani and Rice 1980).
    """
    return _over_lines(looks, coherence, relative_bandwidth, _lugannani_rice)


def _lugannani_rice(sine2: Floats, shapes: Floats, q: Floats) -> Floats:
    x = q[..., None] * sine2
    r2 = 2.0 * np.sum(shapes * np.log1p(x), axis=-1)
    v2 = 2.0 * np.sum(shapes * x / (1.0 + x), axis=-1)
    r, v = np.sqrt(r2), np.sqrt(v2)
    distinct = v2 > 0.0
    correction = (r2 - v2) / np.where(distinct, (r + v) * r * v, 1.0)
    result: Floats = ndtr(-r) + np.exp(-0.5 * r2) / np.sqrt(2.0 * np.pi) * correction
    return result


def _over_lines(looks: ArrayLike, coherence: ArrayLike, relative_bandwidth: ArrayLike, function: Pair) -> Floats:
    ratio = within(relative_bandwidth, 0.0, 2.0)
    ratio = np.where((ratio > 0.0) & (ratio < 2.0), ratio, np.nan)
    n, gamma, ratio = np.broadcast_arrays(within(looks, 1.0, MOST_LOOKS), within(coherence, 0.0, 1.0), ratio)
    result = np.full(n.shape, np.nan)
    valid = np.isfinite(n + gamma + ratio)
    q = signal_strength(gamma)
    for value in np.unique(n[valid]):
        chosen = valid & (n == value)
        theta, shapes = band_lines(float(value), 1.0)
        sine2 = np.sin(0.5 * ratio[chosen][:, None] * theta) ** 2
        result[chosen] = function(sine2, shapes, q[chosen])
    return result
