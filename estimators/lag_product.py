"""The symmetric lag product, `A(t, tau) = p*(t - tau/2) s(t + tau/2)`, on which every method here stands."""

from dataclasses import dataclass

import numpy as np
import scipy.fft
from numpy.typing import NDArray

from estimators.moving_sum import Number
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


def upsampled_planes(series: Complex, factor: int) -> Complex:
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
        Shape (factor, rows, samples): plane `j` holds the series at `j / factor` after each sample.
    """
    rows, samples = series.shape
    spectrum = scipy.fft.fft(series, axis=-1)
    wide = np.zeros((rows, samples * factor), dtype=np.complex128)
    positive = (samples + 1) // 2
    wide[:, :positive] = spectrum[:, :positive]
    wide[:, samples * factor - samples + positive :] = spectrum[:, positive:]
    if samples % 2 == 0:
        # The Nyquist bin stands for both ends of the band.
        wide[:, -samples // 2] = wide[:, samples // 2] = spectrum[:, samples // 2] / 2
    fine = scipy.fft.ifft(wide, axis=-1, overwrite_x=True) * factor
    return np.ascontiguousarray(np.moveaxis(fine.reshape(rows, samples, factor), -1, 0))


def at_offset(planes: NDArray[Number], offset: int) -> NDArray[Number]:
    """Series at `offset / factor` samples after each sample, from its upsampled planes."""
    factor = len(planes)
    whole, part = divmod(offset, factor)
    return np.roll(planes[part], -whole, axis=-1)


def lag_product(primary: Complex, secondary: Complex, lag: int) -> Complex:
    """Lag product at a whole lag, from upsampled planes of the conjugate primary and of the secondary.

    With `U` planes a sample this is `A(t, tau)` at `tau = 2 lag / (U sample_rate)`: exactly the phase-corrected
    interferogram that paper A sums from its frequential cross-correlation matrix (equations 15 to 18), at O(1) a
    pixel and lag.

    Parameters
    ----------
    primary, secondary
        `upsampled_planes` of `p*` and of `s`, shape (U, rows, samples).
    lag
        Any whole number.

    Returns
    -------
    array
        Shape (rows, samples).
    """
    return at_offset(primary, -lag) * at_offset(secondary, lag)


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
    before, after = upsampled_planes(primary.conj(), factor), upsampled_planes(secondary, factor)
    energy_before, energy_after = window.sum(power(before)), window.sum(power(after))
    lags = range(-reach, reach + 1)
    shape = (len(lags), *energy_before.shape[1:])
    products, energies = np.empty(shape, dtype=np.complex128), np.empty(shape)
    for products_at, energies_at, lag in zip(products, energies, lags, strict=True):
        products_at[...] = window.sum(lag_product(before, after, lag))
        energies_at[...] = np.sqrt(at_offset(energy_before, -lag) * at_offset(energy_after, lag))
    return LagStack(products, energies, 2 / (factor * sample_rate))


def power(series: Complex) -> Real:
    """Squared magnitude."""
    return series.real**2 + series.imag**2
