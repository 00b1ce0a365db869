"""Sums over trials from which all statistics follow; sums of blocks add up to those of a study."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sim.band import Real

QUANTITIES = (
    "tried",
    "wrong",
    "outlier",
    "right",
    "right_error",
    "right_square",
    "error",
    "square",
    "covered",
    "claimed",
)
"""What is summed over the trials of a cluster, each times its weight: how many gave a number, a wrong wrap, an outlier,
the right wrap; errors and their squares, in the right wrap and in all; how many right ones lie within the interval that
the estimate itself gave; the wrap-error probabilities that the estimates claimed. Errors count in wraps."""

PAIRED = ("tried", "wrong", "square")
"""Which of these are compared between estimators, trial by trial."""

BATCHES = 16
"""Groups of clusters in a block for which these are kept."""


@dataclass(frozen=True, eq=False)
class Moments:
    """Sums over clusters of trials; clusters are independent, the trials of one need not be.

    Attributes
    ----------
    clusters
        How many.
    trials, wrap_errors
        How many trials gave a number, and a wrong wrap, whatever their weights.
    totals
        Sum over all clusters of each of the `QUANTITIES`, shape (10,).
    products
        Sum over clusters of the products of their quantities, shape (10, 10): the spread between clusters.
    square_weight
        Sum of the squared weights of what is in `trials`.
    largest_weight
        The largest of them; of importance sampling, a likelihood ratio.
    """

    clusters: int
    trials: int
    wrap_errors: int
    totals: Real
    products: Real
    square_weight: float
    largest_weight: float

    def __add__(self, other: "Moments") -> "Moments":
        return Moments(
            self.clusters + other.clusters,
            self.trials + other.trials,
            self.wrap_errors + other.wrap_errors,
            self.totals + other.totals,
            self.products + other.products,
            self.square_weight + other.square_weight,
            max(self.largest_weight, other.largest_weight),
        )

    @property
    def weighted(self) -> bool:
        """Whether the trials have weights other than 1."""
        return not (self.square_weight == self["tried"] == self.trials)

    def __getitem__(self, quantity: str) -> float:
        return float(self.totals[QUANTITIES.index(quantity)])


def of_errors(
    errors: Real,
    outliers: NDArray[np.bool_],
    *,
    half_width: ArrayLike = 0.0,
    claimed: ArrayLike = 0.0,
    weights: ArrayLike = 1.0,
    place: Real | None = None,
) -> tuple[Moments, Real]:
    """Moments of delay errors, and what is compared between estimators.

    Parameters
    ----------
    errors
        In wraps, shape (cluster, trial). What is not finite does not count as tried.
    outliers
        Which estimates lie outside the main lobe of the correlation, same shape.
    half_width
        Half the width of the interval that each estimate gave itself [wraps]; broadcasts to that shape.
    claimed
        Wrap-error probability that each estimate gave itself; broadcasts.
    weights
        Likelihood ratio of each trial; broadcasts.
    place
        Where each cluster lies in its block, 0 to 1, shape (cluster,); even where None.

    Returns
    -------
    moments, batches
        The batches are sums of the quantities `PAIRED` over clusters that lie together in the block, shape
        (BATCHES, 3): the same part of the block for every estimator.
    """
    tried = np.isfinite(errors)
    error = np.where(tried, errors, 0.0)
    wrong = tried & (np.abs(error) > 0.5)
    right = tried & ~wrong
    covered = right & (np.abs(error) <= half_width)
    weight = np.where(tried, weights, 0.0)
    per_trial = {
        "tried": tried,
        "wrong": wrong,
        "outlier": tried & outliers,
        "right": right,
        "right_error": right * error,
        "right_square": right * error**2,
        "error": error,
        "square": error**2,
        "covered": covered,
        "claimed": np.where(tried, claimed, 0.0),
    }
    sums = np.stack([np.sum(weight * per_trial[name], axis=1) for name in QUANTITIES], axis=1)
    moments = Moments(
        clusters=len(errors),
        trials=int(tried.sum()),
        wrap_errors=int(wrong.sum()),
        totals=sums.sum(axis=0),
        products=sums.T @ sums,
        square_weight=float(np.sum(weight**2)),
        largest_weight=float(weight.max(initial=0.0)),
    )
    lies = np.arange(len(errors)) / max(len(errors), 1) if place is None else place
    batches = np.zeros((BATCHES, len(PAIRED)))
    np.add.at(batches, (BATCHES * lies).astype(int), sums[:, [QUANTITIES.index(name) for name in PAIRED]])
    return moments, batches
