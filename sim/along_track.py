"""Rows closer than the along-track resolution: what the wavenumber support of the aperture makes of them."""

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sim import checks
from sim.band import Real
from sim.compiled import compiled

REACH = 12
"""Resolutions to either side that a row gathers from."""

TAPER = 5.0
"""Of the Kaiser window over them."""

STRETCH = 512
"""Columns filtered together."""


@dataclass(frozen=True)
class AlongTrack:
    """Rows of an image along track.

    An aperture passes the wavenumbers of a band `1 / resolution` wide, so that rows closer than the resolution `dx` are
    alike: each is the sum of independent rows weighted by `sinc((m - n) spacing / dx)`, here under a Kaiser window of
    `REACH` resolutions, whose soft band edges leave the number of independent rows `spacing / dx` within 2 %.

    Parameters
    ----------
    spacing
        Distance of rows [m].
    resolution
        `dx` [m]; from the spacing on down rows are independent.

    Raises
    ------
    ValueError
        For a value outside these limits.
    """

    spacing: float
    resolution: float

    def __post_init__(self) -> None:
        checks.positive("row_spacing", self.spacing, "m")
        checks.positive("resolution", self.resolution, "m")

    @property
    def looks(self) -> float:
        """Independent looks in a row among many, `spacing / dx` and at most 1."""
        return min(self.spacing / self.resolution, 1.0)

    @property
    def halo(self) -> int:
        """Rows beyond either end that are needed."""
        return 0 if self.looks == 1 else int(np.ceil(REACH / self.looks))

    @cached_property
    def weights(self) -> Real:
        """Weights of the rows from `-halo` to `halo`; their squares add up to 1."""
        offsets = np.arange(-self.halo, self.halo + 1)
        weights = np.sinc(offsets * self.looks) * np.kaiser(len(offsets), TAPER)
        normed: Real = weights / np.sqrt((weights**2).sum())
        return normed

    def gather(self, rows: NDArray[Any]) -> NDArray[Any]:
        """Filtered rows from independent ones, complex and contiguous, of shape (rows + 2 halo, samples).

        They take the place of the first rows, so that no memory is needed for them.
        """
        if self.halo == 0:
            return rows
        # The complex series as twice as many real columns.
        columns = rows.view(rows.real.dtype)
        _gather(columns, self.weights.astype(columns.dtype))
        count = len(rows) - 2 * self.halo
        # The memory of the halo stays in use beside as many rows, not beside a few.
        return rows[:count] if count > self.halo else rows[:count].copy()


@compiled
def _gather(rows: Real, weights: Real) -> None:
    """Put weighted sums of rows in place of the first, in the same order always, in stretches that a cache holds."""
    taps, count = len(weights), len(rows) - len(weights) + 1
    sums = np.empty(STRETCH, rows.dtype)
    for start in range(0, rows.shape[1], STRETCH):
        stop = min(start + STRETCH, rows.shape[1])
        total = sums[: stop - start]
        for row in range(count):
            total[:] = 0.0
            # By fours the sum is written to memory a quarter as often.
            for tap in range(0, taps - 3, 4):
                a, b, c, d = weights[tap], weights[tap + 1], weights[tap + 2], weights[tap + 3]
                first, second = rows[row + tap, start:stop], rows[row + tap + 1, start:stop]
                third, fourth = rows[row + tap + 2, start:stop], rows[row + tap + 3, start:stop]
                for column in range(len(total)):
                    total[column] = (
                        total[column] + a * first[column] + b * second[column] + c * third[column] + d * fourth[column]
                    )
            for tap in range(taps - taps % 4, taps):
                weight, one = weights[tap], rows[row + tap, start:stop]
                for column in range(len(total)):
                    total[column] += weight * one[column]
            rows[row, start:stop] = total
