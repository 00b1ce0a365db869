"""Which parts of a scene are seen."""

import numpy as np
from numpy.typing import NDArray

from sim.band import Real
from sim.compiled import compiled
from sim.profile import Profile, SeabedPoints


def sees(profile: Profile, points: SeabedPoints, altitude: float) -> NDArray[np.bool_]:
    """Whether nothing of the seabed stands between points and an observer at ground range 0.

    Along a straight segment the tangent of the elevation angle, `(z - h) / y`, is monotonic, so that a point is
    seen where its own is no less than that of all corners before it. A segment that faces away is not seen.

    Parameters
    ----------
    profile, points
        Points on the profile, any shape.
    altitude
        Height of the observer, `h` [m].

    Returns
    -------
    array of bool
        Of the shape of the points.
    """
    tangents = (profile.height - altitude) / profile.ground_range
    return _sees(
        profile.ground_range, profile.height, np.maximum.accumulate(tangents), np.diff(tangents) > 0, *points,
        float(altitude),
    )  # fmt: skip


@compiled
def _sees(
    corner_range: Real,
    corner_height: Real,
    highest: Real,
    faces: NDArray[np.bool_],
    segments: NDArray[np.int64],
    shares: Real,
    altitude: float,
) -> NDArray[np.bool_]:
    """Whether segments face the observer, and points on them rise above the highest tangent before."""
    seen = np.empty(len(segments), np.bool_)
    for point in range(len(segments)):
        segment, share = segments[point], shares[point]
        near, low, before = corner_range[segment], corner_height[segment], highest[segment]
        ground_range = near + share * (corner_range[segment + 1] - near)
        tangent = (low + share * (corner_height[segment + 1] - low) - altitude) / ground_range
        seen[point] = faces[segment] and tangent >= before - 1e-12 * abs(before)
    return seen
