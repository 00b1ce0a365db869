"""Rows closer than the along-track resolution: what the wavenumber support of the aperture makes of them."""

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sim import checks
from sim.band import Real

REACH = 12
"""Resolutions to either side that a row gathers from."""

TAPER = 5.0
"""Of the Kaiser window over them."""

BLOCK = 32
"""Rows filtered in one product of matrices."""


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
        `dx` [m], not below half the spacing; from the spacing on down rows are independent.
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
        """Filtered rows from independent ones, shape (rows + 2 halo, samples), complex and contiguous."""
        if self.halo == 0:
            return rows
        count = len(rows) - 2 * self.halo
        gathered = np.empty((count, rows.shape[1]), dtype=rows.dtype)
        # Real matrices: the complex series as twice as many real columns.
        before, after = (array.view(array.real.dtype) for array in (rows, gathered))
        width = 2 * self.halo + 1
        mix = np.zeros((BLOCK, BLOCK + width - 1), dtype=before.dtype)
        for row in range(BLOCK):
            mix[row, row : row + width] = self.weights
        for start in range(0, count, BLOCK):
            size = min(BLOCK, count - start)
            np.matmul(
                mix[:size, : size + width - 1],
                before[start : start + size + width - 1],
                out=after[start : start + size],
            )
        return gathered
