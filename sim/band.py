"""Band-limited series on a circular time grid."""

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
import scipy.fft
from numpy.typing import NDArray

from sim import checks

Complex = NDArray[np.complex128]
Real = NDArray[np.float64]


@dataclass(frozen=True)
class TimeGrid:
    """A circular grid of `samples` instants from `start` [s], `1 / sample_rate` apart.

    The period is `samples / sample_rate` by construction; it cannot be given. A period off by a fraction
    of a sample would stretch time and bias the group delay by whole wraps at long range.
    """

    samples: int
    sample_rate: float
    start: float = 0.0

    def __post_init__(self) -> None:
        checks.count("samples", self.samples)
        checks.positive("sample_rate", self.sample_rate, "Hz")
        checks.finite("start", self.start, "s")

    @property
    def period(self) -> float:
        """`samples / sample_rate` [s]."""
        return self.samples / self.sample_rate

    @cached_property
    def times(self) -> Real:
        """The instants [s], shape (samples,)."""
        return self.start + np.arange(self.samples) / self.sample_rate


@dataclass(frozen=True)
class Band:
    """The flat band of width `bandwidth` [Hz] around zero, in the Fourier bins of a time grid.

    `harmonics` are the bins `k`, symmetric around zero and below the Nyquist frequency, of frequencies
    `k / period`. A bin stands for the frequencies half a bin to either side: `weights` is the share of these
    that the band holds, 1 but for the two outermost bins, so that the weights add up to `bandwidth * period`
    (one bin less where the band fills an even grid up to its ambiguous Nyquist frequency).

    Raises
    ------
    ValueError
        Where the bandwidth is not above 0, exceeds the sample rate, or holds less than one bin.
    """

    grid: TimeGrid
    bandwidth: float

    def __post_init__(self) -> None:
        checks.positive("bandwidth", self.bandwidth, "Hz")
        if self.bandwidth > self.grid.sample_rate:
            raise ValueError(
                f"sample_rate is {self.grid.sample_rate:g} Hz; it must be at least the bandwidth, {self.bandwidth:g} Hz"
            )
        if self.bandwidth * self.grid.period < 1:
            raise ValueError(
                f"the series lasts {self.grid.period:g} s; it must last 1 / bandwidth = {1 / self.bandwidth:g} s"
            )

    @cached_property
    def harmonics(self) -> NDArray[np.int64]:
        """Bin numbers, shape (bins,)."""
        half_width = self.bandwidth * self.grid.period / 2
        # A band edge that falls on a bin edge by design may miss it by rounding.
        outermost = min(int(np.ceil(half_width - 0.5 - 1e-9)), (self.grid.samples - 1) // 2)
        return np.arange(-outermost, outermost + 1)

    @cached_property
    def weights(self) -> Real:
        """Share of each bin that lies in the band, shape (bins,)."""
        half_width = self.bandwidth * self.grid.period / 2
        inside: Real = np.clip(half_width - np.abs(self.harmonics) + 0.5, 0.0, 1.0)
        return inside

    @cached_property
    def frequencies(self) -> Real:
        """Bin frequencies relative to the centre frequency [Hz], shape (bins,)."""
        return self.harmonics / self.grid.period

    @cached_property
    def passes(self) -> Real:
        """Amplitude `sqrt(w)` that the band passes of all bins in the order of the FFT, 0 beyond; shape (samples,)."""
        passes = np.zeros(self.grid.samples)
        passes[self.harmonics] = np.sqrt(self.weights)
        return passes

    @property
    def looks(self) -> float:
        """Independent looks of the whole record, `(sum w)^2 / sum w^2`."""
        return float(self.weights.sum() ** 2 / (self.weights**2).sum())

    def series(self, spectrum: NDArray[Any]) -> Complex:
        """Sum `spectrum[..., k] exp(2 pi i f_k t)` at the instants of the grid, shape (..., samples)."""
        bins = np.zeros((*spectrum.shape[:-1], self.grid.samples), dtype=np.complex128)
        below = self.harmonics.size // 2
        bins[..., : below + 1] = spectrum[..., below:]
        bins[..., bins.shape[-1] - below :] = spectrum[..., :below]
        series: Complex = scipy.fft.ifft(bins, axis=-1, norm="forward", overwrite_x=True)
        return series

    def noise(self, rows: int, rng: np.random.Generator) -> Complex:
        """Spectra of circular Gaussian series of unit power that fill the band, shape (rows, bins)."""
        noise: Complex = circular_gaussian((rows, self.harmonics.size), rng) * np.sqrt(
            self.weights / self.weights.sum()
        )
        return noise


def circular_gaussian(shape: tuple[int, ...], rng: np.random.Generator) -> Complex:
    """Independent circular complex Gaussian numbers of unit mean power."""
    numbers: Complex = rng.standard_normal((*shape, 2)).view(np.complex128)[..., 0]
    numbers *= np.sqrt(0.5)
    return numbers
