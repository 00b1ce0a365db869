"""Small images of long scenes: what a block stores of its own rows for figures."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from estimators.moving_sum import window_sum
from sim import EchoPair
from sim.band import Real

CELL = (0.25, 0.5)
"""Extent of a cell along track and in slant range [m], about."""


@dataclass(frozen=True, eq=False)
class Cells:
    """Cells of the rows of a block, all of one size within half a row and sample.

    Attributes
    ----------
    rows, columns
        The row and the sample in the middle of each row and column of cells.
    size
        Rows and samples of a cell.
    row_extent
        Of a row of cells along track [m].
    """

    rows: NDArray[np.intp]
    columns: NDArray[np.intp]
    size: tuple[int, int]
    row_extent: float

    @classmethod
    def of(cls, pair: EchoPair, ends: tuple[float, float], overlap: int) -> "Cells":
        """Those of a pair between two ends of ground range [m], but for rows at either end that are another block's."""
        assert pair.geometry is not None
        assert pair.row_spacing is not None
        own, extent = pair.shape[0] - 2 * overlap, pair.geometry.sonar.sound_speed / (2 * pair.sample_rate)
        counts = round(own * pair.row_spacing / CELL[0]), round(pair.shape[1] * extent / CELL[1])
        rows, columns = (_middles(size, max(n, 1)) for size, n in zip((own, pair.shape[1]), counts, strict=True))
        ground = pair.geometry.ground_range(pair.grid.times)[columns]
        within = (ground >= ends[0]) & (ground < ends[1])
        size = max(own // len(rows), 1), max(pair.shape[1] // len(columns), 1)
        return cls(overlap + rows, columns[within], size, own * pair.row_spacing / len(rows))

    def middles(self, array: Real) -> Real:
        """An array of the shape of the pair in the middle of each cell, shape (row, column)."""
        chosen: Real = array[np.ix_(self.rows, self.columns)]
        return chosen

    def mean(self, array: Real) -> Real:
        """Its mean over each cell, likewise."""
        return self.middles(window_sum(array, *self.size, circular=True)) / (self.size[0] * self.size[1])


def _middles(size: int, count: int) -> NDArray[np.intp]:
    return ((np.arange(count) + 0.5) * size / count).astype(np.intp)
