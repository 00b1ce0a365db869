"""Removal of the bias of the sample coherence: the inverse of its mean, from tables over coherence and looks."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.interpolate import CubicSpline
from scipy.special import beta

from .conventions import MOST_LOOKS, Floats, within
from .sample_coherence import sample_coherence_moments

NODE_STEP = 0.2
STENCIL = 6
KNOT_STEP = 0.04
PIECES = 372
CHUNK = 1 << 14
_LAST = 30.0


def debias_coherence(sample_coherence: ArrayLike, looks: ArrayLike) -> Floats:
    """
    Coherence whose mean sample coherence is `sample_coherence`: the inverse of `sample_coherence_mean`.

    Values below the bias floor give 0, values of 1 and above give 1. The relative error is below 1e-6, beside what
    rounding of the argument makes of a coherence near the floor.
    Source: theory section 4 for the mean; its inverse is by tables.

    Parameters
    ----------
    sample_coherence, looks
        Sample coherence, 0 to 1; independent looks, real, above 1 to 1e9, NaN elsewhere.

    Returns
    -------
    ndarray
        Coherence, 0 to 1; of the broadcast shape.
    """
    one = within(looks, 1.0, MOST_LOOKS)
    both = np.broadcast_arrays(np.asarray(sample_coherence, dtype=np.float64), one)
    g, n = (array.ravel() for array in both)
    result = np.where((n > 1.0) & ~np.isnan(g), np.where(g >= 1.0, 1.0, 0.0), np.nan)
    left = np.flatnonzero((n > 1.0) & (g < 1.0) & (g > (_floor(one) if one.size == 1 else _floor(n))))
    for some in np.array_split(left, left.size // CHUNK + 1):
        if some.size:
            result[some] = _inverse(g[some], one.reshape(1) if one.size == 1 else n[some])
    return result.reshape(both[0].shape)


def _floor(n: Floats) -> Floats:
    """Mean sample coherence at zero coherence, `(sqrt(pi) / 2) Gamma(L) / Gamma(L + 1/2)`."""
    # Stirling's series, where the beta function loses digits.
    u = 1.0 / np.maximum(n, 50.0)
    series = u * (1.0 / 8.0 - u**2 * (1.0 / 192.0 - u**2 * (1.0 / 640.0 - u**2 * 17.0 / 14336.0)))
    result: Floats = np.where(
        n < 50.0, 0.5 * beta(np.minimum(n, 50.0), 0.5), np.sqrt(0.25 * np.pi * u) * np.exp(series)
    )
    return result


def _slope(n: Floats) -> Floats:
    """Of `-log((1 - mean) / (1 - floor))` over `gamma^2`, at zero coherence."""
    floor = _floor(n)
    return floor / (1.0 - floor) * n * (n - 1.0) / (2.0 * n + 1.0)


def _inverse(g: Floats, n: Floats) -> Floats:
    floor = _floor(n)
    depth = -np.log1p(-np.minimum((g - floor) / (1.0 - floor), 1.0 - 1e-16))
    x = np.arcsinh(depth / floor) / KNOT_STEP
    piece = np.minimum(x.astype(np.int64), PIECES - 1)
    first, weights = _stencil(n)
    table = _tables(int(np.min(first)), int(np.max(first)) + STENCIL)
    if n.size == 1:
        of_pieces = np.tensordot(table[:, first[0] : first[0] + STENCIL], weights[:, 0], axes=(1, 0))
        coefficients = np.take(of_pieces, piece, axis=1)
    else:
        coefficients = np.zeros((4, g.size))
        for member in range(STENCIL):
            coefficients += weights[member] * table[:, first + member, piece]
    x = (x - piece) * KNOT_STEP
    log_ratio = ((coefficients[0] * x + coefficients[1]) * x + coefficients[2]) * x + coefficients[3]
    result: Floats = np.sqrt(-np.expm1(-np.exp(log_ratio) * depth / _slope(n)))
    return result


def _node_looks(node: int) -> float:
    """Looks evenly spaced in their log, the first of them next to one."""
    return float(np.exp(max(NODE_STEP * node, 1e-3)))


def _stencil(n: Floats) -> tuple[NDArray[np.int64], Floats]:
    """First of the neighbouring nodes and their Lagrange weights in log looks."""
    x = np.log(n)
    last = int(np.log(MOST_LOOKS) / NODE_STEP)
    first = np.clip(np.floor(x / NODE_STEP).astype(np.int64) - STENCIL // 2 + 1, 0, last - STENCIL + 1)
    at = np.maximum(NODE_STEP * (first + np.arange(STENCIL)[:, None]), 1e-3)
    weights = np.ones(at.shape)
    for i in range(STENCIL):
        for j in range(STENCIL):
            if i != j:
                weights[i] *= (x - at[j]) / (at[i] - at[j])
    return first, weights


def _tables(start: int, stop: int) -> Floats:
    """Cubic coefficients (4, nodes, pieces), filled in from node `start` to `stop`."""
    for node in range(start, stop):
        if np.isnan(_coefficients[0, node, 0]):
            _coefficients[:, node] = _table(node)
    return _coefficients


_coefficients = np.full((4, int(np.log(MOST_LOOKS) / NODE_STEP) + 1, PIECES), np.nan)


def _table(node: int) -> Floats:
    """
    Log of `slope log(1 - gamma^2) / log((1 - mean) / (1 - floor))`, which is zero at zero coherence.

    Over even steps of `asinh` of the second log in units of the floor; first at knots that a rough inverse
    puts near these, and straight beyond the last.
    """
    n = np.asarray(_node_looks(node))
    floor, slope = _floor(n), _slope(n)
    even = KNOT_STEP * np.arange(PIECES + 1)
    rough = floor * np.sinh(even[1:])
    rough = rough[rough < _LAST]
    log_rest = -rough * (1.0 + slope * rough) / (1.0 + rough) / slope
    # Few knots at a time: the stronger ones need fewer steps.
    parts = np.array_split(np.sqrt(-np.expm1(log_rest)), rough.size // 32 + 1)
    moments = [sample_coherence_moments(n, some) for some in parts]
    mean, rest, _ = (np.concatenate(part) for part in zip(*moments, strict=True))
    most = sample_coherence_moments(n, 0.0)[1]
    # The difference that loses fewer digits.
    risen = (most - rest) / most if floor > 0.5 else (mean - floor) / most
    depth = np.where(risen < 0.5, -np.log1p(-np.minimum(risen, 0.5)), np.log(most / rest))
    x = np.append(0.0, np.arcsinh(depth / floor))
    curve = CubicSpline(x, np.append(0.0, np.log(-log_rest * slope / depth)))
    beyond = np.maximum(even - x[-1], 0.0)
    resampled = curve(np.minimum(even, x[-1])) + beyond * curve(x[-1], 1)
    result: Floats = CubicSpline(even, resampled).c
    return result
