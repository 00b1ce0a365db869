"""The symmetric lag product, `A(t, tau) = p*(t - tau/2) s(t + tau/2)`, on which every method here stands."""

from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy.fft
from numpy.typing import NDArray

from estimators.moving_sum import product_sum
from estimators.windows import FixedWindow
from sim.band import Complex, Real


@dataclass(frozen=True, eq=False)
class LagStack:
    """Windowed lag products over a range of delays.

    Attributes
    ----------
    products
        `C(t, tau) = sum over the window of A(t', tau)`, shape (lag, rows, time).
    energies
        `sqrt(sum |p(t' - tau/2)|^2 sum |s(t' + tau/2)|^2)`, same shape; `|C|` never exceeds it.
    step
        Delay from lag to lag [s]; the middle one is at zero delay.
    """

    products: Complex
    energies: Real
    step: float

    @property
    def reach(self) -> int:
        """Lags on either side of zero delay."""
        return len(self.products) // 2


@dataclass(frozen=True, eq=False)
class Planes:
    """A periodic series, or what was made of it, at several instants a sample.

    Attributes
    ----------
    values
        Shape (instant, rows, margin + samples + margin), the margins its periodic continuation; (instant, rows, 1) for
        what is the same at every sample. Plane `j` holds the series at `j / len(values)` after each sample.
    margin
        Samples of continuation on either side.
    """

    values: NDArray[Any]
    margin: int

    def plane(self, offset: int) -> tuple[NDArray[Any], int]:
        """The plane, and where in it the series begins, at `offset / len(values)` samples after each sample."""
        whole, part = divmod(offset, len(self.values))
        # What is the same at every sample has no margin to move in.
        return self.values[part], self.margin + whole if self.margin else 0

    def at(self, offset: int) -> NDArray[Any]:
        """The series at `offset / len(values)` samples after each sample; a view, shape (rows, samples)."""
        plane, begin = self.plane(offset)
        series: NDArray[Any] = plane[:, begin : begin + plane.shape[1] - 2 * self.margin]
        return series


def extended(values: NDArray[Any], margin: int) -> Planes:
    """Planes with their periodic continuation; what is the same at every sample needs none."""
    if values.shape[-1] == 1:
        return Planes(values, 0)
    return Planes(np.pad(values, ((0, 0), (0, 0), (margin, margin)), mode="wrap"), margin)


def upsampled(series: Complex, factor: int) -> Complex:
    """Band-limited interpolation of periodic series at `factor` instants a sample.

    Parameters
    ----------
    series
        Shape (rows, samples).
    factor
        Instants a sample.

    Returns
    -------
    array
        Shape (factor, rows, samples).
    """
    rows, samples = series.shape
    spectrum = scipy.fft.fft(series, axis=-1)
    wide = np.zeros((rows, samples * factor), dtype=np.complex128)
    positive = (samples + 1) // 2
    wide[:, :positive] = spectrum[:, :positive]
    wide[:, samples * factor - samples + positive :] = spectrum[:, positive:]
    if samples % 2 == 0:
        # The Nyquist bin stands for both ends of the band, which at one instant a sample are one again.
        wide[:, -samples // 2] = spectrum[:, samples // 2] / 2
        wide[:, samples // 2] += spectrum[:, samples // 2] / 2
    fine = scipy.fft.ifft(wide, axis=-1, overwrite_x=True) * factor
    return np.ascontiguousarray(np.moveaxis(fine.reshape(rows, samples, factor), -1, 0))


def lag_product(
    primary: Planes, secondary: Planes, lag: int, window: FixedWindow, out: Complex | None = None
) -> Complex:
    """Windowed lag product at a whole lag.

    With `U` instants a sample this is the sum over the window of `A(t, tau)` at `tau = 2 lag / (U sample_rate)`:
    exactly the phase-corrected interferogram that paper A sums from its frequential cross-correlation matrix
    (equations 15 to 18), at O(1) a pixel and lag.

    Parameters
    ----------
    primary, secondary
        Planes of both series.
    lag
        A whole number, at most `U` times the margin either way.
    window
        Over which to sum.
    out
        Takes the result, where given.

    Returns
    -------
    array
        Shape (rows, samples), or (rows, 1) as `estimators.moving_sum.window_sum`.
    """
    (before, begin_before), (after, begin_after) = primary.plane(-lag), secondary.plane(lag)
    return product_sum(
        before,
        after,
        window.rows,
        window.samples,
        circular=True,
        begins=(begin_before, begin_after),
        length=before.shape[1] - 2 * primary.margin,
        out=out,
    )


def lag_stack(
    primary: Complex, secondary: Complex, window: FixedWindow, factor: int, reach: int, sample_rate: float
) -> LagStack:
    """Windowed lag products at all lags up to `reach` on either side.

    Parameters
    ----------
    primary, secondary
        Periodic series, shape (rows, samples).
    window
        Over which to sum.
    factor
        Instants a sample, `U`; the lags are `2 / (U sample_rate)` apart.
    reach
        Lags on either side of zero.
    sample_rate
        Samples per second [Hz].
    """
    margin = reach // factor + 1
    series = upsampled(primary, factor), upsampled(secondary, factor)
    energy_before, energy_after = (extended(np.sqrt(window.sum(power(planes))), margin) for planes in series)
    before, after = (extended(planes, margin) for planes in series)
    shape = (2 * reach + 1, *energy_before.at(0).shape)
    products, energies = np.empty(shape, dtype=np.complex128), np.empty(shape)
    for products_at, energies_at, lag in zip(products, energies, range(-reach, reach + 1), strict=True):
        lag_product(before, after, lag, window, products_at)
        np.multiply(energy_before.at(-lag), energy_after.at(lag), out=energies_at)
    return LagStack(products, energies, 2 / (factor * sample_rate))


def power(series: Complex) -> Real:
    """Squared magnitude."""
    return series.real**2 + series.imag**2


def scale_of(series: Complex) -> float:
    """Power of two that brings the largest sample towards 1; 1 for single precision, whose squares double can hold."""
    if series.dtype == np.complex64:
        return 1.0
    numbers = np.ascontiguousarray(series).view(np.float64)
    largest = float(max(numbers.max(), -numbers.min()))
    # Of the smallest numbers no power of two makes 1: they are lifted as far as one can.
    return float(2.0 ** min(-int(np.frexp(largest)[1]), 1000)) if largest > 0 else 1.0
