"""Pixels of an image on the ground."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sim import EchoPair, Geometry, checks
from sim.band import Real
from sim.geometry import ground_length


@dataclass(frozen=True, eq=False)
class Pixels:
    """Sizes and looks of the pixels of an image.

    Parameters
    ----------
    along_track
        Spacing of the rows, `dx` [m].
    range
        Spacing of the samples on the ground, `dy` [m]; a number, or one for each time.
    looks
        Independent looks in a pixel, `alpha = (dx / dx_3dB) (dy / dy_3dB)`, above 0 and at most 1 (paper B, equation 1,
        whose print inverts a factor).

    Raises
    ------
    ValueError
        For a value outside these limits.
    """

    along_track: float
    range: float | Real
    looks: float

    def __post_init__(self) -> None:
        checks.positive("along_track", self.along_track, "m")
        checks.positive("range", float(np.min(self.range)), "m")
        checks.positive("looks", self.looks)
        checks.within("looks", self.looks, 0.0, 1.0)

    @classmethod
    def of(cls, pair: EchoPair, geometry: Geometry) -> "Pixels":
        """The pixels of a pair on the reference plane.

        Where the pair does not say how far apart its rows are, that is one along-track resolution. A sample covers the
        ground that lies within its length `c / (2 fs)` of slant range; before the first echo of the plane it has that
        length.
        """
        sonar = geometry.sonar
        extent = sonar.sound_speed / (2 * pair.sample_rate)
        ground = ground_length(sonar.altitude, geometry.slant_range(pair.grid.times), extent)
        along_track = sonar.aperture.resolution if pair.row_spacing is None else pair.row_spacing
        looks = pair.row_looks * pair.bandwidth / pair.sample_rate
        return cls(along_track, np.maximum(ground, extent), looks)

    @property
    def elongation(self) -> float | Real:
        """Size along track over that in range, `dx / dy`: samples in a square that is one row wide."""
        return self.along_track / self.range

    def looks_in(self, side: ArrayLike) -> Real:
        """Looks in a square of so many rows, `N = alpha (dx / dy) M^2`; `alpha M^2` where pixels are square."""
        looks: Real = self.looks * self.elongation * np.square(np.asarray(side, dtype=float))
        return looks


PAPER_B = Pixels(along_track=0.02, range=0.02, looks=0.4)
"""Those of the images of paper B."""


def nearest_odd(size: ArrayLike) -> NDArray[np.int64]:
    """Nearest odd whole number, at least 1; of two as near, the larger."""
    odd: NDArray[np.int64] = 2 * np.floor(np.maximum(np.asarray(size, dtype=float), 1.0) / 2).astype(np.int64) + 1
    return odd
