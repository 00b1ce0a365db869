"""What two receivers recorded, and what is known of it."""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sim import checks
from sim.band import Real, TimeGrid
from sim.geometry import Geometry


@dataclass(frozen=True)
class Truth:
    """What a perfect estimator would find, on the time grid of the primary.

    Attributes
    ----------
    delay
        Delay of the secondary behind the primary as the pair stands (after registration, where it was
        registered) [s]; shape (time,) where all rows are alike, (rows, time) where they are not, or (rows, 1). NaN
        where it is not unique: in shadow and layover.
    height
        Height above the reference plane [m], NaN likewise; None for a homogeneous patch.
    shadow
        Where a receiver sees no seabed at all; shape of `delay`.
    layover
        Where a receiver sees more than one part of the seabed at once; shape of `delay`.
    branches
        Delays of all parts of the seabed that both receivers see at a time [s], shape (branch, time) or (branch,
        rows, time), NaN where a branch is not seen.
    """

    delay: Real
    height: Real | None = None
    shadow: NDArray[np.bool_] | None = None
    layover: NDArray[np.bool_] | None = None
    branches: Real | None = None

    def rows(self, chosen: slice) -> "Truth":
        """That of only these rows."""
        if np.ndim(self.delay) == 1:
            return self
        return Truth(
            delay=self.delay[chosen],
            height=None if self.height is None else self.height[chosen],
            shadow=None if self.shadow is None else self.shadow[chosen],
            layover=None if self.layover is None else self.layover[chosen],
            branches=None if self.branches is None else self.branches[:, chosen],
        )


