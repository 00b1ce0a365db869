"""A search range in height."""

from dataclasses import dataclass

import numpy as np

from sim import EchoPair, checks


@dataclass(frozen=True)
class Height:
    """How far from the reference plane to look for the seabed, for every method that takes a `search`.

    An echo at `t_p` from a height `z` arrives at the secondary at `t_s = t_p + (sqrt(r^2 + D^2 + 2 D (H - z)) - r) / c`
    with `r = c t_p / 2`; registration leaves of it a delay of about `-z D / (r c)`. The search range is the largest
    that heights of `-metres` to `metres` leave anywhere in the record, at slant ranges that a seabed of at most that
    height can have, `r >= H - metres`.

    Parameters
    ----------
    metres
        Largest height above or below the plane [m].

    Raises
    ------
    ValueError
        For a height of 0 or less.
    """

    metres: float

    def __post_init__(self) -> None:
        checks.positive("height of the search", self.metres, "m")

    def __str__(self) -> str:
        return f"{self.metres:g} m"

    def delay(self, pair: EchoPair) -> float:
        """The search range in delay [s].

        Raises
        ------
        ValueError
            For a pair without geometry, a sonar that is not above that height, and a record that ends before it.
        """
        if pair.geometry is None:
            raise ValueError(f"search is {self} of height; the pair must have a geometry, or search be a delay in s")
        geometry, sonar = pair.geometry, pair.geometry.sonar
        lowest = sonar.altitude - self.metres
        if lowest <= 0:
            raise ValueError(f"search is {self} of height; it must be below the altitude, {sonar.altitude:g} m")
        times = pair.grid.times
        times = times[times * sonar.sound_speed / 2 >= lowest]
        if not times.size:
            raise ValueError(f"search is {self} of height; the record must reach a slant range of {lowest:g} m")
        slant = times * sonar.sound_speed / 2
        heights = np.array([[-self.metres], [self.metres]])
        slant_secondary = np.sqrt(slant**2 + sonar.baseline**2 + 2 * sonar.baseline * (sonar.altitude - heights))
        left = geometry.registered_delay(times, times + (slant_secondary - slant) / sonar.sound_speed)
        return float(np.abs(left).max())
