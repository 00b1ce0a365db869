"""Windows whose size follows from how good a depth must be: paper B's two rules, and one that is safe of wraps."""

from abc import ABC, abstractmethod
from dataclasses import MISSING, Field, dataclass, field, fields, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from estimators import bounds
from estimators.pixels import Pixels, nearest_odd
from estimators.range_coherence import MeasuredCoherence, RangeCoherence
from estimators.ranges import Ranges
from estimators.window_sizes import (
    WrapErrors,
    least_coherence,
    side_of_constant_ratio,
    side_of_constant_std,
    smallest_safe,
)
from estimators.windows import VaryingWindow
from sim import EchoPair, Geometry, checks
from sim.band import Real


@dataclass(frozen=True, eq=False)
class View:
    """A pair as a policy sees it.

    Attributes
    ----------
    pair, pixels
        The pair, and its pixels on the ground.
    ranges
        How well a depth can be told at each time.
    """

    pair: EchoPair
    pixels: Pixels
    ranges: Ranges

    def square(self, side: NDArray[np.int64] | np.int64) -> VaryingWindow:
        """The window of an odd number of rows and the odd number of samples nearest to a square, within the pair."""
        most_rows, most_samples = (size - 1 + size % 2 for size in self.pair.shape)
        rows = np.broadcast_to(side, self.pair.shape[1:])
        samples = nearest_odd(rows * self.pixels.elongation)
        return VaryingWindow(np.minimum(rows, most_rows), np.minimum(samples, most_samples))


@dataclass(frozen=True, kw_only=True)
class SquareWindow(ABC):
    """Of all policies here: a square on the ground of an odd number of pixels that varies with range only.

    Parameters
    ----------
    coherence
        Where the coherence at each range comes from: `MeasuredCoherence`, `KnownCoherence` or `ModelledCoherence`.
    pixels
        The pixels on the ground; where None, those of the pair, `Pixels.of`.
    geometry
        Where the pair was recorded, for pairs that do not say it themselves.
    smallest, largest
        Limits of the rows of the window, odd. The samples follow from the pixels, so that it is as long as wide.

    Raises
    ------
    ValueError
        For limits that are not odd, or the smallest above the largest; by `on`, for a pair without geometry.
    """

    coherence: RangeCoherence = field(default_factory=MeasuredCoherence)
    pixels: Pixels | None = None
    geometry: Geometry | None = None
    smallest: int = 3
    largest: int = 61

    def __post_init__(self) -> None:
        for name in ("smallest", "largest"):
            size = getattr(self, name)
            if checks.count(name, size) % 2 == 0:
                raise ValueError(f"{name} is {size}; it must be odd")
        if self.smallest > self.largest:
            raise ValueError(f"smallest is {self.smallest}; it must be at most largest, {self.largest}")

    def __str__(self) -> str:
        """Its name, and what differs from the defaults."""
        given = [(f.name, getattr(self, f.name)) for f in fields(self) if getattr(self, f.name) != _default(f)]
        words = [f"{name}={getattr(value, '__name__', None) or value}" for name, value in given]
        return f"{type(self).__name__}({', '.join(words)})"

    def view(self, pair: EchoPair) -> View:
        """What of a pair decides the window."""
        geometry = pair.geometry if pair.geometry is not None else self.geometry
        if geometry is None:
            raise ValueError(f"the pair has no geometry; it must have one, or {type(self).__name__} be given geometry=")
        pixels = Pixels.of(pair, geometry) if self.pixels is None else self.pixels
        # A record may begin with the transmission, where nothing is heard.
        times, sonar = np.maximum(pair.grid.times, 1 / pair.sample_rate), geometry.sonar
        coherence = self.coherence.over_time(pair, geometry)
        slant, fc, bandwidth = geometry.slant_range(times), pair.centre_frequency, pair.bandwidth
        return View(pair, pixels, Ranges(slant, coherence, fc, bandwidth, sonar.baseline, sonar.sound_speed))

    def on(self, pair: EchoPair) -> VaryingWindow:
        """The window for a pair."""
        view = self.view(pair)
        return view.square(self.rows(view))

    @abstractmethod
    def rows(self, view: View) -> NDArray[np.int64]:
        """Its rows, odd and within the limits; shape (time,)."""

    def _within_limits(self, side: Real) -> NDArray[np.int64]:
        return nearest_odd(np.clip(side, self.smallest, self.largest))


