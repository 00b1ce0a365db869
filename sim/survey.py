"""What the sections of a scene hold that decides how it must be simulated."""

import math
from collections.abc import Iterable
from typing import NamedTuple

import numpy as np

from sim.band import Real
from sim.coherence import noise_coherence
from sim.compiled import compiled
from sim.scene import Scene
from sim.snr_profile import SnrProfile
from sim.sonar import Sonar
from sim.sonar_equation import snr as predicted_snr

SURVEYED = 65
"""Ranges over the swath at which decorrelation is looked at, beside the corners of the relief."""


class Survey(NamedTuple):
    """What the sections of all rows hold at the most.

    `corners` of a section; whether a part is in `shadow` of another, or may be `overlaid`, heard at once with another;
    the share of the band, `df / B`, by which the two angles of view `shift` it; and what part that is of all
    `decorrelation`, the noise included.
    """

    corners: int
    shadow: bool
    overlaid: bool
    shift: float
    decorrelation: float


def survey(scene: Scene, sonar: Sonar, places: Iterable[float], snr: float | SnrProfile | None) -> Survey:
    """Look at the sections at places along track [m].

    Nothing is hidden where the elevation angle rises from corner to corner, and nothing is heard at once with another
    part where the path rises along every segment from its start on. On a slope of the angle `s` at the depression `phi`
    the band shifts by `df = fc D cos(phi) tan(phi + s) / (2 r)`; noise costs `1 / (1 + snr)` of coherence, the shift
    `df / B`.
    """
    ranges = np.linspace(*scene.ground_range, SURVEYED)
    if scene.sediment is not None:
        noise = 1 - noise_coherence(predicted_snr(sonar, scene.sediment, ranges, model=scene.scattering))
    elif snr is None:
        noise = np.zeros(SURVEYED)
    else:
        noise = 1 - noise_coherence(snr.at(ranges) if isinstance(snr, SnrProfile) else np.full(SURVEYED, float(snr)))
    found = [
        (len(profile.height), *_surveyed(profile.ground_range, profile.height, ranges, noise, *_numbers(sonar)))
        for profile in map(scene.profile, places)
    ]
    return Survey(*(max(part) for part in zip(*found, strict=True)))


def _numbers(sonar: Sonar) -> tuple[float, float, float]:
    """Altitudes of both receivers, and `fc D / (2 B)` [m]."""
    lower = float(sonar.altitude)
    return lower, lower + sonar.baseline, sonar.centre_frequency * sonar.baseline / (2 * sonar.bandwidth)


@compiled
def _surveyed(
    ground_range: Real, height: Real, ranges: Real, noise: Real, lower: float, upper: float, scale: float
) -> tuple[bool, bool, float, float]:
    """What `Survey` tells of one section but for the number of its corners."""
    shadow = overlaid = False
    shift = part = 0.0
    for segment in range(len(height) - 1):
        near, along = ground_range[segment], ground_range[segment + 1] - ground_range[segment]
        low, up = height[segment], height[segment + 1] - height[segment]
        if along == 0 and up == 0:
            continue
        for altitude in (lower, upper):
            shadow = shadow or (low + up - altitude) / (near + along) <= (low - altitude) / near
        overlaid = overlaid or along * near <= up * (upper - low)
        # At its start, where a long one has no other, and at some ranges within.
        first, last = np.searchsorted(ranges, near), np.searchsorted(ranges, ground_range[segment + 1])
        last = len(ranges) if segment == len(height) - 2 else last
        for place in range(first - 1, last):
            y = near if place < first else ranges[place]
            depth = upper - low
            angle = min(math.atan2(depth, y) + math.atan2(up, along), math.radians(89.0))
            share = scale * y * abs(math.tan(angle)) / (y**2 + depth**2)
            shift = max(shift, share)
            part = max(part, share / (share + np.interp(y, ranges, noise)))
    return shadow, overlaid, shift, part
