"""Sums over trials from which all statistics follow; sums of blocks add up to those of a study."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sim.band import Real

QUANTITIES = ("tried", "wrong", "outlier", "right", "right_error", "right_square", "error", "square")
"""What is summed over the trials of a cluster: how many gave a number, a wrong wrap, an outlier, the right wrap; errors
and their squares, in the right wrap and in all. Errors count in wraps."""


@dataclass(frozen=True, eq=False)
class Moments:
    """Sums over clusters of trials; clusters are independent, the trials of one need not be.

    Attributes
    ----------
    clusters
        How many.
    totals
        Sum over all clusters of each of the `QUANTITIES`, shape (8,).
    products
        Sum over clusters of the products of their quantities, shape (8, 8): the spread between clusters.
    """

    clusters: int
    totals: Real
    products: Real

    def __add__(self, other: "Moments") -> "Moments":
        return Moments(self.clusters + other.clusters, self.totals + other.totals, self.products + other.products)

    def __getitem__(self, quantity: str) -> float:
        return float(self.totals[QUANTITIES.index(quantity)])


def of_errors(errors: Real, outliers: NDArray[np.bool_]) -> Moments:
    """Moments of delay errors.

    Parameters
    ----------
    errors
        In wraps, shape (cluster, trial). What is not finite does not count as tried.
    outliers
        Which estimates lie outside the main lobe of the correlation, same shape.
    """
    tried = np.isfinite(errors)
    error = np.where(tried, errors, 0.0)
    wrong = tried & (np.abs(error) > 0.5)
    right = tried & ~wrong
    per_trial = (tried, wrong, tried & outliers, right, right * error, right * error**2, error, error**2)
    sums = np.stack([quantity.sum(axis=1) for quantity in per_trial], axis=1, dtype=np.float64)
    return Moments(len(errors), sums.sum(axis=0), sums.T @ sums)
