"""A section through a scene, and points on it."""

from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sim.band import Real


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
        segment, share = points
        return (
            self.ground_range[segment] + share * self.along[segment],
            self.height[segment] + share * self.up[segment],
        )

    def closing(self, points: SeabedPoints, altitude: float) -> Real:
        """Growth of the slant range from ground range 0 at an altitude [m] along the outline, `dr / dl`, -1 to 1."""
        ground_range, height = self.position(points)
        depth = altitude - height
        along, up = self.along[points.segment], self.up[points.segment]
        growth: Real = (along * ground_range - up * depth) / (
            self.lengths[points.segment] * np.sqrt(ground_range**2 + depth**2)
        )
        return growth
