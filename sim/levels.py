"""How strong the scatterers of a scene are: alike everywhere, or as sediment and sonar equation say."""

import numpy as np

from sim.band import Real
from sim.geometry import travel_times
from sim.scene import Scene
from sim.sonar import Sonar
from sim.sonar_equation import echo_level, propagation
from sim.visibility import SeabedPoints, position


def scatterer_power(scene: Scene, sonar: Sonar, points: SeabedPoints, length: Real) -> Real:
    """Mean power of scatterers, shape (scatterer,).

    Relative to the noise of a receiver where the scene has a sediment (`level_of_sediment`), and so that the flat floor
    has unit power where it has none (`level_of_floor`).

    Parameters
    ----------
    scene, sonar
        What is seen, and by what.
    points, length
        Places on the seabed, and the length that each stands for [m].
    """
    if scene.sediment is None:
        return level_of_floor(sonar, travel_times(sonar, *position(scene, points))[0], length)
    return level_of_sediment(scene, sonar, points, length)


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


def level_of_sediment(scene: Scene, sonar: Sonar, points: SeabedPoints, length: Real) -> Real:
    """Mean power of scatterers over that of the noise, before `range_gain`.

    The sonar equation of the area `dx dl` that each stands for, at its local grazing angle: `sin th = n . e` for the
    normal `n` of the seabed and the unit vector `e` back to the transmitter. A series of bandwidth `B` has unit power
    where the scatterers bring `B` a second, and within `1 / B` the floor brings `dl = c / (2 B cos th)`, the
    resolution cell of the sonar equation.

    Parameters
    ----------
    scene
        With a sediment.
    sonar
        Geometry and sonar equation.
    points, length
        Places on the seabed, and the length that each stands for, `dl` [m].
    """
    assert scene.sediment is not None
    ground_range, height = position(scene, points)
    depth = sonar.altitude - height
    slant = np.hypot(ground_range, depth)
    along, up = np.diff(scene.profile, axis=0)[points.segment].T
    sine = (along * depth + up * ground_range) / (np.hypot(along, up) * slant)
    terms = echo_level(
        sonar,
        scene.sediment,
        slant_range=slant,
        depression=np.degrees(np.arctan2(depth, ground_range)),
        grazing_angle=np.degrees(np.arcsin(np.clip(sine, -1.0, 1.0))),
        area=sonar.aperture.resolution * length,
        model=scene.scattering,
    )
    power: Real = 10 ** ((terms.snr - terms.range_gain) / 10)
    return power


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
