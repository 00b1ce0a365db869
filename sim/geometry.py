"""Where things are and when they are heard: slant range, delay, height."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from sim.band import Real
from sim.compiled import compiled
from sim.sonar import Sonar


def travel_times(sonar: Sonar, ground_range: ArrayLike, height: ArrayLike) -> tuple[Real, Real]:
    """Times of the echo of a point at the primary and at the secondary receiver.

    With `r = sqrt(y^2 + (H - z)^2)` from the transmitter and `r_s = sqrt(y^2 + (H + D - z)^2)` to the
    secondary receiver, `t_p = 2 r / c` and `t_s = (r + r_s) / c`.

    Parameters
    ----------
    sonar
        Altitude `H`, baseline `D`, sound speed `c`.
    ground_range, height
        The point, `y` and `z` [m]; they broadcast.

    Returns
    -------
    tuple of arrays
        `t_p` and `t_s` [s].
    """
    places = np.broadcast_arrays(np.asarray(ground_range, dtype=float), np.asarray(height, dtype=float))
    shape = places[0].shape
    times = _travel_times(
        places[0].ravel(), places[1].ravel(), float(sonar.altitude), float(sonar.baseline), float(sonar.sound_speed)
    )
    return times[0].reshape(shape), times[1].reshape(shape)


def plane_delay(sonar: Sonar, time: ArrayLike) -> Real:
    """Delay of the secondary behind the primary for the reference plane.

    `tau = (r_s - r) / c` with `r = c t / 2` and `r_s^2 = r^2 + D^2 + 2 D H`: exact, about `D H / (c r)`.

    Parameters
    ----------
    sonar
        Altitude `H`, baseline `D`, sound speed `c`.
    time
        Time of the echo at the primary, `t` [s].

    Returns
    -------
    array
        Delay [s], of the shape of `time`.
    """
    slant = np.abs(np.asarray(time, dtype=float)) * sonar.sound_speed / 2
    excess = sonar.baseline * (sonar.baseline + 2 * sonar.altitude)
    delay: Real = excess / (np.sqrt(slant**2 + excess) + slant) / sonar.sound_speed
    return delay


def ground_length(altitude: float, slant_range: ArrayLike, extent: float) -> Real:
    """Length of the piece of the plane whose slant ranges lie within `extent / 2` of a range.

    `sqrt((r + e/2)^2 - H^2) - sqrt((r - e/2)^2 - H^2)`, about `e / cos th` but for the nadir, where it stays finite.

    Parameters
    ----------
    altitude
        Height above the plane, `H` [m].
    slant_range
        `r` [m], any shape.
    extent
        Of slant range, `e` [m].

    Returns
    -------
    array
        Length [m], of the shape of `slant_range`; 0 where no slant range of the piece reaches the plane.
    """
    slant, half = np.asarray(slant_range, dtype=float), extent / 2
    near = np.sqrt(np.maximum(np.maximum(slant - half, 0.0) ** 2 - altitude**2, 0.0))
    far = np.sqrt(np.maximum((slant + half) ** 2 - altitude**2, 0.0))
    # The difference of two roots, without loss of digits at long range.
    length: Real = np.where(near > 0, 4 * slant * half / np.where(near > 0, far + near, 1.0), far)
    return length


@dataclass(frozen=True)
class Geometry:
    """Places a pair that was registered to the reference plane of a sonar.

    Parameters
    ----------
    sonar
        The sonar that recorded it.
    start
        Time of the first sample of the primary after the transmission [s].
    """

    sonar: Sonar
    start: float

    def slant_range(self, time: ArrayLike) -> Real:
        """Distance from the primary of what it hears at a time [s]: `r = c t / 2` [m]."""
        slant: Real = self.sonar.sound_speed / 2 * np.asarray(time, dtype=float)
        return slant

    def ground_range(self, time: ArrayLike, height: ArrayLike = 0.0) -> Real:
        """Horizontal distance of what the primary hears at a time from a height.

        `y = sqrt(r^2 - (H - z)^2)` with `r = c t / 2`.

        Parameters
        ----------
        time
            Time at the primary, `t` [s].
        height
            Height above the reference plane, `z` [m]; they broadcast.

        Returns
        -------
        array
            Ground range, `y` [m]; NaN where the echo is too early to come from that height.
        """
        slant, depression = self.slant_range(time), self.sonar.altitude - np.asarray(height, dtype=float)
        square = (slant - depression) * (slant + depression)
        ground: Real = np.sqrt(np.where(square >= 0, square, np.nan))
        return ground

    def registered_delay(self, time: ArrayLike, time_secondary: ArrayLike) -> Real:
        """Delay that registration leaves of echoes at two times.

        The registered secondary at time `u` is the recorded one at `u + plane_delay(u)`. An echo at `t_p` and `t_s` is
        left at the delay `u - t_p`, where `u + plane_delay(u) = t_s`; that is `u = t_s - D (D + 2 H) / (c^2 t_s)`.

        Parameters
        ----------
        time, time_secondary
            `t_p` and `t_s` [s]; they broadcast.

        Returns
        -------
        array
            Delay [s].
        """
        time, time_secondary = np.asarray(time, dtype=float), np.asarray(time_secondary, dtype=float)
        excess = self.sonar.baseline * (self.sonar.baseline + 2 * self.sonar.altitude)
        left: Real = time_secondary - time - excess / (self.sonar.sound_speed**2 * time_secondary)
        return left

    def left_delay(self, ground_range: Real, height: Real) -> Real:
        """Delay that registration leaves of points [m], shape (point,): `registered_delay` of their `travel_times`."""
        sonar = self.sonar
        return _left_delay(ground_range, height, float(sonar.altitude), float(sonar.baseline), float(sonar.sound_speed))

    def height(self, time: ArrayLike, delay: ArrayLike) -> Real:
        """Height of the seabed from a delay as registration left it.

        With the full delay `tau = delay + plane_delay(t + delay)` and `r = c t / 2`,
        `z = H - (2 r c tau + (c tau)^2 - D^2) / (2 D)`; to first order `dz = -(r c / D) dtau`: what stands
        higher is heard sooner by the upper receiver.

        Parameters
        ----------
        time
            Time at the primary, `t` [s].
        delay
            Delay in the registered pair [s]; they broadcast.

        Returns
        -------
        array
            Height above the reference plane, `z` [m].
        """
        sonar = self.sonar
        time, delay = np.asarray(time, dtype=float), np.asarray(delay, dtype=float)
        path = sonar.sound_speed * (delay + plane_delay(sonar, time + delay))
        height: Real = sonar.altitude - (path * (sonar.sound_speed * time + path) - sonar.baseline**2) / (
            2 * sonar.baseline
        )
        return height


@compiled
def _travel_times(
    ground_range: Real, height: Real, altitude: float, baseline: float, sound_speed: float
) -> tuple[Real, Real]:
    time, time_secondary = np.empty(len(ground_range)), np.empty(len(ground_range))
    for point in range(len(time)):
        square, depression = ground_range[point] ** 2, altitude - height[point]
        # Four times as fast as hypot, which is for numbers whose squares are out of range.
        slant = math.sqrt(square + depression**2)
        slant_secondary = math.sqrt(square + (depression + baseline) ** 2)
        time[point] = 2 * slant / sound_speed
        time_secondary[point] = (slant + slant_secondary) / sound_speed
    return time, time_secondary


@compiled
def _left_delay(ground_range: Real, height: Real, altitude: float, baseline: float, sound_speed: float) -> Real:
    left = np.empty(len(ground_range))
    excess = baseline * (baseline + 2 * altitude)
    for point in range(len(left)):
        depression = altitude - height[point]
        slant = math.sqrt(ground_range[point] ** 2 + depression**2)
        slant_secondary = math.sqrt(ground_range[point] ** 2 + (depression + baseline) ** 2)
        time_secondary = (slant + slant_secondary) / sound_speed
        left[point] = time_secondary - 2 * slant / sound_speed - excess / (sound_speed**2 * time_secondary)
    return left
