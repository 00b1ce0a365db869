"""Which part of a scene is heard when, in array operations."""

import numpy as np
from numpy.typing import NDArray

from sim import Sonar
from sim.band import Real
from sim.heard import Heard
from sim.profile import Profile, SeabedPoints
from sim.visibility import sees


def heard_at(profile: Profile, sonar: Sonar, times: Real, receiver_altitude: float, *, shadow: bool = True) -> Heard:
    """All points of the seabed whose echo reaches a receiver at given times, and which it and the transmitter see.

    The path `L(u) = |x - T| + |x - R|` to a point `x = x0 + u d` of a segment is convex: it falls up to the point where
    a ray that is reflected at the segment's line would pass from `T` to `R`, and rises beyond. On either piece
    `(L^2 + |x - T|^2 - |x - R|^2)^2 = 4 L^2 |x - T|^2` is quadratic in `u`, since the difference of the squares is
    linear.

    Parameters
    ----------
    profile, sonar
        The seabed, and the transmitter at `sonar.altitude`.
    times
        Times at that receiver [s], rising, shape (time,).
    receiver_altitude
        Height of the receiver, straight above or at the transmitter [m].
    shadow
        False where nothing hides anything, to spare looking for it.
    """
    altitudes = np.array([sonar.altitude, receiver_altitude])
    path = sonar.sound_speed * times
    turn = _turning_point(profile, altitudes)
    at_corner = _path(profile.ground_range, profile.height, altitudes)
    at_turn = _path(*profile.position(SeabedPoints(np.arange(len(turn)), turn)), altitudes)
    # A time that falls on a corner belongs to one piece only.
    first = np.stack([np.searchsorted(path, at_turn, "right"), np.searchsorted(path, at_turn, "left")], axis=1)
    last = np.stack(
        [np.searchsorted(path, at_corner[:-1], "right"), np.searchsorted(path, at_corner[1:], "left")], axis=1
    )
    stretch = _stretches(np.stack([turn > 0, turn < 1], axis=1) & (profile.lengths > 0)[:, None])

    times_heard = np.maximum(last - first, 0).ravel()
    piece = np.repeat(np.arange(times_heard.size), times_heard)
    sample = np.arange(len(piece)) - np.repeat(np.cumsum(times_heard) - times_heard - first.ravel(), times_heard)
    points = SeabedPoints(
        piece // 2, _share(profile, altitudes, path[sample], piece // 2, np.where(piece % 2, 1.0, -1.0))
    )
    if not shadow:
        return Heard(points, sample, stretch[piece])
    seen = sees(profile, points, sonar.altitude) & sees(profile, points, receiver_altitude)
    return Heard(points.chosen(seen), sample[seen], stretch[piece[seen]])


def _path(ground_range: Real, height: Real, altitudes: Real) -> Real:
    """Path from the transmitter over points to the receiver [m]."""
    path: Real = np.hypot(ground_range, height - altitudes[0]) + np.hypot(ground_range, height - altitudes[1])
    return path


def _turning_point(profile: Profile, altitudes: Real) -> Real:
    """Where along each segment the path is shortest, 0 to 1.

    With the feet `u_T`, `u_R` and distances `h_T`, `h_R` of `T` and `R` from the segment's line it is at
    `(u_T h_R + u_R h_T) / (h_T + h_R)`.
    """
    square = np.where(profile.lengths > 0, profile.lengths**2, 1.0)
    below = profile.height[:-1, None] - altitudes
    near, along, up = profile.ground_range[:-1, None], profile.along[:, None], profile.up[:, None]
    foot = -(near * along + below * up) / square[:, None]
    distance = np.abs(near * up - below * along)
    weights = np.divide(
        distance[:, ::-1],
        distance.sum(axis=1, keepdims=True),
        out=np.full_like(distance, 0.5),
        where=distance.sum(axis=1, keepdims=True) > 0,
    )
    turn: Real = np.clip((weights * foot).sum(axis=1), 0.0, 1.0)
    return turn


def _stretches(present: NDArray[np.bool_]) -> NDArray[np.int64]:
    """Number of the stretch of every piece, from which pieces there are, shape (segment, falling or rising)."""
    rising = np.broadcast_to([False, True], present.shape)[present]
    number = np.zeros(present.shape, dtype=np.int64)
    number[present] = np.cumsum(np.append(0, np.diff(rising))[: len(rising)])
    return number.ravel()


def _share(profile: Profile, altitudes: Real, path: Real, segment: NDArray[np.int64], sign: Real) -> Real:
    """Where along their segments points lie that are heard after a path."""
    along, up = profile.along[segment], profile.up[segment]
    near, below = profile.ground_range[segment], profile.height[segment] - altitudes[0]
    rise = altitudes[1] - altitudes[0]
    # |x - T|^2 - |x - R|^2 = constant + slope u
    slope, known = 2 * rise * up, path**2 + 2 * rise * below - rise**2
    a = 4 * path**2 * (along**2 + up**2) - slope**2
    b = 4 * path**2 * (near * along + below * up) - known * slope
    c = 4 * path**2 * (near**2 + below**2) - known**2
    share: Real = np.clip((-b + sign * np.sqrt(np.maximum(b**2 - a * c, 0.0))) / a, 0.0, 1.0)
    return share
