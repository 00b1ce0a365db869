"""Sections of a scene, what they hold, and how strong they are, in array operations."""

import numpy as np
from numpy.typing import NDArray

from sim import Scene, Sonar
from sim.band import Real
from sim.levels import SINES
from sim.profile import Profile, SeabedPoints


def profile(scene: Scene, along_track: float) -> Profile:
    """Its section at a place along track [m]."""
    near, far = scene.ground_range
    outlines = [feature.outline(along_track, scene.ground_range) for feature in scene.features]
    corners = [np.array([near, far], dtype=float), *(ground_range for ground_range, _ in outlines)]
    walls = [ground_range[1:][np.diff(ground_range) == 0] for ground_range, _ in outlines]
    once = np.unique(np.clip(np.concatenate(corners), near, far))
    twice = np.unique(np.concatenate([once[:0], *walls]))
    twice = twice[(twice >= near) & (twice <= far)]
    ground_range = np.sort(np.concatenate([once, twice]))
    # The first corner at a wall is its near side.
    far_side = np.append(False, np.diff(ground_range) == 0)
    height = np.zeros(len(ground_range))
    for outline in outlines:
        height += _height(outline, ground_range, far_side)
    return Profile(ground_range, height, along_track)


def _height(outline: tuple[Real, Real], ground_range: Real, far_side: NDArray[np.bool_]) -> Real:
    corners, heights = outline
    after = np.where(
        far_side, np.searchsorted(corners, ground_range, "right"), np.searchsorted(corners, ground_range, "left")
    )
    before, after = np.maximum(after - 1, 0), np.minimum(after, len(corners) - 1)
    length = corners[after] - corners[before]
    share = np.divide(ground_range - corners[before], length, out=np.zeros_like(ground_range), where=length > 0)
    height: Real = heights[before] + share * (heights[after] - heights[before])
    return height


def surveyed(profile: Profile, sonar: Sonar, ranges: Real, noise: Real) -> tuple[bool, bool, float, float]:
    """What `sim.survey.Survey` tells of a section: shadow, overlaid, shift and decorrelation."""
    upper = sonar.altitude + sonar.baseline
    tangents = ((profile.height - altitude) / profile.ground_range for altitude in (sonar.altitude, upper))
    real = profile.lengths > 0
    shadow = any(bool((np.diff(tangent)[real] <= 0).any()) for tangent in tangents)
    overlaid = bool(
        (profile.along * profile.ground_range[:-1] <= profile.up * (upper - profile.height[:-1]))[real].any()
    )
    within = np.clip(np.searchsorted(profile.ground_range, ranges, "right") - 1, 0, len(real) - 1)
    segment = np.concatenate([np.flatnonzero(real), within])
    y = np.concatenate([profile.ground_range[:-1][real], ranges])
    depth = upper - profile.height[segment]
    angle = np.minimum(np.arctan2(depth, y) + np.arctan2(profile.up, profile.along)[segment], np.radians(89.0))
    share = sonar.centre_frequency * sonar.baseline * y * np.abs(np.tan(angle)) / (2 * (y**2 + depth**2))
    shift = share / sonar.bandwidth
    part = shift / (shift + np.interp(y, ranges, noise))
    return shadow, overlaid, float(shift.max()), float(part.max())


def power(
    profile: Profile,
    points: SeabedPoints,
    altitude: float,
    tables: list[tuple[float, float, Real]],
    beams: Real,
) -> Real:
    """Strength of the last table, (near, far, strengths at `SINES`), that holds a point, times its beam."""
    ground_range, height = profile.position(points)
    depth = altitude - height
    slant = np.sqrt(ground_range**2 + depth**2)
    along, up = profile.along[points.segment], profile.up[points.segment]
    sine = (along * depth + up * ground_range) / (profile.lengths[points.segment] * slant)
    strength = np.zeros(len(sine))
    for near, far, table in tables:
        inside = (ground_range >= near) & (ground_range < far)
        strength[inside] = np.interp(sine[inside], SINES, table)
    found: Real = strength * np.interp(depth / slant, SINES, beams)
    return found