@dataclass(frozen=True, eq=False)
class EchoPair:
    """Matched-filtered complex-baseband series of both receivers.

    The convention is `secondary(t + delay) ~ primary(t) exp(-2 pi i fc delay)`.

    Parameters
    ----------
    primary, secondary
        Complex arrays of one shape, axes (along_track, time); a single row may be given as a vector.
    sample_rate
        Samples per second [Hz], at least the bandwidth.
    centre_frequency, bandwidth
        `fc` and `B` of the band [Hz].
    truth
        What was simulated, where that is known.
    geometry
        Where the series were recorded, where that is known; gives heights.
    circular
        The record is periodic in time: after the last sample comes the first. So are simulated records;
        measured ones are not.
    likelihood_ratio
        How likely each row is in nature over how likely it was to be drawn, shape (rows,), where rare errors were
        made frequent: the mean of `likelihood_ratio * wrong` over rows is the natural rate. None where all rows are
        drawn as in nature.
    row_spacing
        Distance of rows along track [m], where that is known.
    row_looks
        Independent looks in a row among many, above 0 to 1: `row_spacing` over the along-track resolution where rows
        stand closer than that.
    missing
        Where a receiver recorded nothing that can be used, and both series hold zeros; shape (rows, time). No estimate
        is valid whose window comes near. None where nothing is missing.

    Raises
    ------
    ValueError
        For a value that cannot be, for shapes that differ and for samples that are not finite; `with_gaps` takes those.
    """

    primary: NDArray[Any]
    secondary: NDArray[Any]
    sample_rate: float
    centre_frequency: float
    bandwidth: float
    truth: Truth | None = None
    geometry: Geometry | None = None
    circular: bool = False
    likelihood_ratio: Real | None = None
    row_spacing: float | None = None
    row_looks: float = 1.0
    missing: NDArray[np.bool_] | None = None

    def __post_init__(self) -> None:
        for name in ("primary", "secondary"):
            series = np.atleast_2d(np.asarray(getattr(self, name)))
            if series.ndim != 2 or series.size == 0:
                raise ValueError(f"{name} has the shape {series.shape}; it must be (along_track, time), not empty")
            if not np.issubdtype(series.dtype, np.complexfloating):
                raise ValueError(f"{name} is of type {series.dtype}; it must be complex")
            checks.finite_samples(name, series)
            object.__setattr__(self, name, series)
        if self.primary.shape != self.secondary.shape:
            raise ValueError(
                f"primary has the shape {self.primary.shape} and secondary {self.secondary.shape}; they must be equal"
            )
        checks.positive("sample_rate", self.sample_rate, "Hz")
        checks.positive("centre_frequency", self.centre_frequency, "Hz")
        checks.positive("bandwidth", self.bandwidth, "Hz")
        if self.bandwidth > self.sample_rate:
            raise ValueError(
                f"bandwidth is {self.bandwidth:g} Hz; it must not exceed the sample rate, {self.sample_rate:g} Hz"
            )
        if self.bandwidth >= 2 * self.centre_frequency:
            raise ValueError(
                f"bandwidth is {self.bandwidth:g} Hz; it must be below twice the centre frequency, "
                f"{2 * self.centre_frequency:g} Hz"
            )
        if self.row_spacing is not None:
            checks.positive("row_spacing", self.row_spacing, "m")
        if not 0 < self.row_looks <= 1:
            raise ValueError(f"row_looks is {self.row_looks:g}; it must be above 0 and at most 1")
        if self.likelihood_ratio is not None:
            object.__setattr__(self, "likelihood_ratio", self._checked_ratio(self.likelihood_ratio))
        if self.missing is not None:
            missing = np.atleast_2d(np.asarray(self.missing))
            if missing.shape != self.shape or missing.dtype != np.bool_:
                raise ValueError(
                    f"missing has the shape {missing.shape} and type {missing.dtype}; it must be {self.shape} and bool"
                )
            object.__setattr__(self, "missing", missing)

    @classmethod
    def with_gaps(
        cls,
        primary: NDArray[Any],
        secondary: NDArray[Any],
        sample_rate: float,
        centre_frequency: float,
        bandwidth: float,
        **known: Any,
    ) -> "EchoPair":
        """The pair of series that are not finite everywhere: such samples of either are missing, and zero in both.

        Parameters
        ----------
        primary, secondary
            Complex arrays of one shape, axes (along_track, time), or vectors.
        sample_rate, centre_frequency, bandwidth
            [Hz]
        known
            What else a pair is made of, by name.

        Raises
        ------
        ValueError
            As of a pair.
        """
        first, second = (np.atleast_2d(np.asarray(series)) for series in (primary, secondary))
        band = sample_rate, centre_frequency, bandwidth
        if first.shape != second.shape:
            return cls(first, second, *band, **known)
        bad: NDArray[np.bool_] = ~(np.isfinite(first) & np.isfinite(second))
        if bad.any():
            first, second = (np.where(bad, np.zeros((), series.dtype), series) for series in (first, second))
            known["missing"] = bad | known["missing"] if known.get("missing") is not None else bad
        return cls(first, second, *band, **known)

    def _checked_ratio(self, likelihood_ratio: Real) -> Real:
        ratio = np.asarray(likelihood_ratio, dtype=float)
        if ratio.shape != self.shape[:1]:
            raise ValueError(
                f"likelihood_ratio has the shape {ratio.shape}; it must have one number for each of the "
                f"{self.shape[0]} rows"
            )
        checks.finite_samples("likelihood_ratio", ratio)
        if ratio.min() < 0:
            raise ValueError(f"likelihood_ratio has the value {ratio.min():g}; it must not be below 0")
        return ratio

    @property
    def shape(self) -> tuple[int, int]:
        """(rows along track, samples in time)."""
        rows, samples = self.primary.shape
        return rows, samples

    def rows(self, chosen: slice) -> "EchoPair":
        """The same pair with only these of its rows, and what is known of them."""
        return replace(
            self,
            primary=self.primary[chosen],
            secondary=self.secondary[chosen],
            truth=None if self.truth is None else self.truth.rows(chosen),
            likelihood_ratio=None if self.likelihood_ratio is None else self.likelihood_ratio[chosen],
            missing=None if self.missing is None else self.missing[chosen],
        )

    @property
    def grid(self) -> TimeGrid:
        """The instants of the samples."""
        start = 0.0 if self.geometry is None else self.geometry.start
        return TimeGrid(self.shape[1], self.sample_rate, start)
