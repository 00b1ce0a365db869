"""Which part of a scene is heard when."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sim.band import Real
from sim.compiled import compiled
from sim.profile import Profile, SeabedPoints
from sim.sonar import Sonar


class Heard(NamedTuple):
    """Parts of the seabed that a receiver hears; one entry for each part and time.

    `points` where they lie, `sample` which of the times, `stretch` the number of the stretch of seabed, along which
    arrival times only rise or only fall, that each belongs to, from the near end on.
    """

    points: SeabedPoints
    sample: NDArray[np.int64]
    stretch: NDArray[np.int64]

    def chosen(self, which: NDArray[np.bool_]) -> "Heard":
        """Those of them for which `which` holds."""
        return Heard(self.points.chosen(which), self.sample[which], self.stretch[which])


def heard_at(profile: Profile, sonar: Sonar, times: Real, receiver_altitude: float, *, shadow: bool = True) -> Heard:
    """All points of the seabed whose echo reaches a receiver at given times, and which it and the transmitter see.

    The path `L(u) = |x - T| + |x - R|` to a point `x = x0 + u d` of a segment is convex: it falls up to the point where
    a ray that is reflected at the segment's line would pass from `T` to `R`, at `(u_T h_R + u_R h_T) / (h_T + h_R)` of
    the feet `u` and distances `h` of `T` and `R`, and rises beyond. On either piece
    `(L^2 + |x - T|^2 - |x - R|^2)^2 = 4 L^2 |x - T|^2` is quadratic in `u`, since the difference of the squares is
    linear. What is seen is as in `sim.visibility.sees`.

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
    segment, share, sample, stretch = _march(
        profile.ground_range,
        profile.height,
        sonar.sound_speed * times,
        float(sonar.altitude),
        float(receiver_altitude),
        shadow,
    )
    return Heard(SeabedPoints(segment, share), sample, stretch)


@compiled
def _march(
    ground_range: Real, height: Real, path: Real, transmitter: float, receiver: float, shadow: bool
) -> tuple[NDArray[np.int64], Real, NDArray[np.int64], NDArray[np.int64]]:
    """Walk along the segments from the near end on; segments, shares, samples and stretches of what is heard."""
    pieces = _pieces(ground_range, height, path, transmitter, receiver)
    most = int(np.sum(pieces[:, 1] - pieces[:, 0]))
    segments, samples, stretches = np.empty(most, np.int64), np.empty(most, np.int64), np.empty(most, np.int64)
    shares = np.empty(most)
    count, stretch, before = 0, 0, -1
    highest = np.full(2, -np.inf)
    for segment in range(len(ground_range) - 1):
        near, along = ground_range[segment], ground_range[segment + 1] - ground_range[segment]
        low, up = height[segment], height[segment + 1] - height[segment]
        lit = True
        for receives, altitude in enumerate((transmitter, receiver)):
            tangent = (low - altitude) / near
            highest[receives] = max(highest[receives], tangent)
            lit = lit and (low + up - altitude) / (near + along) > tangent
        for rising in range(2):
            first, last, exists = pieces[2 * segment + rising]
            if not exists:
                continue
            if before >= 0 and rising != before:
                stretch += 1
            before = rising
            if shadow and not lit:
                continue
            for sample in range(first, last):
                share = _share(near, low, along, up, path[sample], transmitter, receiver, 2 * rising - 1)
                y, z = near + share * along, low + share * up
                seen = True
                if shadow:
                    for receives, altitude in enumerate((transmitter, receiver)):
                        floor = highest[receives] - 1e-12 * abs(highest[receives])
                        seen = seen and (z - altitude) / y >= floor
                if seen:
                    segments[count], shares[count], samples[count], stretches[count] = segment, share, sample, stretch
                    count += 1
    return segments[:count], shares[:count], samples[:count], stretches[:count]


@compiled
def _pieces(ground_range: Real, height: Real, path: Real, transmitter: float, receiver: float) -> NDArray[np.int64]:
    """First and last sample of the falling and the rising piece of every segment, and whether there is such a piece."""
    pieces = np.zeros((2 * len(ground_range) - 2, 3), np.int64)
    for segment in range(len(ground_range) - 1):
        near, along = ground_range[segment], ground_range[segment + 1] - ground_range[segment]
        low, up = height[segment], height[segment + 1] - height[segment]
        if along == 0 and up == 0:
            continue
        turn = _turning_point(near, low, along, up, transmitter, receiver)
        at_turn = _path(near + turn * along, low + turn * up, transmitter, receiver)
        if turn > 0:
            # A path that ends on a corner belongs to one piece only.
            top = _path(near, low, transmitter, receiver)
            pieces[2 * segment] = (
                np.searchsorted(path, at_turn, "right"),
                max(np.searchsorted(path, top, "right"), np.searchsorted(path, at_turn, "right")),
                1,
            )
        if turn < 1:
            top = _path(near + along, low + up, transmitter, receiver)
            pieces[2 * segment + 1] = (
                np.searchsorted(path, at_turn, "left"),
                max(np.searchsorted(path, top, "left"), np.searchsorted(path, at_turn, "left")),
                1,
            )
    return pieces


@compiled
def _path(y: float, z: float, transmitter: float, receiver: float) -> float:
    return math.hypot(y, z - transmitter) + math.hypot(y, z - receiver)


@compiled
def _turning_point(near: float, low: float, along: float, up: float, transmitter: float, receiver: float) -> float:
    square = along**2 + up**2
    foot_t = -(near * along + (low - transmitter) * up) / square
    foot_r = -(near * along + (low - receiver) * up) / square
    distance_t = abs(near * up - (low - transmitter) * along)
    distance_r = abs(near * up - (low - receiver) * along)
    both = distance_t + distance_r
    turn = (foot_t * distance_r + foot_r * distance_t) / both if both > 0 else (foot_t + foot_r) / 2
    return min(max(turn, 0.0), 1.0)


@compiled
def _share(
    near: float, low: float, along: float, up: float, path: float, transmitter: float, receiver: float, sign: int
) -> float:
    """Where along a segment the path is as long as this, on its falling (-1) or its rising piece (1)."""
    below, rise = low - transmitter, receiver - transmitter
    # |x - T|^2 - |x - R|^2 = constant + slope u
    slope, known = 2 * rise * up, path**2 + 2 * rise * below - rise**2
    a = 4 * path**2 * (along**2 + up**2) - slope**2
    b = 4 * path**2 * (near * along + below * up) - known * slope
    c = 4 * path**2 * (near**2 + below**2) - known**2
    share = (-b + sign * math.sqrt(max(b**2 - a * c, 0.0))) / a
    return min(max(share, 0.0), 1.0)
