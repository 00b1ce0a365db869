"""A flat band as lines: N of them B / N apart, or the Gauss rule that stands for them."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from .conventions import Floats

MAX_LINES = 20


def band_lines(looks: ArrayLike, most: int = MAX_LINES) -> tuple[Floats, Floats]:
    """
    Positions in the band, in units of its width about its centre, and weights of N equal lines B / N apart.

    Above `most` looks, and at real N, these are nodes and weights of the Gauss rule of N lines (Golub and
    Welsch 1969, on the recurrence of the discrete Chebyshev polynomials), which is N lines at whole N up to
    `most`. Both results have the shape of `looks` with an axis of lines at the end; weights add up to N, and
    are zero where there are fewer lines than in the longest row.
    """
    n = np.asarray(looks, dtype=np.float64)[..., None]
    k = np.arange(1.0, min(int(np.ceil(np.max(n))), most))
    beside = np.sqrt(k**2 * np.maximum(1.0 - (k / n) ** 2, 0.0) / (4.0 * (4.0 * k**2 - 1.0)))
    matrix = np.zeros((*n.shape[:-1], k.size + 1, k.size + 1))
    row = np.arange(k.size)
    matrix[..., row + 1, row] = beside
    position, vectors = np.linalg.eigh(matrix)
    weights: Floats = n * vectors[..., 0, :] ** 2
    return position, weights
