"""What the sections of a scene hold that its simulation must heed."""

from collections.abc import Iterable
from typing import NamedTuple

import numpy as np

from sim.band import Real
from sim.coherence import noise_coherence
from sim.profile import Profile
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
    found = [_surveyed(scene.profile(place), sonar, ranges, noise) for place in places]
    return Survey(*(max(part) for part in zip(*found, strict=True)))


def _surveyed(profile: Profile, sonar: Sonar, ranges: Real, noise: Real) -> Survey:
    upper = sonar.altitude + sonar.baseline
    tangents = ((profile.height - altitude) / profile.ground_range for altitude in (sonar.altitude, upper))
    real = profile.lengths > 0
    shadow = any(bool((np.diff(tangent)[real] <= 0).any()) for tangent in tangents)
    overlaid = bool(
        (profile.along * profile.ground_range[:-1] <= profile.up * (upper - profile.height[:-1]))[real].any()
    )
    # At the start of every segment, where a long one has no other, and at some ranges between.
    within = np.clip(np.searchsorted(profile.ground_range, ranges, "right") - 1, 0, len(real) - 1)
    segment = np.concatenate([np.flatnonzero(real), within])
    y = np.concatenate([profile.ground_range[:-1][real], ranges])
    depth = upper - profile.height[segment]
    angle = np.minimum(np.arctan2(depth, y) + np.arctan2(profile.up, profile.along)[segment], np.radians(89.0))
    share = sonar.centre_frequency * sonar.baseline * y * np.abs(np.tan(angle)) / (2 * (y**2 + depth**2))
    shift = share / sonar.bandwidth
    part = shift / (shift + np.interp(y, ranges, noise))
    return Survey(len(profile.height), shadow, overlaid, float(shift.max()), float(part.max()))
