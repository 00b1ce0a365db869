"""The peak of a stack of lag products: which one, and where between the lags."""

from collections.abc import Callable
from functools import partial
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from estimators.lag_product import LagStack, power
from sim.band import Complex, Real

STENCIL = 4
"""Lags on either side of a peak that its interpolation uses, and that a stack holds beyond the search range. At four
lags per `1 / B` the polynomial of degree 8 follows the band's edge to 6e-5 of its amplitude half-way between lags."""

SAMPLES_PER_CARRIER = 16
"""Delays in a period of the highest frequency at which the passband correlation is searched."""

Index = NDArray[np.intp]
Ascent = Callable[[Real, Complex, Complex, Complex], tuple[Real, Real]]
"""First and second derivative of what is maximised, at `share` of a lag, from the lag product and its derivatives."""

_OFFSETS = np.arange(-STENCIL, STENCIL + 1)
_COEFFICIENTS = np.linalg.inv(np.vander(_OFFSETS.astype(float), increasing=True))


class Peak(NamedTuple):
    """Where the windowed lag product peaks; all of the shape (rows, time).

    `delay` [s], `product` the complex value there, `energy` its largest possible magnitude, `inside` whether it is a
    maximum inside the search range, `doubt` the probability that it is in a wrong wrap, 1 where nothing tells.
    """

    delay: Real
    product: Complex
    energy: Real
    inside: NDArray[np.bool_]
    doubt: Real = np.ones(())

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
    share = _climb(coefficients, np.clip((after - before) / (2 * bend), -1.0, 1.0), _of_magnitude)
    share[~inside] = 0.0
    return Peak(
        delay=(index - stack.reach + share) * stack.step,
        product=_polynomial(coefficients, share)[0],
        energy=_between(stack.energies, index, share),
        inside=inside,
    )


def passband_peak(stack: LagStack, centre_frequency: float, bandwidth: float, search: float) -> Peak:
    """Highest peak of the real passband correlation `Re{exp(2 pi i fc tau) C(tau)}`.

    One candidate for each period of the highest frequency, `fc + B / 2`, over the search range and a wrap beyond it on
    either side; Newton's method on the polynomial of `peak_at` then moves the best to the peak. It is inside unless it
    lies beyond the search range.

    Parameters
    ----------
    stack
        Lag products, at least two wraps and `STENCIL` lags longer than the search range on either side.
    centre_frequency, bandwidth
        `fc` and `B` [Hz].
    search
        Largest delay [s].
    """
    start = _highest_of_periods(stack, centre_frequency, bandwidth, search + 1 / centre_frequency)
    index = np.rint(start / stack.step).astype(np.intp)
    coefficients = np.tensordot(_COEFFICIENTS, _around(stack, index + stack.reach), axes=1)
    carrier = 2 * np.pi * centre_frequency * stack.step
    share = _climb(coefficients, start / stack.step - index, partial(_of_passband, index=index, carrier=carrier))
    delay = (index + share) * stack.step
    return Peak(
        delay=delay,
        product=_polynomial(coefficients, share)[0],
        energy=_between(stack.energies, index + stack.reach, share),
        inside=np.abs(delay) <= search,
    )


def _highest_of_periods(stack: LagStack, centre_frequency: float, bandwidth: float, limit: float) -> Real:
    """Delay of the highest candidate up to `limit` on either side."""
    lags = stack.products.reshape(len(stack.products), -1)
    fine = int(np.ceil(SAMPLES_PER_CARRIER * (centre_frequency + bandwidth / 2) * stack.step))
    # An odd number, with a sample more on either side: receivers swapped give the same samples.
    half = SAMPLES_PER_CARRIER // 2 - 1
    period = np.arange(-half - 1, half + 2)
    last = int(np.ceil(limit / stack.step * fine / (2 * half + 1)))
    highest, delay = np.full(lags.shape[1], -np.inf), np.zeros(lags.shape[1])
    for centre in (2 * half + 1) * np.arange(-last, last + 1):
        # In lags.
        at = (centre + period) / fine
        middle = int(np.rint(centre / fine))
        weights = np.vander(at - middle, len(_OFFSETS), increasing=True) @ _COEFFICIENTS
        turned = np.exp(2j * np.pi * centre_frequency * stack.step * at)[:, None] * weights
        around = lags[stack.reach + middle - STENCIL :][: len(_OFFSETS)]
        height, place = _crest(turned.real @ around.real - turned.imag @ around.imag)
        found = (at[0] + place / fine) * stack.step
        better = (height > highest) & (np.abs(found) <= limit)
        highest[better] = height[better]
        delay[better] = found[better]
    return delay.reshape(stack.products.shape[1:])


def _crest(values: Real) -> tuple[Real, Real]:
    """Height and place of the highest inner sample, moved to the crest of the sinusoid through it; from (sample, n).

    Three samples fix amplitude, phase and frequency: `cos w = (before + after) / (2 here)`.
    """
    index = values[1:-1].argmax(axis=0) + 1
    before, here, after = (np.take_along_axis(values, index[None] + step, axis=0)[0] for step in (-1, 0, 1))
    is_top = (here > before) & (here >= after) & (before + after > 0)
    cosine = np.divide(before + after, 2 * here, out=np.zeros_like(here), where=is_top)
    sine = np.sqrt((1 - cosine) * (1 + cosine))
    quadrature = np.where(is_top, (after - before) / (2 * sine), 0.0)
    share = np.where(is_top, np.arctan2(quadrature, here) / np.arcsin(sine), 0.0)
    return np.where(is_top, np.hypot(here, quadrature), here), index + share


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


def _climb(coefficients: Complex, share: Real, ascent: Ascent) -> Real:
    for _ in range(4):
        gradient, curvature = ascent(share, *_polynomial(coefficients, share))
        step = np.divide(gradient, curvature, out=np.zeros_like(gradient), where=curvature < 0)
        share = np.clip(share - step, -1.0, 1.0)
    return share


def _of_magnitude(share: Real, value: Complex, slope: Complex, bend: Complex) -> tuple[Real, Real]:
    """Half the squared magnitude."""
    return (value.conj() * slope).real, power(slope) + (value.conj() * bend).real


def _of_passband(
    share: Real, value: Complex, slope: Complex, bend: Complex, *, index: Index, carrier: float
) -> tuple[Real, Real]:
    """Real part with the carrier, which turns by `carrier` [rad] a lag, at `index + share` lags."""
    turn = np.exp(1j * carrier * (index + share))
    gradient = turn * (slope + 1j * carrier * value)
    curvature = turn * (bend + 2j * carrier * slope - carrier**2 * value)
    return gradient.real, curvature.real


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
    """Energy between lags, on a parabola: a straight line lies so far off that coherences of .999 come out as 1."""
    here, before, after = (np.take_along_axis(energies, (index + step)[None], axis=0)[0] for step in (0, -1, 1))
    parabola = here + share / 2 * (after - before + share * (after + before - 2 * here))
    # Of a single dark pixel it may undershoot.
    least: Real = np.maximum(parabola, np.minimum(here, np.minimum(before, after)))
    return least
