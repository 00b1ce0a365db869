"""Gauss quadrature for averages over a Beta distribution."""

import numpy as np
from scipy.linalg import eigh_tridiagonal

from sim.band import Real


def beta_nodes(alpha: float, beta: float, count: int) -> tuple[Real, Real]:
    """Nodes and weights of averages over Beta(alpha, beta).

    Golub and Welsch (1969) on the recurrence of the Jacobi polynomials. The weights add up to 1 by construction, so
    that parameters may be large where `scipy.special.roots_jacobi` overflows.

    Parameters
    ----------
    alpha, beta
        Above 0.
    count
        Number of nodes; exact for polynomials of degree `2 count - 1`.

    Returns
    -------
    nodes, weights
        Shape (count,), nodes within 0 to 1.
    """
    a, b = beta - 1.0, alpha - 1.0
    k = np.arange(1.0, count)
    middle = 2 * k + a + b
    diagonal = np.concatenate([[(b - a) / (a + b + 2)], (b - a) * (b + a) / (middle * (middle + 2))])
    beside = 4 * k * (k + a) * (k + b) / (middle**2 * (middle + 1))
    # The factor (k + a + b) / (2k + a + b - 1) is 1 at k = 1, also where both vanish.
    beside[1:] *= (k[1:] + a + b) / (middle[1:] - 1)
    points, vectors = eigh_tridiagonal(diagonal, np.sqrt(beside))
    nodes: Real = (points + 1) / 2
    return nodes, vectors[0] ** 2
