"""Which depths to keep, how far they reach, and how much of the seabed they cover."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from estimators.depth import DepthMap
from sim import checks


@dataclass(frozen=True, kw_only=True)
class Thresholds:
    """What a depth must keep to be valid; by default everything that the estimator calls valid does.

    With windows that adapt, a threshold on the predicted spread is the one to use: a lower coherence may be made up for
    by a larger window (paper B).

    Parameters
    ----------
    height_std
        Largest predicted standard deviation [m].
    coherence
        Least sample coherence, 0 to 1.
    wrap_error_probability
        Largest predicted probability of a wrap error, 0 to 1.

    Raises
    ------
    ValueError
        For a value outside these limits.
    """

    height_std: float = np.inf
    coherence: float = 0.0
    wrap_error_probability: float = 1.0

    def __post_init__(self) -> None:
        if not self.height_std > 0:
            raise ValueError(f"height_std is {self.height_std:g} m; it must be above 0 m")
        checks.within("coherence", self.coherence, 0.0, 1.0)
        checks.within("wrap_error_probability", self.wrap_error_probability, 0.0, 1.0)

    def mask(self, depths: DepthMap) -> NDArray[np.bool_]:
        """Depths that keep all of them, shape (rows, time)."""
        keeps: NDArray[np.bool_] = (
            depths.valid
            & (depths.height_std <= self.height_std)
            & (depths.coherence >= self.coherence)
            & (depths.wrap_error_probability <= self.wrap_error_probability)
        )
        return keeps


@dataclass(frozen=True)
class Coverage:
    """How much of the seabed has a valid depth.

    Attributes
    ----------
    valid_range
        As of `valid_range` [m].
    area
        Ground covered by valid depths [m^2].
    share
        Of the ground in the record, 0 to 1.
    """

    valid_range: float
    area: float
    share: float


def coverage(depths: DepthMap, thresholds: Thresholds) -> Coverage:
    """Range and area of the depths that keep their thresholds; pixels count with their size on the reference plane.

    Parameters
    ----------
    depths, thresholds
        The depths, and what they must keep.

    Returns
    -------
    Coverage
        Range [m], area [m^2] and share.

    Raises
    ------
    ValueError
        As `valid_range`.
    """
    cells = np.where(np.isfinite(depths.plane_range), depths.cell, 0.0)
    kept = thresholds.mask(depths)
    area = float((kept.sum(axis=0) * cells).sum())
    whole = float(cells.sum()) * kept.shape[0]
    return Coverage(valid_range(depths, thresholds.height_std), area, area / whole if whole > 0 else 0.0)


def valid_range(depths: DepthMap, height_std: float, *, over: float = 1.0) -> float:
    """Largest ground range up to which the median predicted spread of the height is within a threshold.

    The median is over all valid depths of a piece of ground range. The range begins with the nearest piece where it is
    within, and ends before the next where it is not; pieces without a valid depth are passed over.

    Parameters
    ----------
    depths
        The depths.
    height_std
        The threshold [m].
    over
        Length of a piece [m]; paper B's figures take 1 m.

    Returns
    -------
    float
        The ground range of the reference plane at the last time of the range [m]; 0 where no piece is within.

    Raises
    ------
    ValueError
        For a piece of 0 m or less.
    """
    checks.positive("over", over, "m")
    told = depths.valid.any(axis=0) & np.isfinite(depths.plane_range)
    if not told.any():
        return 0.0
    spread, ground = np.where(depths.valid, depths.height_std, np.nan)[:, told], depths.plane_range[told]
    borders = np.flatnonzero(np.diff(np.floor(ground / over))) + 1
    within = np.array([np.nanmedian(piece) for piece in np.split(spread, borders, axis=1)]) <= height_std
    if not within.any():
        return 0.0
    first = int(within.argmax())
    # One that is not within stands behind the last.
    after = first + int(np.append(~within[first:], True).argmax())
    return float(ground[np.append(borders, ground.size)[after - 1] - 1])
