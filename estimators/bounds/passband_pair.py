"""
Probability that the passband correlation peaks higher around some wrong lag than at the true delay.

Given the line powers e_k of the primary, the passband correlations at the truth and at a rival l wraps away differ by
a Gaussian whose mean over its deviation is `|v|`, `v_k = sqrt(2 q e_k) S_k`, with `S_k = sin(pi r_k l)`,
`r_k = 1 + f_k / fc` and `q = gamma^2 / (1 - gamma^2)`; v points along the noise that makes the rival win. While l runs
over a cell of lags, a wrap wide, v runs over a curve, and its rivals win with the probability

    P = (1 / 2 pi) int |d direction(v)| exp(-|v|^2 / 2)
      = (1 / 2) int_q^inf dt int dl sqrt(det A) exp(-t sum_k e_k S_k^2),
    det A = sum_(j<k) e_j e_k (S_j C_k - S_k C_j)^2,    C_k = r_k cos(pi r_k l).

For large q this is, to leading order, the number of pairs of a peak near the truth and a higher one in the cell (Kac
and Rice's formula, both peaks moving with their phase). Where v stays in a plane it is exact: a Gaussian beyond a curve
(Craig's and Simon's form). With `r = 1` in C and with its l a whole wrap in the phases of f_k, v is half a great circle
and this is the envelope pair. Exponential e_k are averaged as in `envelope_pair`.

A cross-correlation errs where its envelope still rises at the lag of opposite phase. Phase and slope there are two
combinations of the noise, constant and linear in frequency; v is projected onto their plane, lines of regression on f
for S and C.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from scipy.interpolate import PchipInterpolator

from .band_lines import band_lines
from .conventions import Floats
from .envelope_pair import mean_root
from .quadrature import unit_gauss_legendre

ALL_LINES = 12
LINES = 8
FEW_LINES = 5
STEP = 0.35
OFFSET = 2.0
_LEAST = 1e-50
_DEEPEST = 120.0
_LAST = 33.0
_FAR = 1e4
_MANY = 1_000_000
_ROUNDS = 7


@lru_cache(maxsize=4096)
def log_pair_curve(
    looks: int, relative_bandwidth: float, cell: tuple[float, float], projected: bool
) -> PchipInterpolator:
    """
    `log(2 - log P)` of one `cell` of lags (wraps) against `log q`, for N > 1 whole looks; straight below 1e-50.

    `projected` is for the envelope's peak, else the passband's. Without coherence P cannot depend on looks, and is
    scaled by a few percent at most, for bands up to the centre frequency, to that of many.
    """
    u, tail = _tail(looks, relative_bandwidth, cell, projected)
    tail = tail / tail[0] * _without_coherence(relative_bandwidth, cell, projected)
    count = int(np.count_nonzero(tail > _LEAST))
    curve = np.log(OFFSET - np.log(tail[:count]))
    rise = (curve[-1] - curve[-2]) / STEP
    knots = np.concatenate([[u[0] - _FAR], u[:count], [u[count - 1] + _FAR]])
    return PchipInterpolator(knots, np.concatenate([curve[:1], curve, [curve[-1] + rise * _FAR]]))


@lru_cache(maxsize=4096)
def _without_coherence(relative_bandwidth: float, cell: tuple[float, float], projected: bool) -> float:
    """The integral over all t for many looks."""
    return float(_tail(_MANY, relative_bandwidth, cell, projected)[1][0])


def _tail(looks: int, relative_bandwidth: float, cell: tuple[float, float], projected: bool) -> tuple[Floats, Floats]:
    """Knots `u = log t`, and the integral of the density above each; nothing is added below the first."""
    position, shapes = band_lines(looks, ALL_LINES if looks <= ALL_LINES else LINES)
    offset = relative_bandwidth * position
    middle = 0.5 * (cell[0] + cell[1])
    typical = np.sum(shapes * np.sin(np.pi * offset * middle) ** 2) / looks
    last = np.log(np.expm1(min(_DEEPEST / looks, 46.0)) / typical) + 3.0
    u = np.arange(np.log(3e-4 / looks), min(last, _LAST), STEP)
    t = np.exp(u)
    lag, weight = _lags(offset, shapes, t, cell)
    sine, cosine = _rival(offset, lag)
    if projected:
        kept, root = _projected(offset, shapes, t, sine, cosine)
    else:
        kept, root = sine**2, _root(_wedge2(offset, lag), shapes, 1.0 / (1.0 + t[:, None, None] * sine**2))
    log_product = -(np.log1p(t[:, None, None] * kept) @ shapes)
    peak = np.max(log_product, axis=1)
    density = t * np.sum(weight * np.exp(log_product - peak[:, None]) * root, axis=1)
    x, w = unit_gauss_legendre(6)
    between = PchipInterpolator(u, np.log(0.5 * density) + peak)(u[:-1, None] + STEP * x)
    piece = STEP * np.exp(between) @ w
    tail: Floats = np.cumsum(piece[::-1])[::-1]
    return u[:-1], tail


def _rival(offset: Floats, lag: Floats) -> tuple[Floats, Floats]:
    """S and C of every line (..., lines), without cancellation near whole wraps."""
    whole = np.rint(lag)
    turn = np.pi * ((lag - whole)[..., None] + offset * lag[..., None])
    sign = np.where(whole % 2 == 0, 1.0, -1.0)[..., None]
    return sign * np.sin(turn), sign * (1.0 + offset) * np.cos(turn)


def _wedge2(offset: Floats, lag: Floats) -> Floats:
    """
    `(S_j C_k - S_k C_j)^2` of every two lines (..., lines, lines), without cancellation in narrow bands.

    With `d_k = pi l f_k / fc` it is the square of
    `(r_j + r_k) / 2 sin(d_j - d_k) - (r_j - r_k) / 2 sin(2 pi l + d_j + d_k)`.
    """
    turn = np.pi * offset * lag[..., None]
    sine, cosine = np.sin(turn), np.cos(turn)
    joint = turn + np.pi * (lag - np.rint(lag))[..., None]
    sine_j, cosine_j = np.sin(joint), np.cos(joint)
    weight, skew = 1.0 + 0.5 * (offset[:, None] + offset), 0.5 * (offset[:, None] - offset)
    near = sine[..., :, None] * cosine[..., None, :] - cosine[..., :, None] * sine[..., None, :]
    far = sine_j[..., :, None] * cosine_j[..., None, :] + cosine_j[..., :, None] * sine_j[..., None, :]
    near *= weight
    far *= skew
    near -= far
    result: Floats = np.square(near, out=near)
    return result


def _root(wedge2: Floats, shapes: Floats, scales: Floats) -> Floats:
    """Mean of `sqrt(det A)` for independent gamma line powers, its first two moments exact."""
    power = shapes * scales
    variance = power * scales
    partner = (wedge2 @ power[..., None])[..., 0]
    pairs = (wedge2**2 @ variance[..., None])[..., 0]
    mean = 0.5 * np.sum(power * partner, axis=-1)
    return mean_root(mean, np.sum(variance * (partner**2 + 0.5 * pairs), axis=-1))


def _projected(offset: Floats, shapes: Floats, t: Floats, sine: Floats, cosine: Floats) -> tuple[Floats, Floats]:
    """
    `2 S L - L^2` and `sqrt(det A)` with S and C replaced by their lines of regression on frequency.

    L is that of S for the mean powers. `sum e (2 S L - L^2)` differs from the squared projection, its maximum over all
    L, to second order only.
    """
    scales = 1.0 / (1.0 + t[:, None, None] * sine**2)
    power = shapes * scales
    total = np.sum(power, axis=-1, keepdims=True)
    centred = offset - np.sum(power * offset, axis=-1, keepdims=True) / total
    spread = np.sum(power * centred**2, axis=-1, keepdims=True)
    level, level_c = (np.sum(power * x, axis=-1, keepdims=True) / total for x in (sine, cosine))
    slope, slope_c = (np.sum(power * x * centred, axis=-1, keepdims=True) / spread for x in (sine, cosine))
    kept = np.maximum(sine**2 - (sine - level - slope * centred) ** 2, 0.0)
    turn = np.abs(level * slope_c - slope * level_c)[..., 0]
    return kept, turn * _root((offset[:, None] - offset) ** 2, shapes, scales)


def _lags(offset: Floats, shapes: Floats, t: Floats, cell: tuple[float, float]) -> tuple[Floats, Floats]:
    """Nodes and weights over the cell, (t, nodes), dense where the rivals of the lines or of the band win."""
    low, high = cell
    if shapes.size <= FEW_LINES:
        turns = np.arange(1.0, np.ceil(2.0 * high) + 1.0)
        at = np.unique(turns[:, None] / (1.0 + offset))
        at = at[(at > low) & (at < high)]
        peaks = np.tile(at if at.size else [0.5 * (low + high)], (t.size, 1))
        width = np.minimum(0.6 / np.sqrt(t), 1.0)[:, None]
        x, w = unit_gauss_legendre(14)
    else:
        peaks = _best_lag(offset, shapes, t, cell)[:, None]
        sine, _ = _rival(offset, peaks)
        pull = np.sum(2.0 * np.pi**2 * shapes * (1.0 + offset) ** 2 / (1.0 / t[:, None, None] + sine**2), axis=-1)
        width = np.minimum(1.0 / np.sqrt(pull), 1.0)
        x, w = unit_gauss_legendre(18)
    edges = np.column_stack([np.full(t.size, low), 0.5 * (peaks[:, 1:] + peaks[:, :-1]), np.full(t.size, high)])
    nodes, weights = [], []
    for sign, reach in ((-1.0, peaks - edges[:, :-1]), (1.0, edges[:, 1:] - peaks)):
        span = np.arcsinh(reach / width)[..., None]
        nodes.append(peaks[..., None] + sign * width[..., None] * np.sinh(span * x))
        weights.append(span * w * width[..., None] * np.cosh(span * x))
    return (
        np.concatenate(nodes, axis=-1).reshape(t.size, -1),
        np.concatenate(weights, axis=-1).reshape(t.size, -1),
    )


def _best_lag(offset: Floats, shapes: Floats, t: Floats, cell: tuple[float, float]) -> Floats:
    """Lag in the cell at which the rivals win most often."""
    low, high = np.full(t.size, cell[0]), np.full(t.size, cell[1])
    row = np.arange(t.size)
    for _ in range(_ROUNDS):
        lag = np.linspace(low, high, 17, axis=1)
        sine, _ = _rival(offset, lag)
        best = np.argmin(np.log1p(t[:, None, None] * sine**2) @ shapes, axis=1)
        low, high = lag[row, np.maximum(best - 1, 0)], lag[row, np.minimum(best + 1, 16)]
    result: Floats = 0.5 * (low + high)
    return result
