"""How strong the scatterers of a scene are: alike everywhere, or as sediment and sonar equation say."""

import math
from functools import lru_cache
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from sim.band import Real
from sim.catalogue import find
from sim.compiled import compiled
from sim.geometry import travel_times
from sim.profile import Profile, SeabedPoints
from sim.scattering import Model, scattering_strength
from sim.scene import Scene
from sim.sediment import Sediment
from sim.sonar import Sonar
from sim.sonar_equation import echo_level, propagation

Level = Literal["even", "flat", "local"]
"""Which level echoes have: the same everywhere, that of the flat floor, or that of their own piece of seabed."""

ANGLES = np.linspace(0.0, 90.0, 9001)
"""Grazing angles and depressions at which strengths and beams are tabulated [degrees]."""

SINES = np.sin(np.radians(ANGLES))
"""Their sines, between which tables are read: a piece of seabed is at once known by that of its angle."""


def scatterer_power(
    scene: Scene, sonar: Sonar, profile: Profile, points: SeabedPoints, length: Real, level: Level
) -> Real:
    """Mean power of scatterers, shape (scatterer,).

    Relative to the noise of a receiver where the scene has a sediment (`level_of_sediment`), and so that the flat floor
    has unit power where it has none (`level_of_floor`).

    Parameters
    ----------
    scene, sonar
        What is seen, and by what.
    profile, points, length
        A section of the scene, places on it, and the length that each stands for [m].
    level
        "even" for a scene without sediment; for one with, "local" or, without regard to relief, "flat".
    """
    if level == "even":
        return level_of_floor(sonar, travel_times(sonar, *profile.position(points))[0], length)
    if level == "flat":
        ground_range, height = profile.position(points)
        slant = np.hypot(ground_range, sonar.altitude - height)
        flat = Profile(np.array(scene.ground_range), np.zeros(2), profile.along_track)
        near, far = scene.ground_range
        share = (np.sqrt(np.maximum(slant**2 - sonar.altitude**2, near**2)) - near) / (far - near)
        points, profile = SeabedPoints(np.zeros(len(share), dtype=np.int64), share), flat
    return level_of_sediment(scene, sonar, profile, points, length)


def level_of_floor(sonar: Sonar, points_time: Real, length: Real) -> Real:
    """Mean power of scatterers so that the flat floor has unit mean power at every range.

    A floor of ground range `y = sqrt(r^2 - H^2)` sends the echoes of a length `dy` within `dt = 2 (y / r) dy / c`;
    a series of bandwidth `B` has unit power where the scatterers bring `B` a second. So `E|a|^2 = 2 B (y / r) dl / c`
    for a length `dl` of seabed: the same strength per length whatever its slope.

    Parameters
    ----------
    sonar
        `B`, `H` and `c`.
    points_time
        Time of each scatterer at the primary [s].
    length
        Length of seabed that it stands for, `dl` [m].
    """
    slant = points_time * sonar.sound_speed / 2
    cosine = np.sqrt(np.maximum(1 - (sonar.altitude / slant) ** 2, 0.0))
    power: Real = 2 * sonar.bandwidth * cosine * length / sonar.sound_speed
    return power


def level_of_sediment(scene: Scene, sonar: Sonar, profile: Profile, points: SeabedPoints, length: Real) -> Real:
    """Mean power of scatterers over that of the noise, before `range_gain`.

    The sonar equation of the area `dx dl` that each stands for, at its local grazing angle: `sin th = n . e` for the
    normal `n` of the seabed and the unit vector `e` back to the transmitter. A series of bandwidth `B` has unit power
    where the scatterers bring `B` a second, and within `1 / B` the floor brings `dl = c / (2 B cos th)`, the
    resolution cell of the sonar equation. Strengths and beams are read from
    tables in steps of .01 degree.

    Parameters
    ----------
    scene
        With a sediment.
    sonar
        Geometry and sonar equation.
    profile, points, length
        Places on a section of the seabed, and the length that each stands for, `dl` [m].
    """
    assert isinstance(scene.sediment, Sediment)
    patches = [patch for patch in scene.patches if patch.is_at(profile.along_track)]
    sediments = [scene.sediment, *(find(patch.sediment) for patch in patches)]
    strengths = [_strengths(one, sonar.centre_frequency, sonar.sound_speed, scene.scattering) for one in sediments]
    ends = np.array([[-np.inf, np.inf], *(patch.ground_range for patch in patches)])
    return _power_of(
        profile.ground_range, profile.height, *points, length, float(sonar.altitude), ends, np.array(strengths),
        _beams(sonar) * sonar.aperture.resolution,
    )  # fmt: skip


