"""A section through a scene, and points on it."""

import math
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sim.band import Real
from sim.compiled import compiled


class SeabedPoints(NamedTuple):
    """Points on a profile: the segment that each lies on, and where along it (0 to 1)."""

    segment: NDArray[np.int64]
    share: Real

    def chosen(self, which: NDArray[np.bool_]) -> "SeabedPoints":
        """Those of them for which `which` holds."""
        return SeabedPoints(self.segment[which], self.share[which])


@dataclass(frozen=True, eq=False)
class Profile:
    """Corners of the seabed in the order of its outline, straight in between.

    Attributes
    ----------
    ground_range, height
        Of the corners [m], shape (corner,); a wall has two corners at one ground range.
    along_track
        Where along the track the section lies [m].
    """

    ground_range: Real
    height: Real
    along_track: float = 0.0

    @cached_property
    def along(self) -> Real:
        """Extent of the segments in ground range [m]."""
        return np.diff(self.ground_range)

    @cached_property
    def up(self) -> Real:
        """Rise of the segments [m]."""
        return np.diff(self.height)

    @cached_property
    def lengths(self) -> Real:
        """Of the segments [m]."""
        return np.hypot(self.along, self.up)

    def position(self, points: SeabedPoints) -> tuple[Real, Real]:
        """Ground range and height of points [m]."""
        return _position(self.ground_range, self.height, *points)

    def closing(self, points: SeabedPoints, altitude: float) -> Real:
        """Growth of the slant range from ground range 0 at an altitude [m] along the outline, `dr / dl`, -1 to 1."""
        return _closing(self.ground_range, self.height, *points, float(altitude))


@compiled
def _position(corner_range: Real, corner_height: Real, segments: NDArray[np.int64], shares: Real) -> tuple[Real, Real]:
    ground_range, height = np.empty(len(segments)), np.empty(len(segments))
    for point in range(len(segments)):
        segment, share = segments[point], shares[point]
        near, low = corner_range[segment], corner_height[segment]
        ground_range[point] = near + share * (corner_range[segment + 1] - near)
        height[point] = low + share * (corner_height[segment + 1] - low)
    return ground_range, height


@compiled
def _closing(
    corner_range: Real, corner_height: Real, segments: NDArray[np.int64], shares: Real, altitude: float
) -> Real:
    growth = np.empty(len(segments))
    for point in range(len(segments)):
        segment, share = segments[point], shares[point]
        near, low = corner_range[segment], corner_height[segment]
        along, up = corner_range[segment + 1] - near, corner_height[segment + 1] - low
        ground_range, depth = near + share * along, altitude - (low + share * up)
        growth[point] = (along * ground_range - up * depth) / math.sqrt(
            (along**2 + up**2) * (ground_range**2 + depth**2)
        )
    return growth
