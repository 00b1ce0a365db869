"""The symmetric lag product, `A(t, tau) = p*(t - tau/2) s(t + tau/2)`, on which every method here stands."""

from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy.fft
from numpy.typing import NDArray

from estimators.moving_sum import product_sum_within
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

    def at(self, offset: int) -> NDArray[Any]:
        """The series at `offset / len(values)` samples after each sample; a view, shape (rows, samples)."""
        plane, begin = self.plane(offset)
        series: NDArray[Any] = plane[:, begin : begin + plane.shape[1] - 2 * self.margin]
        return series

    def plane(self, offset: int) -> tuple[NDArray[Any], int]:
        """The plane, with its margins, in which that series is, and the column where it begins."""
        whole, part = divmod(offset, len(self.values))
        # What is the same at every sample has no margin to move in.
        return self.values[part], self.margin + whole if self.margin else 0


@dataclass(frozen=True, eq=False)
class LagSeries:
    """A pair at several instants a sample, from which windowed lag products are formed.

    Attributes
    ----------
    primary, secondary
        Planes of the series, with margins for the window.
    energy_before, energy_after
        Planes of the root of their windowed energy.
    window
        Over which to sum.
    reach
        Lags on either side of zero.
    step
        Delay from lag to lag [s].
    """

    primary: Planes
    secondary: Planes
    energy_before: Planes
    energy_after: Planes
    window: FixedWindow
    reach: int
    step: float

    @property
    def times(self) -> int:
        """Samples; one where the window holds the whole period, as all sums are then one."""
        return int(self.energy_before.at(0).shape[1])

    def stack(self, start: int = 0, stop: int | None = None) -> LagStack:
        """Windowed lag products at all lags, of the samples from `start` to `stop`, a multiple of the window's."""
        part = slice(start, self.times if stop is None else min(stop, self.times))
        shape = 2 * self.reach + 1, self.primary.values.shape[1], part.stop - start
        products, energies = np.empty(shape, dtype=np.complex128), np.empty(shape)
        for products_at, energies_at, lag in zip(products, energies, range(-self.reach, self.reach + 1), strict=True):
            (plane, begin), (other, begin_other) = self.primary.plane(-lag), self.secondary.plane(lag)
            begins = begin + start, begin_other + start
            product_sum_within(plane, other, begins, self.window.rows, self.window.samples, products_at)
            before, after = self.energy_before.at(-lag), self.energy_after.at(lag)
            np.multiply(before[:, part], after[:, part], out=energies_at)
        return LagStack(products, energies, self.step)


def extended(values: NDArray[Any], margin: int) -> Planes:
    """Planes with their periodic continuation; what is the same at every sample needs none."""
    return Planes(values, 0) if values.shape[-1] == 1 else Planes(_wrapped(values, margin), margin)


def _wrapped(values: NDArray[Any], margin: int) -> NDArray[Any]:
    return np.pad(values, ((0, 0), (0, 0), (margin, margin)), mode="wrap")


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
    samples = series.shape[1]
    planes = np.empty((factor, *series.shape), dtype=np.complex128)
    planes[0] = series
    spectrum = scipy.fft.fft(series, axis=-1)
    # The Nyquist bin stands for both ends of the band, and turns either way.
    nyquist = samples // 2 if samples % 2 == 0 else None
    for part in range(1, factor):
        turn = np.exp(2j * np.pi * part / factor * scipy.fft.fftfreq(samples))
        if nyquist is not None:
            turn[nyquist] = turn[nyquist].real
        planes[part] = scipy.fft.ifft(spectrum * turn, axis=-1, overwrite_x=True)
    return planes


def lag_product(primary: Planes, secondary: Planes, lag: int) -> Complex:
    """Lag product at a whole lag, from planes of the conjugate primary and of the secondary.

    With `U` instants a sample this is `A(t, tau)` at `tau = 2 lag / (U sample_rate)`: exactly the phase-corrected
    interferogram that paper A sums from its frequential cross-correlation matrix (equations 15 to 18), at O(1) a
    pixel and lag.

    Parameters
    ----------
    primary, secondary
        Planes of `p*` and of `s`.
    lag
        A whole number, at most `U` times the margin either way.

    Returns
    -------
    array
        Shape (rows, samples).
    """
    product: Complex = primary.at(-lag) * secondary.at(lag)
    return product


def lag_series(
    primary: Complex, secondary: Complex, window: FixedWindow, factor: int, reach: int, sample_rate: float
) -> LagSeries:
    """A pair made ready for windowed lag products at all lags up to `reach` on either side.

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
    both = upsampled(np.concatenate([primary, secondary]), factor)
    series = both[:, : len(primary)], both[:, len(primary) :]
    energy_before, energy_after = (extended(np.sqrt(window.sum(power(planes))), margin) for planes in series)
    wide = margin + window.samples
    before, after = (Planes(_wrapped(planes, wide), wide) for planes in series)
    return LagSeries(before, after, energy_before, energy_after, window, reach, 2 / (factor * sample_rate))


def power(series: Complex) -> Real:
    """Squared magnitude."""
    return series.real**2 + series.imag**2


def scale_of(series: Complex) -> float:
    """Power of two that brings the largest sample towards 1; 1 for single precision, whose squares double can hold."""
    if series.dtype == np.complex64:
        return 1.0
    largest = largest_part(series)
    # Of the smallest numbers no power of two makes 1: they are lifted as far as one can.
    return float(2.0 ** min(-int(np.frexp(largest)[1]), 1000)) if largest > 0 else 1.0


def largest_part(series: Complex) -> float:
    """Largest magnitude of a real or imaginary part."""
    numbers = np.ascontiguousarray(series).view(series.real.dtype)
    return float(max(numbers.max(), -numbers.min()))


def resolved(series: Complex) -> bool:
    """Whether the largest sample is some thousand of the smallest numbers of its precision.

    Of less, rounding to whole ones is no noise: two receivers that round alike agree on a phase that is not theirs.
    """
    return largest_part(series) >= 1000 * float(np.finfo(series.real.dtype).smallest_subnormal)
