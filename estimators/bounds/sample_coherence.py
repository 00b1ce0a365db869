"""Statistics of the sample coherence of Gaussian speckle."""

import numpy as np
from numpy.typing import ArrayLike
from scipy.special import hyp2f1

from sim.band import Real

NODES = 1025
"""Coherences in the table that debiasing inverts."""

SERIES_FROM = 20.0
"""Looks from which 60 terms of the series reach rounding."""


def sample_coherence_mean_square(looks: float, coherence: ArrayLike) -> Real:
    """Mean square of the sample coherence.

    `E g^2 = 1 - (1 - 1 / N) (1 - gamma^2) 2F1(1, 1; N + 1; gamma^2)` (Touzi, Lopes, Bruniquel and Vachon 1999): `1 / N`
    without coherence, 1 with full coherence and for a single look.

    Parameters
    ----------
    looks
        Independent looks, `N`, 1 or more; any real number.
    coherence
        `gamma`, 0 to 1.

    Returns
    -------
    array
        0 to 1, of the shape of the coherence.
    """
    squared = np.asarray(coherence, dtype=float) ** 2
    if looks == 1:
        return np.ones_like(squared)
    mean: Real = 1 - (1 - 1 / looks) * (1 - squared) * _hypergeometric(looks, squared)
    return mean


def _hypergeometric(looks: float, squared: Real) -> Real:
    """`2F1(1, 1; N + 1; gamma^2)`; by its series at many looks, where SciPy's transformation overflows near 1."""
    if looks < SERIES_FROM:
        return np.asarray(hyp2f1(1, 1, looks + 1, np.minimum(squared, 1 - 1e-15)), dtype=float)
    orders = np.arange(1.0, 60.0)
    coefficients = np.concatenate([[1.0], np.cumprod(orders / (looks + orders))])
    series: Real = np.polynomial.polynomial.polyval(squared, coefficients)
    return series


def debias_coherence(sample_coherence: ArrayLike, looks: float) -> Real:
    """Coherence whose mean-square sample coherence is the observed one.

    Inverts `sample_coherence_mean_square` through a table, to 1e-5 of `gamma^2`. A sample below what no coherence gives
    stands for none; so does any of a single look, which says nothing.

    Parameters
    ----------
    sample_coherence
        `g`, 0 to 1.
    looks
        Independent looks, `N`; one or less counts as one.

    Returns
    -------
    array
        0 to 1.
    """
    squared = np.asarray(sample_coherence, dtype=float) ** 2
    if looks <= 1:
        return np.zeros_like(squared)
    coherence = np.sin(np.linspace(0.0, np.pi / 2, NODES))
    debiased: Real = np.sqrt(np.interp(squared, sample_coherence_mean_square(looks, coherence), coherence**2))
    return debiased
