"""The peak of a stack of lag products: which one, and where between the lags."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from estimators.lag_product import LagStack, power
from sim.band import Complex, Real

STENCIL = 4
"""Lags on either side of a peak that its interpolation uses, and that a stack holds beyond the search range. At four
lags per `1 / B` the polynomial of degree 8 follows the band's edge to 6e-5 of its amplitude half-way between lags."""

Index = NDArray[np.intp]

_OFFSETS = np.arange(-STENCIL, STENCIL + 1)
_COEFFICIENTS = np.linalg.inv(np.vander(_OFFSETS.astype(float), increasing=True))


class Peak(NamedTuple):
    """Where the windowed lag product peaks; all of the shape (rows, time).

    `delay` [s], `product` the complex value there, `energy` its largest possible magnitude, `inside` whether it is a
    maximum inside the search range.
    """

    delay: Real
    product: Complex
    energy: Real
    inside: NDArray[np.bool_]

    def spread(self) -> "Peak":
        """The same with every array in the full shape."""
        return Peak(*np.broadcast_arrays(*self))


def strongest(magnitude: Real) -> Index:
    """Lag of the largest magnitude; from shape (lag, rows, time) to (rows, time)."""
    index: Index = magnitude.argmax(axis=0)
    return index


def first_from_zero(magnitude: Real) -> Index:
    """Lag of the local maximum where a climb from the middle lag ends; from shape (lag, rows, time) to (rows, time)."""
    centre = len(magnitude) // 2
    rises = np.diff(magnitude, axis=0)
    ahead, behind = rises[centre:] > 0, rises[:centre][::-1] < 0
    steps_ahead = np.where(ahead.all(axis=0), centre, (~ahead).argmax(axis=0))
    steps_behind = np.where(behind.all(axis=0), centre, (~behind).argmax(axis=0))
    go_ahead = magnitude[centre + 1] >= magnitude[centre - 1]
    steps: Index = np.where((steps_ahead > 0) & (go_ahead | (steps_behind == 0)), steps_ahead, -steps_behind)
    return centre + steps


def peak_at(stack: LagStack, index: Index) -> Peak:
    """Refine maxima of a stack to a fraction of a lag.

    Through the products at nine lags runs a polynomial of degree 8; Newton's method finds where its squared magnitude
    peaks within a lag of the highest. (A parabola through three squared magnitudes would pull towards the lags by
    `(2 pi^2 / 15) / os^2` at `os` lags per `1 / B`.)

    Parameters
    ----------
    stack
        Lag products, at least `STENCIL` lags longer than the search range on either side.
    index
        The highest lags, shape (rows, time).
    """
    around = _around(stack, index)
    heights = power(around)
    here, before, after = heights[STENCIL], heights[STENCIL - 1], heights[STENCIL + 1]
    inside = (here >= before) & (here >= after) & (here > 0)
    bend = np.where(inside & (2 * here > before + after), 2 * here - before - after, np.inf)
    coefficients = np.tensordot(_COEFFICIENTS, around, axes=1)
    share = _climb(coefficients, np.clip((after - before) / (2 * bend), -1.0, 1.0))
    share[~inside] = 0.0
    return Peak(
        delay=(index - stack.reach + share) * stack.step,
        product=_polynomial(coefficients, share)[0],
        energy=_between(stack.energies, index, share),
        inside=inside,
    )


def moved_to(peak: Peak, stack: LagStack, delay: Real) -> Peak:
    """The same peak, with product and energy read at other delays [s] in the reach of the stack."""
    lag = np.clip(delay / stack.step + stack.reach, STENCIL, 2 * stack.reach - STENCIL)
    index = np.rint(lag).astype(np.intp)
    coefficients = np.tensordot(_COEFFICIENTS, _around(stack, index), axes=1)
    return peak._replace(
        delay=delay,
        product=_polynomial(coefficients, lag - index)[0],
        energy=_between(stack.energies, index, lag - index),
    )


def _around(stack: LagStack, index: Index) -> Complex:
    return np.take_along_axis(stack.products, index + _OFFSETS[:, None, None], axis=0)


def _climb(coefficients: Complex, share: Real) -> Real:
    for _ in range(4):
        value, slope, bend = _polynomial(coefficients, share)
        gradient = (value.conj() * slope).real
        curvature = power(slope) + (value.conj() * bend).real
        step = np.divide(gradient, curvature, out=np.zeros_like(gradient), where=curvature < 0)
        share = np.clip(share - step, -1.0, 1.0)
    return share


def _polynomial(coefficients: Complex, x: Real) -> tuple[Complex, Complex, Complex]:
    """Value, first and second derivative by Horner's rule."""
    value = coefficients[-1] + 0 * x
    slope, half_bend = np.zeros_like(value), np.zeros_like(value)
    for coefficient in coefficients[-2::-1]:
        half_bend = half_bend * x + slope
        slope = slope * x + value
        value = value * x + coefficient
    return value, slope, 2 * half_bend


def _between(energies: Real, index: Index, share: Real) -> Real:
    """Energy between two lags, on a straight line."""
    neighbour = np.where(share < 0, index - 1, index + 1)
    here, there = (np.take_along_axis(energies, i[None], axis=0)[0] for i in (index, neighbour))
    line: Real = here + np.abs(share) * (there - here)
    return line
