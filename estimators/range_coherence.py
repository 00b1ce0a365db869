"""Coherence over range: measured, known, or modelled."""

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike

from estimators.interferogram import at_zero_lag
from estimators.uncertainty import debiased_coherence
from estimators.windows import FixedWindow
from sim import EchoPair, Geometry, Sediment, checks, expected_coherence
from sim.band import Real
from sim.scattering import Model


class RangeCoherence(Protocol):
    """Anything that says the coherence of a pair at each time."""

    def over_time(self, pair: EchoPair, geometry: Geometry) -> Real:
        """Coherence, 0 to 1, shape (time,)."""


@dataclass(frozen=True)
class MeasuredCoherence:
    """Coherence of the pair itself, debiased.

    The sample coherence at zero lag of a first window is averaged over all rows, and over slant range with the weights
    of a Hann window; the coherence whose mean sample coherence this is (`bounds.debias_coherence`) is the result.
    (Paper B takes the sample coherence as it is: 9 x 9 pixels of 32.4 looks read .231 where the coherence is .187.)

    A seabed that is not on the plane of registration loses coherence at zero lag, by `sinc(B tau)` at the delay `tau`.
    Times where no whole window holds an echo take the mean of the nearest that have one; a pair without any, none.

    Parameters
    ----------
    rows, samples
        The first window; where the pair has less, all that it has. It must hold more than one look.
    smoothing
        Length over which to average [m of slant range].

    Raises
    ------
    ValueError
        For a window of a single pixel, and a smoothing outside 0 to 1,000,000 m.
    """

    rows: int = 9
    samples: int = 9
    smoothing: float = 1.0

    def __post_init__(self) -> None:
        checks.count("rows of the window", self.rows)
        checks.count("samples of the window", self.samples)
        checks.within("smoothing", self.smoothing, 0.0, 1e6, "m")
        if self.rows * self.samples == 1:
            raise ValueError("the first window is 1x1; it must have more pixels than one")

    def over_time(self, pair: EchoPair, geometry: Geometry) -> Real:
        """Coherence of a pair at each time, shape (time,)."""
        rows, samples = pair.shape
        window = FixedWindow(min(self.rows, rows), min(self.samples, samples))
        peak = at_zero_lag(pair, window)
        usable = window.inside(pair) & (peak.energy > 0)
        sample = np.divide(np.abs(peak.product), peak.energy, out=np.zeros(pair.shape), where=usable)
        extent = geometry.sonar.sound_speed / (2 * pair.sample_rate)
        total, count = (
            _smoothed(array.sum(axis=0, dtype=float), self.smoothing / extent) for array in (sample, usable)
        )
        seen = count > 0
        if not seen.any():
            return np.zeros(pair.shape[1])
        times = np.arange(pair.shape[1])
        mean = np.interp(times, times[seen], total[seen] / count[seen])
        return debiased_coherence(np.minimum(mean, 1.0), window.looks(pair))


def _smoothed(series: Real, samples: float) -> Real:
    """Weighted sum over so many samples about each, and none beyond the ends."""
    reach = min(int(samples / 2), (series.size - 1) // 2)
    smoothed: Real = np.convolve(series, np.hanning(2 * reach + 3)[1:-1], mode="same")
    return smoothed


@dataclass(frozen=True, eq=False)
class KnownCoherence:
    """A curve of coherence over ground range, on straight lines between its points; constant beyond them.

    Parameters
    ----------
    coherence
        0 to 1; one number, or shape (range,).
    ground_range
        Where it was found [m], rising; as many.

    Raises
    ------
    ValueError
        For a coherence outside 0 to 1, ranges that do not rise, and numbers of them that differ.
    """

    coherence: ArrayLike
    ground_range: ArrayLike = 0.0

    def __post_init__(self) -> None:
        coherence, ground = (np.atleast_1d(np.asarray(a, dtype=float)) for a in (self.coherence, self.ground_range))
        if coherence.shape != ground.shape or coherence.ndim != 1:
            raise ValueError(
                f"coherence has {coherence.size} values and ground_range {ground.size}; it must be as many"
            )
        bad = ~((coherence >= 0) & (coherence <= 1))
        if bad.any():
            raise ValueError(f"coherence is {coherence[bad][0]:g}; it must lie between 0 and 1")
        checks.finite_samples("ground_range", ground)
        falls = np.flatnonzero(np.diff(ground) <= 0)
        if falls.size:
            before, after = ground[falls[0] : falls[0] + 2]
            raise ValueError(f"ground_range has {after:g} m behind {before:g} m; it must rise")

    def over_time(self, pair: EchoPair, geometry: Geometry) -> Real:
        """Coherence of a pair at each time, shape (time,)."""
        points = np.atleast_1d(self.ground_range), np.atleast_1d(self.coherence)
        known: Real = np.interp(ground_range(pair, geometry), *points)
        return known


@dataclass(frozen=True)
class ModelledCoherence:
    """Coherence that the sonar equation gives of a flat seabed, `sim.expected_coherence`.

    Parameters
    ----------
    sediment
        A sediment, or the name of one in `sim.SEDIMENTS`.
    model
        Scattering model.
    """

    sediment: Sediment | str
    model: Model = "small-slope"

    def over_time(self, pair: EchoPair, geometry: Geometry) -> Real:
        """Coherence of a pair at each time, shape (time,); ValueError for an unknown sediment."""
        return expected_coherence(geometry.sonar, self.sediment, ground_range(pair, geometry), model=self.model)


def ground_range(pair: EchoPair, geometry: Geometry) -> Real:
    """Ground range of the reference plane at each time [m]; 0 before its first echo."""
    return np.nan_to_num(geometry.ground_range(pair.grid.times), nan=0.0)
