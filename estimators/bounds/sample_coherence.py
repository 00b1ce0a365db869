"""Statistics of the sample coherence of Gaussian speckle."""

import numpy as np
from numpy.typing import ArrayLike

from sim.band import Real


def debias_coherence(sample_coherence: ArrayLike, looks: float) -> Real:
    """Coherence that a sample coherence stands for, to first order.

    `gamma^2 = (N g^2 - 1) / (N - 1)`, at least 0: exact in the mean of `g^2` at coherence 0, where that is `1 / N`, and
    at coherence 1. A single look says nothing, and gives 0.

    Parameters
    ----------
    sample_coherence
        `g`, 0 to 1.
    looks
        Independent looks, `N`.

    Returns
    -------
    array
        0 to 1.
    """
    squared = np.asarray(sample_coherence, dtype=float) ** 2
    if looks <= 1:
        return np.zeros_like(squared)
    debiased: Real = np.sqrt(np.clip((looks * squared - 1) / (looks - 1), 0.0, 1.0))
    return debiased
