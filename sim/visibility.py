"""Which parts of a scene are seen."""

import numpy as np
from numpy.typing import NDArray

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
    highest_before = np.maximum.accumulate(tangents)[points.segment]
    faces = np.diff(tangents) > 0
    ground_range, height = profile.position(points)
    tangent = (height - altitude) / ground_range
    seen: NDArray[np.bool_] = faces[points.segment] & (tangent >= highest_before - 1e-12 * np.abs(highest_before))
    return seen
