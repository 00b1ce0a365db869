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

from .band_lines import MAX_LINES, band_lines
from .conventions import MOST_LOOKS, Floats, open_ratio, signal_strength, within

Pair = Callable[[Floats, Floats, Floats], Floats]

STEP = 0.25
REACH = 23.0
CHUNK = 256
_SMALLEST = 750.0


def pair_probability(sine2: Floats, shapes: Floats, q: Floats, step: float = STEP, reach: float = REACH) -> Floats:
    """
    P for line values `sin^2(theta_k / 2)` and `shapes`, both (..., lines), and `q` (...).

    By trapezoids over asinh of t in units of the integrand's width; what lies beyond `reach` is below
    `exp(-reach)`.
    """
    weighted = q[..., None] * sine2
    level = np.sum(shapes * np.log1p(weighted), axis=-1)
    share = weighted / (1.0 + weighted)
    scale = 1.0 / np.sqrt(np.maximum(1.0, np.sum(shapes * share, axis=-1)))
    total = np.full(level.shape, 0.5)
    for w in np.arange(step, reach, step):
        t2 = (scale * np.sinh(w)) ** 2
        fall = np.sum(shapes * np.log1p(share * t2[..., None]), axis=-1)
        term = np.cosh(w) / (1.0 + t2) * np.exp(-fall)
        total += term
        if np.all(term < 1e-17 * total):
            break
    result: Floats = np.exp(-level) * total * scale * step / np.pi
    return result


def coherent_pair_probability(looks: ArrayLike, coherence: ArrayLike, relative_bandwidth: ArrayLike) -> Floats:
    """
    Exact probability that the likelihood one wrap away exceeds the one at the true delay.

    Twice it is the two-sided nearest-wrap rate. Relative error below 1e-6, in the tail too.
    Source: the inversion integral of theory section 3, along the vertical through its saddle point.

    Parameters
    ----------
    looks, coherence, relative_bandwidth
        As for `wrap_error_probability`.

    Returns
    -------
    ndarray
        Probability, 0 to 1/2; of the broadcast shape.
    """
    return _over_lines(looks, coherence, relative_bandwidth, pair_probability)


def lugannani_rice_pair_probability(looks: ArrayLike, coherence: ArrayLike, relative_bandwidth: ArrayLike) -> Floats:
    """
    Saddle-point approximation of `coherent_pair_probability`.

    `Q(r) + phi(r) (1 / v - 1 / r)`, `r^2 = 2 sum ln(1 + x_k)`, `v^2 = 2 sum x_k / (1 + x_k)`,
    `x_k = q sin^2(theta_k / 2)` (Lugannani and Rice 1980).

    Parameters
    ----------
    looks, coherence, relative_bandwidth
        As for `wrap_error_probability`.

    Returns
    -------
    ndarray
        Probability, about 0 to 1/2; of the broadcast shape.
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
    n, gamma, ratio = np.broadcast_arrays(
        within(looks, 1.0, MOST_LOOKS), within(coherence, 0.0, 1.0), open_ratio(relative_bandwidth)
    )
    result = np.array(0.0 * (n + gamma + ratio))
    q = signal_strength(gamma)
    needed = np.where(np.isnan(result), 0, lines_needed(n, q, ratio))
    for most in np.unique(needed[needed > 0]):
        chosen = np.flatnonzero(needed == most)
        for some in np.array_split(chosen, chosen.size // CHUNK + 1):
            position, shapes = band_lines(n.flat[some], int(most))
            sine2 = np.sin(np.pi * ratio.flat[some][:, None] * position) ** 2
            result.flat[some] = function(sine2, shapes, q.flat[some])
    return result


def lines_needed(n: Floats, q: Floats, ratio: Floats) -> Floats:
    """
    Lines of the Gauss rule that give `sum ln(1 + q sin^2(theta / 2))` to 1e-7: 20, 40, ... to N.

    The sum is analytic in an ellipse about the band that reaches `2 asinh(q^-1/2)` off the real axis. Zero
    lines where the four in ten of them between 1/8 and 3/8 of the band alone make the probability underflow.
    """
    beyond = np.clip(2.0 * np.arcsinh(1.0 / np.sqrt(np.maximum(q, 1e-300))) / (np.pi * ratio), 1e-9, 1e9)
    rate = np.arcsinh(beyond)
    enough = np.minimum((np.log(n) + 17.0) / (2.0 * rate), n)
    tiers = MAX_LINES * 2.0 ** np.ceil(np.log2(np.maximum(enough / MAX_LINES, 1.0)))
    vanishes = (n > MAX_LINES) & (0.4 * n * np.log1p(q * np.sin(0.125 * np.pi * ratio) ** 2) > _SMALLEST)
    return np.where(vanishes, 0.0, tiers)
