"""Which errors of an estimate of a scene are read: outside layover and in it, or range by range."""

from collections.abc import Callable
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from estimators import DelayEstimate
from estimators.moving_sum import window_sum
from estimators.windows import Window
from sim import EchoPair, Sonar
from sim.band import Real
from sim.coherence import baseline_coherence, noise_coherence
from studies.world import Reading

Level = Callable[[Sonar, Real], Real]
"""Signal-to-noise ratio of the flat floor at ground ranges [dB]."""


class Bins(NamedTuple):
    """Stretches of ground range of one length, between two ends [m]; their borders are multiples of the length."""

    ends: tuple[float, float]
    length: float

    def stretches(self, ground_range: Real) -> list[tuple[float, slice]]:
        """The middle [m] and the samples of each that lies between the ends; `ground_range` rises or is NaN."""
        whole = np.ceil(self.ends[0] / self.length), np.floor(self.ends[1] / self.length)
        borders = np.arange(whole[0], whole[1] + 1) * self.length
        first = np.searchsorted(np.nan_to_num(ground_range), borders)
        samples = [slice(int(start), int(stop)) for start, stop in pairwise(first)]
        middles = (borders[:-1] + self.length / 2).tolist()
        return [(middle, part) for middle, part in zip(middles, samples, strict=True) if part.start < part.stop]


def by_kind(pair: EchoPair, window: Window, estimate: DelayEstimate, overlap: int) -> list[Reading]:
    """Errors outside layover, and in it; there, against the nearest of the parts that are heard at once.

    A cluster is a row: the rows read are as far apart as a window has rows, and further by the along-track
    resolution where neighbours are alike, so that what one window holds and the next is independent but for side
    lobes of the resolution, 5 % of power at the most.

    Parameters
    ----------
    pair, window, estimate
        The echoes, and what was made of them with which window.
    overlap
        Rows at either end that belong to another block.
    """
    truth = pair.truth
    assert truth is not None
    assert truth.branches is not None
    assert truth.layover is not None
    rows = _apart(pair, window.extent[0], overlap)
    chosen = rows if np.ndim(truth.delay) == 2 else slice(None)
    delay, true = estimate.delay[rows], np.atleast_2d(truth.delay)[chosen]
    readings = [_reading("outside", delay - true, rows, np.atleast_2d(clear(pair, window))[chosen])]
    heard = np.isfinite(truth.branches).any(axis=0)
    layover = np.atleast_2d(truth.layover & heard)[chosen]
    if layover.any():
        branches = truth.branches.reshape(len(truth.branches), -1, pair.shape[1])[:, chosen]
        readings.append(_reading("layover", _nearest(delay, branches), rows, layover))
    return readings


def over_range(
    pair: EchoPair, window: Window, estimate: DelayEstimate, overlap: int, bins: Bins, level: Level
) -> list[Reading]:
    """Errors outside layover, a region for each bin of ground range, with the facts `RANGED` and those of its level.

    The true coherence is that of the noise and of the two angles of view, on the plane. Rows are read as in `by_kind`,
    as far apart as the windows of their own bin need.

    Parameters
    ----------
    pair, window, estimate, overlap
        As in `by_kind`.
    bins
        The stretches of ground range.
    level
        What the sonar has there.
    """
    truth, geometry = pair.truth, pair.geometry
    assert truth is not None
    assert geometry is not None
    sonar, slant = geometry.sonar, geometry.slant_range(pair.grid.times)
    seen, true = np.broadcast_to(clear(pair, window), pair.shape), np.broadcast_to(truth.delay, pair.shape)
    sizes, looks = (np.broadcast_to(np.asarray(a, float), pair.shape[1:]) for a in (window.rows, window.looks(pair)))
    stretches = bins.stretches(geometry.ground_range(pair.grid.times))
    middles = np.array([middle for middle, _ in stretches])
    ratios = level(sonar, middles)
    coherences = noise_coherence(ratios) * baseline_coherence(sonar, np.hypot(middles, sonar.altitude))
    found = []
    for (middle, part), ratio, coherence in zip(stretches, ratios.tolist(), coherences.tolist(), strict=True):
        rows = _apart(pair, int(sizes[part].max()), overlap)
        counted = seen[rows, part]
        if not counted.any():
            continue
        facts = {
            "ground_range": middle,
            "looks": float(looks[part].mean()),
            "coherence": coherence,
            "snr_db": ratio,
            "depth_per_delay": float(slant[part].mean()) * sonar.sound_speed / sonar.baseline,
            "window_rows": float(sizes[part].mean()),
            "sample_coherence": float(estimate.coherence[rows, part][counted].mean()),
        }
        errors = estimate.delay[rows, part] - true[rows, part]
        found.append(Reading(f"{middle:g} m", errors, rows, part, counted, facts))
    return found


def _apart(pair: EchoPair, most: int, overlap: int) -> slice:
    """Rows whose windows of so many lie within a block's own and apart; the first whose window might, at the least."""
    first, beyond = overlap + most // 2, pair.shape[0] - overlap - (most - 1) // 2
    return slice(first, max(beyond, first + 1), most + _cell_rows(pair))


def _cell_rows(pair: EchoPair) -> int:
    """Rows within the along-track resolution; none where rows are independent."""
    return 0 if pair.row_looks == 1 else int(np.ceil(1 / pair.row_looks))


def _reading(region: str, errors: Real, rows: slice, counted: NDArray[np.bool_]) -> Reading:
    """A reading of the samples that count in some row; `counted` has shape (row or 1, time)."""
    samples = np.asarray(counted.any(axis=0))
    return Reading(region, errors[:, samples], rows, samples, counted[:, samples])


def _nearest(delay: Real, branches: Real) -> Real:
    """Errors against the nearest of the branches, shape (branch, row or 1, time); NaN where none is heard."""
    nearest = np.full(delay.shape, np.nan)
    distance = np.full(delay.shape, np.inf)
    for branch in branches:
        nearer = np.abs(delay - branch) < distance
        nearest = np.where(nearer, delay - branch, nearest)
        distance = np.where(nearer, np.abs(delay - branch), distance)
    return nearest


def clear(pair: EchoPair, window: Window) -> NDArray[np.bool_]:
    """Samples whose window, and a resolution cell to either side of it, holds neither shadow nor layover.

    Of the shape of the true delay: (time,) or (rows, time).
    """
    truth = pair.truth
    assert truth is not None
    rows, samples = window.extent
    reach = min(samples + 2 * int(np.ceil(pair.sample_rate / pair.bandwidth)), pair.shape[1])
    unseen = np.atleast_2d(np.isnan(truth.delay)).astype(float)
    within = rows + 2 * _cell_rows(pair) if len(unseen) > 1 else 1
    seen = window_sum(unseen, within, reach, circular=True) == 0
    return np.broadcast_to(seen, unseen.shape).reshape(truth.delay.shape)
