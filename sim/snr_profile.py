"""A signal-to-noise ratio that is given over range, where no sonar equation says it."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from sim import checks
from sim.band import Real


@dataclass(frozen=True)
class SnrProfile:
    """Signal-to-noise ratio of the flat floor over ground range, straight in dB between points and level beyond.

    Parameters
    ----------
    ground_range
        Of the points, rising [m].
    snr
        At the points, in each receiver [dB].

    Raises
    ------
    ValueError
        For numbers that are not finite, ranges that do not rise, and lists of different lengths.
    """

    ground_range: tuple[float, ...]
    snr: tuple[float, ...]

    def __post_init__(self) -> None:
        for name, unit in (("ground_range", "m"), ("snr", "dB")):
            numbers = tuple(checks.finite(name, number, unit) for number in getattr(self, name))
            object.__setattr__(self, name, numbers)
        if len(self.ground_range) != len(self.snr) or not self.snr:
            raise ValueError(
                f"a profile has {len(self.ground_range)} ground ranges and {len(self.snr)} ratios; "
                "it must have one or more, and as many of either"
            )
        if any(np.diff(self.ground_range) <= 0):
            raise ValueError(f"ground_range is {self.ground_range} m; it must rise from point to point")

    def at(self, ground_range: ArrayLike) -> Real:
        """The ratio at ground ranges [dB], of their shape."""
        ratio: Real = np.interp(np.asarray(ground_range, dtype=float), self.ground_range, self.snr)
        return ratio
