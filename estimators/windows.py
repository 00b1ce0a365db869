"""Windows: over which pixels an estimator averages."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from estimators.moving_sum import window_sum
from sim import EchoPair, PairFile, checks
from sim.band import Band, Real

Sizes = NDArray[np.int64]


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

    def on(self, pair: EchoPair) -> "FixedWindow":
        """Itself, whatever the pair."""
        return self

    @property
    def extent(self) -> tuple[int, int]:
        """Most rows and most samples at any time."""
        return self.rows, self.samples

    @property
    def pixels(self) -> int:
        """Pixels in it."""
        return self.rows * self.samples

    def check(self, pair: EchoPair | PairFile) -> None:
        """ValueError where the window is larger than the pair."""
        for name, size, available in zip(("rows", "samples"), self.extent, pair.shape, strict=True):
            if size > available:
                raise ValueError(f"the window has {size} {name}; the pair has {available}, and it must not have more")

    def sum(self, array: NDArray[Any]) -> NDArray[Any]:
        """Sum of (..., rows, time) over the window around each pixel: clipped in rows, circular in time."""
        return window_sum(array, self.rows, self.samples, circular=True)

    def inside(self, pair: EchoPair) -> NDArray[np.bool_]:
        """Where the window lies within the pair and a resolution cell or more from what no receiver heard.

        That is what is missing, and silence: zeros of either receiver for more than two resolution cells, of a record
        that was padded, or a receiver that was off. As echoes half a delay to either side are read, a cell leaves room
        for delays of up to `2 / B`. Shape (rows, time).
        """
        return self._inside(pair, _unheard(pair))

    def _inside(self, pair: EchoPair, unheard: NDArray[np.bool_] | None) -> NDArray[np.bool_]:
        rows, samples = (_fits(available, size) for available, size in zip(pair.shape, self.extent, strict=True))
        inside: NDArray[np.bool_] = rows[:, None] & (samples | pair.circular)[None, :]
        if unheard is None:
            return inside
        reach = self.samples + 2 * _cell(pair)
        reach = min(reach, pair.shape[1]) if pair.circular else reach
        near = window_sum(unheard.astype(float), self.rows, reach, circular=pair.circular) > 0
        return np.logical_and(inside, ~near)

    def looks(self, pair: EchoPair) -> float:
        """Equivalent independent looks in the window, for flat bands along track and in time.

        `n` samples of speckle with the correlation `sinc(B d / fs)` at `d` samples hold
        `n^2 / sum_d (n - |d|) sinc^2(B d / fs)` looks (the variance of a mean of correlated intensities), and rows
        likewise with `pair.row_looks`; the whole period of a circular record holds as many as the band has Fourier
        bins.
        """
        if pair.circular and self.samples == pair.shape[1]:
            in_time = Band(pair.grid, pair.bandwidth).looks
        else:
            in_time = _independent(self.samples, pair.bandwidth / pair.sample_rate)
        return _independent(self.rows, pair.row_looks) * in_time


def _cell(pair: EchoPair) -> int:
    """Samples in a resolution cell, rounded up."""
    return int(np.ceil(pair.sample_rate / pair.bandwidth))


def _sum(where: NDArray[np.bool_], samples: int, pair: EchoPair) -> Real:
    """How many there are in a window in time, of the shape of the pair."""
    return np.broadcast_to(window_sum(where.astype(float), 1, samples, circular=pair.circular), pair.shape)


def _unheard(pair: EchoPair) -> NDArray[np.bool_] | None:
    """Missing and silent samples of either receiver, shape (rows, time); None where there are none."""
    length = min(2 * _cell(pair) + 1, (pair.shape[1] - 1) // 2 * 2 + 1)
    found = pair.missing
    for series in (pair.primary, pair.secondary):
        if np.count_nonzero(series) < series.size:
            # All of a run as long as that, which a sum over it tells; odd, so that the way back is the same.
            whole = _sum(series == 0, length, pair) == length
            silent = _sum(whole, length, pair) > 0
            found = silent if found is None else found | silent
    return found


def _independent(count: int, share: float) -> float:
    """Independent ones among so many neighbours of a flat band that fills a share of the sampled one."""
    apart = np.arange(1, count)
    return count**2 / (count + 2 * float(np.sum((count - apart) * np.sinc(share * apart) ** 2)))


@dataclass(frozen=True, eq=False)
class VaryingWindow:
    """A rectangle of pixels whose size varies with time and is the same for all rows; what a policy gives for a pair.

    At each time it does what a `FixedWindow` of that size does.

    Parameters
    ----------
    rows, samples
        Its sizes along track and in time, shape (time,).

    Raises
    ------
    ValueError
        For shapes that differ, or a size that is not a whole number of at least one; by the estimators, for another
        number of times than the pair has, and for a size beyond that of the pair.
    """

    rows: Sizes
    samples: Sizes

    def __post_init__(self) -> None:
        for name in ("rows", "samples"):
            sizes = np.asarray(getattr(self, name))
            if sizes.ndim != 1 or sizes.dtype.kind not in "iu" or sizes.size == 0 or sizes.min() < 1:
                least = f", {sizes.min():g} at the least" if sizes.size and sizes.dtype.kind in "iuf" else ""
                raise ValueError(
                    f"{name} of the window are {sizes.dtype} of shape {sizes.shape}{least}; "
                    "they must be whole numbers of at least 1, one for each time"
                )
            object.__setattr__(self, name, sizes.astype(np.int64))
        if self.rows.shape != self.samples.shape:
            raise ValueError(
                f"the window has sizes for {self.rows.size} and {self.samples.size} times; it must be as many"
            )

    def __str__(self) -> str:
        return f"{self.rows.min()}x{self.samples.min()} to {self.rows.max()}x{self.samples.max()}"

    def on(self, pair: EchoPair) -> "VaryingWindow":
        """Itself: it was made for a pair."""
        return self

    @property
    def extent(self) -> tuple[int, int]:
        """Most rows and most samples at any time."""
        return int(self.rows.max()), int(self.samples.max())

    @property
    def pixels(self) -> Sizes:
        """Pixels in it at each time."""
        return self.rows * self.samples

    def check(self, pair: EchoPair) -> None:
        """ValueError where the window is larger than the pair, or made for another number of times."""
        if self.rows.size != pair.shape[1]:
            raise ValueError(
                f"the window has sizes for {self.rows.size} times; it must have them for all {pair.shape[1]}"
            )
        FixedWindow(*self.extent).check(pair)

    def sum(self, array: NDArray[Any]) -> NDArray[Any]:
        """Sum of (..., rows, time) over the window around each pixel: clipped in rows, circular in time.

        Times beyond those that have a size take the last one.
        """
        beyond = array.shape[-1] - self.rows.size
        rows, samples = (np.pad(sizes, (0, beyond), mode="edge") for sizes in (self.rows, self.samples))
        return window_sum(array, rows, samples, circular=True)

    def inside(self, pair: EchoPair) -> NDArray[np.bool_]:
        """Where the window lies within the pair and away from what no receiver heard; shape (rows, time)."""
        inside, unheard = np.empty(pair.shape, dtype=np.bool_), _unheard(pair)
        for window, at in self._by_size():
            inside[:, at] = window._inside(pair, unheard)[:, at]
        return inside

    def looks(self, pair: EchoPair) -> Real:
        """Equivalent independent looks at each time, as those of a `FixedWindow`; shape (time,)."""
        looks = np.empty(pair.shape[1])
        for window, at in self._by_size():
            looks[at] = window.looks(pair)
        return looks

    def _by_size(self) -> Iterator[tuple[FixedWindow, NDArray[np.bool_]]]:
        """A fixed window for each distinct size, and at which times it stands."""
        sizes = np.stack([self.rows, self.samples], axis=1)
        distinct, which = np.unique(sizes, axis=0, return_inverse=True)
        for number, (rows, samples) in enumerate(distinct):
            yield FixedWindow(int(rows), int(samples)), which.reshape(-1) == number


Window = FixedWindow | VaryingWindow
"""What an estimator averages over in one pair."""


@runtime_checkable
class WindowPolicy(Protocol):
    """Anything that gives the window for a pair."""

    def on(self, pair: EchoPair) -> Window:
        """The window for a pair; ValueError where the pair does not tell what it depends on."""


def _fits(available: int, size: int) -> NDArray[Any]:
    first = np.arange(available) - size // 2
    return (first >= 0) & (first + size <= available)
