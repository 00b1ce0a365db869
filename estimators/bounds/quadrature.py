"""Gauss-Legendre nodes, which NumPy works out anew at every call."""

from functools import lru_cache

import numpy as np

from .conventions import Floats


@lru_cache(maxsize=16)
def unit_gauss_legendre(count: int) -> tuple[Floats, Floats]:
    """Nodes and weights over [0, 1], not to be written to."""
    x, w = np.polynomial.legendre.leggauss(count)
    nodes, weights = 0.5 * (x + 1.0), 0.5 * w
    nodes.flags.writeable = weights.flags.writeable = False
    return nodes, weights
