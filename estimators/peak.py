"""The peak of a stack of lag products: which one, and where between the lags."""

from collections.abc import Callable
from functools import partial
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from estimators.lag_product import LagStack, power
from estimators.peak_kernels import COEFFICIENTS, OFFSETS, STENCIL, climb_from_lags, read_at_lags
from sim.band import Complex, Real

SAMPLES_PER_CARRIER = 16
"""Delays in a period of the highest frequency at which the passband correlation is searched."""

Index = NDArray[np.intp]
Ascent = Callable[[Real, Complex, Complex, Complex], tuple[Real, Real]]
"""First and second derivative of what is maximised, at `share` of a lag, from the lag product and its derivatives."""


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

    @property
    def height(self) -> Real:
        """Magnitude of the product over the largest possible one, 0 to 1; 0 where there is no echo."""
        magnitude = np.abs(self.product)
        height = np.divide(magnitude, self.energy, out=np.zeros_like(magnitude), where=self.energy > 0)
        return np.minimum(height, 1.0, out=height)

    def spread(self) -> "Peak":
        """The same with every array in the full shape."""
        return Peak(*np.broadcast_arrays(*self))


def first_from_zero(products: Complex) -> Index:
    """Lag of the local maximum where a climb from the middle lag ends; from shape (lag, rows, time) to (rows, time)."""
    magnitude = power(products)
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
    share, energy = np.empty(index.shape), np.empty(index.shape)
    product, inside = np.empty(index.shape, dtype=np.complex128), np.empty(index.shape, dtype=np.bool_)
    climb_from_lags(stack.products, stack.energies, index, share, product, energy, inside)
    return Peak((index - stack.reach + share) * stack.step, product, energy, inside)


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
    coefficients = np.tensordot(COEFFICIENTS, _around(stack, index + stack.reach), axes=1)
    carrier = 2 * np.pi * centre_frequency * stack.step
    share = _climb(coefficients, start / stack.step - index, partial(_of_passband, index=index, carrier=carrier))
    delay = (index + share) * stack.step
    product, energy = _read(stack, index + stack.reach, share)
    return Peak(
        delay=delay,
        product=product,
        energy=energy,
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
        weights = np.vander(at - middle, len(OFFSETS), increasing=True) @ COEFFICIENTS
        turned = np.exp(2j * np.pi * centre_frequency * stack.step * at)[:, None] * weights
        around = lags[stack.reach + middle - STENCIL :][: len(OFFSETS)]
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
    product, energy = _read(stack, index, lag - index)
    return peak._replace(delay=delay, product=product, energy=energy)


def _read(stack: LagStack, index: Index, share: Real) -> tuple[Complex, Real]:
    product, energy = np.empty(index.shape, dtype=np.complex128), np.empty(index.shape)
    read_at_lags(stack.products, stack.energies, index, share, product, energy)
    return product, energy


def _around(stack: LagStack, index: Index) -> Complex:
    return np.take_along_axis(stack.products, index + OFFSETS[:, None, None], axis=0)


def _climb(coefficients: Complex, share: Real, ascent: Ascent) -> Real:
    for _ in range(4):
        gradient, curvature = ascent(share, *_polynomial(coefficients, share))
        step = np.divide(gradient, curvature, out=np.zeros_like(gradient), where=curvature < 0)
        share = np.clip(share - step, -1.0, 1.0)
    return share


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