def _default(of: "Field[Any]") -> Any:
    return of.default if of.default_factory is MISSING else of.default_factory()


@dataclass(frozen=True)
class ConstantStdWindow(SquareWindow):
    """The window whose depth has one standard deviation at all ranges (paper B, equation 5).

    Parameters
    ----------
    std
        Cramér-Rao bound of the depth [m].

    Raises
    ------
    ValueError
        For a `std` that is not above 0, and for limits as of `SquareWindow`.
    """

    std: float

    def __post_init__(self) -> None:
        super().__post_init__()
        checks.positive("std", self.std, "m")

    def side(self, view: View) -> Real:
        """Rows that equation 5 asks for, in real numbers and without limits; shape (time,)."""
        return side_of_constant_std(view.ranges.depth_crlb(1.0), self.std, view.pixels)

    def rows(self, view: View) -> NDArray[np.int64]:
        """Those of `side`, odd and within the limits; shape (time,)."""
        return self._within_limits(self.side(view))


@dataclass(frozen=True)
class AdaptiveWindow(SquareWindow):
    """The window that is `kappa` times as wide as the standard deviation of its depth (paper B, equation 7).

    Parameters
    ----------
    kappa
        Horizontal resolution over Cramér-Rao bound of the depth.

    Raises
    ------
    ValueError
        For a `kappa` that is not above 0, and for limits as of `SquareWindow`.
    """

    kappa: float

    def __post_init__(self) -> None:
        super().__post_init__()
        checks.positive("kappa", self.kappa)

    def side(self, view: View) -> Real:
        """Rows that equation 7 asks for, in real numbers and without limits; shape (time,)."""
        return side_of_constant_ratio(view.ranges.depth_crlb(1.0), self.kappa, view.pixels)

    def rows(self, view: View) -> NDArray[np.int64]:
        """Those of `side`, odd and within the limits; shape (time,)."""
        return self._within_limits(self.side(view))


@dataclass(frozen=True)
class WrapSafeWindow(SquareWindow):
    """The smallest window that is wide enough for its depth and has few wrap errors.

    Of all odd windows within the limits, the smallest that is at least `kappa` times as wide as the exact spread of its
    depth, `bounds.multilook_depth_std`, and whose predicted wrap-error probability at its own looks in the pair is at
    most `max_wrap_probability`; the largest where none is. Paper B's rule (equation 6) is the first condition alone; it
    says nothing of wraps.

    Where wraps ask for more looks than the depth does, two windows keep the resolution: `TwoWindow` of `apart`.

    Parameters
    ----------
    kappa
        Horizontal resolution over spread of the depth; 0 asks for none.
    max_wrap_probability
        Largest wrap-error probability; 1 allows all.
    predict
        How wrap errors are predicted; for the cross-correlation with refinement by default.

    Raises
    ------
    ValueError
        For a `kappa` or probability outside these limits, and for limits as of `SquareWindow`.
    """

    kappa: float
    max_wrap_probability: float
    predict: WrapErrors = bounds.cross_correlation_wrap_error_probability

    def __post_init__(self) -> None:
        super().__post_init__()
        checks.within("kappa", self.kappa, 0.0, 1e6)
        checks.within("max_wrap_probability", self.max_wrap_probability, 1e-12, 1.0)

    def rows(self, view: View) -> NDArray[np.int64]:
        """Its rows, odd and within the limits; shape (time,)."""
        sides = np.arange(self.smallest, self.largest + 1, 2, dtype=np.int64)
        looks = np.array([view.square(side).looks(view.pair) for side in sides])
        extent: Real = sides.astype(float) * view.pixels.along_track
        ratio, place = view.ranges.relative_bandwidth, np.arange(looks.shape[1])
        needed = least_coherence(self.predict, looks, ratio, self.max_wrap_probability)
        first = smallest_safe(
            extent, looks, view.ranges, self.kappa, lambda tried: view.ranges.coherence >= needed[tried, place]
        )
        return sides[np.minimum(first, sides.size - 1)]

    def apart(self) -> tuple["WrapSafeWindow", "WrapSafeWindow"]:
        """Its two conditions as a policy each: the window for the wrap, and that for the phase."""
        return replace(self, kappa=0.0), replace(self, max_wrap_probability=1.0)