@compiled
def _power_of(
    corner_range: Real,
    corner_height: Real,
    segments: NDArray[np.int64],
    shares: Real,
    lengths: Real,
    altitude: float,
    ends: Real,
    strengths: Real,
    beams: Real,
) -> Real:
    """Strength, from the table of the last sediment whose ends hold a point, times beam and length."""
    power = np.empty(len(segments))
    angle = depression = 0
    last, long = -1, 0.0
    for point in range(len(segments)):
        segment, share = segments[point], shares[point]
        near, low = corner_range[segment], corner_height[segment]
        along, up = corner_range[segment + 1] - near, corner_height[segment + 1] - low
        if segment != last:
            last, long = segment, math.sqrt(along**2 + up**2)
        ground_range, depth = near + share * along, altitude - (low + share * up)
        slant = math.sqrt(ground_range**2 + depth**2)
        sine = (along * depth + up * ground_range) / (long * slant)
        sediment = 0
        for patch in range(1, len(ends)):
            if ends[patch, 0] <= ground_range < ends[patch, 1]:
                sediment = patch
        # Neighbours have much the same angles, so that the search starts where the last one ended.
        angle = _place(sine, angle)
        depression = _place(depth / slant, depression)
        strength = _read(strengths[sediment], angle, sine)
        power[point] = strength * _read(beams, depression, depth / slant) * lengths[point]
    return power


@compiled
def _place(sine: float, last: int) -> int:
    """The number of the last of `SINES` that is not above a sine, but for the last of all; `last` is near it."""
    for place in (last, max(last - 1, 0), min(last + 1, len(SINES) - 2)):
        if SINES[place] <= sine < SINES[place + 1]:
            return place
    return min(max(int(np.searchsorted(SINES, sine, "right")) - 1, 0), len(SINES) - 2)


@compiled
def _read(table: Real, place: int, sine: float) -> float:
    """A table at a sine between two of `SINES`, and beyond the ends what is there."""
    low, high = SINES[place], SINES[place + 1]
    share = min(max((sine - low) / (high - low), 0.0), 1.0)
    value: float = table[place] + share * (table[place + 1] - table[place])
    return value


@lru_cache(maxsize=64)
def _strengths(sediment: Sediment, frequency: float, sound_speed: float, model: Model) -> Real:
    table: Real = 10 ** (scattering_strength(sediment, ANGLES, frequency, model=model, sound_speed=sound_speed) / 10)
    return table


@lru_cache(maxsize=16)
def _beams(sonar: Sonar) -> Real:
    """What remains of the sonar equation for a piece of 1 m^2 and 0 dB, at depressions `ANGLES`."""
    one = np.ones(len(ANGLES))
    terms = echo_level(sonar, "sand", one, ANGLES, 90 * one[:1], one, "small-slope")
    table: Real = 10 ** ((terms.snr - terms.range_gain - terms.scattering_strength) / 10)
    return table


def range_gain(sonar: Sonar, time: Real) -> Real:
    """Amplitude that echoes keep on their way, against time at the primary [s].

    Spreading, absorption and the gain of the aperture, which depend on range alone. They are laid on the series, not on
    the scatterers: the flat band is that of an endless pulse, whose side lobes would carry near echoes, 60 dB stronger,
    into the far ones. The echo of a pulse of finite length does not reach that far.
    """
    slant = np.maximum(sonar.sound_speed * time / 2, sonar.range_resolution)
    spreading, absorption, aperture_gain = propagation(sonar, slant)
    gain: Real = 10 ** ((aperture_gain - spreading - absorption) / 20)
    return gain
