"""
Probability that the correlation envelope is larger one wrap away than at the true delay, over all speckle.

Given the line powers e_k of the primary, the two envelopes belong to a complex Gaussian pair, and the
probability that the wrong one wins is an integral over a direction delta (Simon's form of the Marcum
function). With `S_k = sin((theta_k - delta) / 2)`, `q = gamma^2 / (1 - gamma^2)` and theta_k the phase of
line k over a wrap,

    2 P = (1 / 2 pi) int_q^inf dt int d delta sqrt(det A) exp(-t sum_k e_k S_k^2),
    det A = sum_(j<k) e_j e_k sin^2((theta_j - theta_k) / 2).

For exponential e_k the exponential averages to `prod 1 / (1 + t S_k^2)` and leaves independent exponentials
of scales `1 / (1 + t S_k^2)`, over which `sqrt(det A)` is averaged. Coherence enters through the limit q
alone, so that one running integral over t serves all coherences at one number of lines.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache

import numpy as np
from scipy.interpolate import CubicSpline, PPoly

from .band_lines import band_lines
from .conventions import Floats
from .quadrature import unit_gauss_legendre

RootDeterminant = Callable[[Floats, Floats, Floats], Floats]

FEW_LINES = 14
STEP = 0.25
COARSER = 8
NODE_STEP = 0.6
NODE_REACH = 7
_FAR = 1e4


def matched_root_determinant(theta: Floats, shapes: Floats, scales: Floats) -> Floats:
    """
    Mean of `sqrt(det A)` for independent gamma line powers of given `shapes` and `scales` (..., lines).

    The first two moments of `det A` are exact; its root is taken as gamma distributed, as a Wishart matrix
    has it.
    """
    mean_power = shapes * scales
    variance = mean_power * scales
    sine2 = np.sin(0.5 * (theta[:, None] - theta)) ** 2
    partner = mean_power @ sine2
    mean = 0.5 * np.sum(mean_power * partner, axis=-1)
    return mean_root(mean, np.sum(variance * (partner**2 + 0.5 * (variance @ sine2**2)), axis=-1))


def mean_root(mean: Floats, variance: Floats) -> Floats:
    """Mean root of what has this mean and variance, if the root is gamma distributed."""
    c = variance / mean**2
    shape = (4.0 - c + np.sqrt((c - 4.0) ** 2 + 24.0 * c)) / (2.0 * c)
    result: Floats = np.sqrt(mean * shape / (shape + 1.0))
    return result


def exact_root_determinant(theta: Floats, shapes: Floats, scales: Floats) -> Floats:
    """
    Mean of `sqrt(det A)` for independent gamma line powers of given `shapes` and `scales` (..., lines).

    `sqrt(det A) = det A / pi int exp(-p' A p) d^2 p`, whose mean over the powers has a closed integrand.
    The plane is sheared to unit mean A, with the strongest line on an axis, and both axes run over sinh.
    """
    v = NODE_STEP * np.arange(-NODE_REACH, NODE_REACH + 1)
    x, y = np.sinh(v)[:, None], np.sinh(v[NODE_REACH:])
    area = NODE_STEP**2 * np.cosh(v)[:, None] * np.cosh(v[NODE_REACH:]) * np.where(y > 0.0, 2.0, 1.0)
    strongest = np.argmax(scales, axis=-1)
    cosine = np.cos(0.5 * (theta - theta[strongest][..., None]))
    sine = np.sin(0.5 * (theta - theta[strongest][..., None]))
    across = np.sum(scales * sine**2, axis=-1)
    slope = np.sum(scales * sine * cosine, axis=-1) / across
    along = np.sum(scales * cosine * (cosine - slope[..., None] * sine), axis=-1)
    first = np.sqrt(scales / along[..., None]) * (cosine - slope[..., None] * sine)
    second = np.sqrt(scales / across[..., None]) * sine
    at = first[..., None, None, :] * x[:, :, None] + second[..., None, None, :] * y[:, None]
    damping = 1.0 / (1.0 + at**2)
    power = (shapes * scales)[..., None, None, :] * damping
    sine2 = np.sin(0.5 * (theta[:, None] - theta)) ** 2
    determinant = 0.5 * np.sum((power @ sine2) * power, axis=-1)
    total = np.sum(area * np.exp(np.log(damping) @ shapes) * determinant, axis=(-2, -1))
    result: Floats = total / (np.pi * np.sqrt(along * across))
    return result


def line_directions(theta: Floats, t: Floats) -> tuple[Floats, Floats]:
    """Nodes and weights over the circle, (t, nodes), for peaks of width `2 / sqrt(t)` at the lines."""
    x, w = unit_gauss_legendre(12)
    line = np.sort(np.mod(theta, 2.0 * np.pi))
    gap = np.diff(line, append=line[0] + 2.0 * np.pi)[:, None]
    width = 2.0 / np.sqrt(t)[:, None, None]
    # Far outside the band nothing is left to integrate.
    reach = np.minimum(0.5 * gap, 30.0 * (width + np.ptp(theta)))
    span = np.arcsinh(reach / width)
    v = span * x
    offset = width * np.sinh(v)
    weight = w * span * width * np.cosh(v)
    # The lines are symmetric: the half gap after each line mirrors the half gap before another.
    return (line[:, None] + offset).reshape(t.size, -1), 2.0 * weight.reshape(t.size, -1)


def central_directions(theta: Floats, shapes: Floats, t: Floats) -> tuple[Floats, Floats]:
    """Nodes and weights over the circle, (t, nodes), for one peak at zero that many lines make."""
    half_circle = 32
    looks = np.sum(shapes)
    sine2 = np.sum(shapes * np.sin(0.5 * theta) ** 2) / looks
    pull = looks * max(1.0 - 2.0 * sine2, 1e-9)
    width = np.minimum(1.0, np.sqrt((1.0 / t + sine2) / pull))[:, None]
    half = 0.5 * np.pi * (np.arange(half_circle) + 0.5) / half_circle
    nodes = 2.0 * np.arctan(width * np.tan(half))
    jacobian = width / (np.cos(half) ** 2 + (width * np.sin(half)) ** 2)
    return nodes, 2.0 * jacobian * (np.pi / half_circle)


@lru_cache(maxsize=4096)
def log_exponent_curve(looks: int, relative_bandwidth: float) -> PPoly:
    """`log(-log(2 E[P]))` against `log q` for N > 1 whole looks; straight where P is not resolved."""
    position, shapes = band_lines(looks)
    theta = 2.0 * np.pi * relative_bandwidth * position
    mean_sine2 = float(np.sum(shapes * np.sin(0.5 * theta) ** 2) / looks)
    # To probabilities of about exp(-200), or a coherence that rounds to one.
    furthest = np.expm1(min(200.0 / looks, 46.0))
    # From where the exponent is proportional to t, whatever the direction.
    u = np.arange(np.log(1e-3 / looks), np.log(furthest / mean_sine2), STEP)
    log_density = _log_density(theta, shapes, u, matched_root_determinant)
    if looks <= FEW_LINES:
        # What the matched moments miss varies slowly.
        coarse = u[np.linspace(0, u.size - 1, u.size // COARSER + 2).astype(int)]
        missing = _log_density(theta, shapes, coarse, exact_root_determinant) - _log_density(
            theta, shapes, coarse, matched_root_determinant
        )
        log_density = log_density + CubicSpline(coarse, missing)(u)
    return _log_exponent(u, log_density)


def _log_density(theta: Floats, shapes: Floats, u: Floats, root: RootDeterminant) -> Floats:
    """Log of the integrand over `u = log t`, the directions being integrated out."""
    t = np.exp(u)
    few = theta.size <= FEW_LINES
    delta, weight = line_directions(theta, t) if few else central_directions(theta, shapes, t)
    rate = 1.0 + t[:, None, None] * np.sin(0.5 * (theta - delta[..., None])) ** 2
    log_product = -(np.log(rate) @ shapes)
    peak = np.max(log_product, axis=1)
    integrand = np.exp(log_product - peak[:, None]) * root(theta, shapes, 1.0 / rate)
    result: Floats = u + peak + np.log(np.sum(weight * integrand, axis=1) / (4.0 * np.pi))
    return result


def _log_exponent(u: Floats, log_density: Floats) -> PPoly:
    """`log(-log(tail))` over u of a density given by its log at the knots u, and `exp(u)` below them."""
    x, w = unit_gauss_legendre(6)
    nodes = u[:-1, None] + STEP * x
    piece = STEP * np.exp(CubicSpline(u, log_density)(nodes)) @ w
    below = np.exp(log_density[0]) + np.concatenate([[0.0], np.cumsum(piece)])
    above = np.concatenate([np.cumsum(piece[::-1])[::-1], [0.0]])
    total = below[0] + above[0]
    # The tail is left where it comes near underflow, and the last knot has none.
    count = int(np.count_nonzero(above > 1e-250))
    lower, upper = below[:count] / total, above[:count] / total
    exponent = np.where(lower < upper, -np.log1p(-np.minimum(lower, 0.5)), -np.log(upper))
    curve = CubicSpline(u[:count], np.log(exponent))
    last = u[count - 1]
    start = [0.0, 0.0, 1.0, float(curve(u[0])) - _FAR]
    end = [0.0, 0.0, float(curve(last, 1)), float(curve(last))]
    knots = np.concatenate([[u[0] - _FAR], u[:count], [last + _FAR]])
    return PPoly(np.column_stack([start, curve.c, end]), knots)
