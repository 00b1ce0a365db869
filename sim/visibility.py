"""Which parts of a scene a receiver sees, and when: shadow and layover."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sim.band import Real
from sim.echo_pair import Truth
from sim.geometry import Geometry, plane_delay, travel_times
from sim.scene import Scene
from sim.sonar import Sonar


class SeabedPoints(NamedTuple):
    """Points on the profile of a scene: the segment that each lies on, and where along it (0 to 1)."""

    segment: NDArray[np.int64]
    share: Real


def position(scene: Scene, points: SeabedPoints) -> tuple[Real, Real]:
    """Ground range and height of points [m]."""
    corners = scene.profile
    first, last = corners[points.segment], corners[points.segment + 1]
    place = first + points.share[..., None] * (last - first)
    return place[..., 0], place[..., 1]


def sees(scene: Scene, points: SeabedPoints, altitude: float) -> NDArray[np.bool_]:
    """Whether nothing of the scene stands between points and an observer at ground range 0.

    Along a straight segment the tangent of the elevation angle, `(z - h) / y`, is monotonic, so that a point is
    seen where its own is no less than that of all corners before it. A segment that faces away is not seen.

    Parameters
    ----------
    scene, points
        Points on the profile, any shape.
    altitude
        Height of the observer, `h` [m].

    Returns
    -------
    array of bool
        Of the shape of the points.
    """
    corners = scene.profile
    tangents = (corners[:, 1] - altitude) / corners[:, 0]
    highest_before = np.maximum.accumulate(tangents)[points.segment]
    faces = np.diff(tangents) > 0
    ground_range, height = position(scene, points)
    tangent = (height - altitude) / ground_range
    return faces[points.segment] & (tangent >= highest_before - 1e-12 * np.abs(highest_before))


def seen_at(scene: Scene, sonar: Sonar, time: Real, receiver_altitude: float) -> tuple[SeabedPoints, NDArray[np.bool_]]:
    """All points of the seabed that a receiver hears at given times, and whether it does.

    The echo of a path length `L = c t` comes from the ellipse `|x - T| + |x - R| = L` around transmitter and
    receiver. On the segment `x = x0 + u d` both squared distances are quadratic in `u`, and so is
    `(L^2 + |x - T|^2 - |x - R|^2)^2 = 4 L^2 |x - T|^2`, since the difference of the squares is linear.

    Parameters
    ----------
    scene, sonar
        The scene, and the transmitter at `sonar.altitude`.
    time
        Times at that receiver [s], shape (time,).
    receiver_altitude
        Height of the receiver, straight above or at the transmitter [m].

    Returns
    -------
    points, heard
        Both of the shape (2 x segments, time): the candidates (two a segment), and which of them exist and are
        seen by transmitter and receiver.
    """
    corners = scene.profile
    origin, direction = corners[:-1, None, :], np.diff(corners, axis=0)[:, None, :]
    path = sonar.sound_speed * time
    to_point = origin - np.array([0.0, sonar.altitude])
    a = (direction**2).sum(-1)
    b = (to_point * direction).sum(-1)
    c = (to_point**2).sum(-1)
    rise = receiver_altitude - sonar.altitude
    # |x - T|^2 - |x - R|^2 = constant + slope u
    slope = 2 * rise * direction[..., 1]
    constant = 2 * rise * to_point[..., 1] - rise**2
    known = path**2 + constant
    qa = 4 * path**2 * a - slope**2
    qb = 4 * path**2 * b - known * slope
    qc = 4 * path**2 * c - known**2
    discriminant = qb**2 - qa * qc
    root = np.sqrt(np.maximum(discriminant, 0.0))
    # No length of seabed and no path have no echo.
    exists = qa > 0
    qa = np.where(exists, qa, 1.0)
    share = np.concatenate([(-qb - root) / qa, (-qb + root) / qa])
    segment = np.broadcast_to(np.tile(np.arange(len(a)), 2)[:, None], share.shape)
    real = np.tile(exists & (discriminant >= 0), (2, 1)) & (share >= 0) & (share < 1)
    points = SeabedPoints(segment, np.where(real, share, 0.0))
    seen = sees(scene, points, sonar.altitude) & sees(scene, points, receiver_altitude)
    return points, real & seen


def truth(scene: Scene, geometry: Geometry, time: Real) -> Truth:
    """Delays, heights, shadow and layover of a scene in a registered pair.

    Shadow is where either receiver hears no seabed at the time, layover where either hears more than one part of it.

    Parameters
    ----------
    scene
        The scene.
    geometry
        The sonar, and the registration of the pair.
    time
        Times at the primary [s], shape (time,).
    """
    sonar = geometry.sonar
    upper = sonar.altitude + sonar.baseline
    points, primary = seen_at(scene, sonar, time, sonar.altitude)
    _, secondary = seen_at(scene, sonar, time + plane_delay(sonar, time), upper)
    primary_parts, secondary_parts = primary.sum(axis=0), secondary.sum(axis=0)

    ground_range, height = position(scene, points)
    shared = primary & sees(scene, points, upper)
    delay = np.where(shared, geometry.registered_delay(*travel_times(sonar, ground_range, height)), np.nan)
    unique = (primary_parts == 1) & (secondary_parts == 1) & (shared.sum(axis=0) == 1)
    one = shared.argmax(axis=0)[None]
    return Truth(
        delay=np.where(unique, np.take_along_axis(delay, one, axis=0)[0], np.nan),
        height=np.where(unique, np.take_along_axis(height, one, axis=0)[0], np.nan),
        shadow=(primary_parts == 0) | (secondary_parts == 0),
        layover=(primary_parts > 1) | (secondary_parts > 1),
        branches=delay[np.isfinite(delay).any(axis=1)],
    )
