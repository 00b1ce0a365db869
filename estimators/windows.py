"""Windows: over which pixels an estimator averages."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from estimators.moving_sum import window_sum
from sim import EchoPair, checks
from sim.band import Band


@dataclass(frozen=True)
class FixedWindow:
    """The same rectangle of pixels everywhere.

    Parameters
    ----------
    rows, samples
        Its size along track and in time, centred on the pixel (an even one reaches one further back).

    Raises
    ------
    ValueError
        For a size below one; by the estimators, for one beyond that of the pair.
    """

    rows: int
    samples: int

    def __post_init__(self) -> None:
        checks.count("rows of the window", self.rows)
        checks.count("samples of the window", self.samples)

    def __str__(self) -> str:
        return f"{self.rows}x{self.samples}"

    def check(self, pair: EchoPair) -> None:
        """ValueError where the window is larger than the pair."""
        for name, size, available in zip(("rows", "samples"), (self.rows, self.samples), pair.shape, strict=True):
            if size > available:
                raise ValueError(f"the window has {size} {name}; the pair has {available}, and it must not have more")

    def sum(self, array: NDArray[Any]) -> NDArray[Any]:
        """Sum of (..., rows, time) over the window around each pixel: clipped in rows, circular in time."""
        return window_sum(array, self.rows, self.samples, circular=True)

    def inside(self, pair: EchoPair) -> NDArray[np.bool_]:
        """Where the window lies within the pair; shape (rows, time)."""
        rows, samples = (
            _fits(available, size) for available, size in zip(pair.shape, (self.rows, self.samples), strict=True)
        )
        return rows[:, None] & (samples | pair.circular)[None, :]

    def looks(self, pair: EchoPair) -> float:
        """Equivalent independent looks in the window, for rows that are independent and a flat band.

        In time, `n` samples of speckle with the correlation `sinc(B d / fs)` at `d` samples hold
        `n^2 / sum_d (n - |d|) sinc^2(B d / fs)` looks (the variance of a mean of correlated intensities); the whole
        period of a circular record holds as many as the band has Fourier bins.
        """
        if pair.circular and self.samples == pair.shape[1]:
            return self.rows * Band(pair.grid, pair.bandwidth).looks
        lags = np.arange(1, self.samples)
        correlated = 2 * np.sum((self.samples - lags) * np.sinc(pair.bandwidth / pair.sample_rate * lags) ** 2)
        return self.rows * self.samples**2 / (self.samples + float(correlated))


def _fits(available: int, size: int) -> NDArray[Any]:
    first = np.arange(available) - size // 2
    return (first >= 0) & (first + size <= available)
