"""Statistics of delay errors, each with its Monte Carlo standard error."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.special import ndtri

from sim.band import Real


class Statistic(NamedTuple):
    """A statistic and its standard error."""

    value: float
    error: float


class Rate(NamedTuple):
    """A share of trials, and its 95 % interval."""

    value: float
    low: float
    high: float


def mean(values: Real, of: NDArray[np.bool_]) -> Statistic:
    """Mean of some of the values of clusters, with the standard error between clusters.

    Values of one cluster may depend on each other, clusters do not. With the sums `s_c` of the deviations from the
    mean in `C` clusters and `n` values in all, the error is `sqrt(C / (C - 1) sum s_c^2) / n` (linearisation of a
    ratio). For one value a cluster this is the usual standard error of a mean.

    Parameters
    ----------
    values
        Shape (cluster, value).
    of
        Which values count; same shape.

    Returns
    -------
    Statistic
        NaN where nothing counts; the error is NaN for a single cluster.
    """
    total = int(of.sum())
    if total == 0:
        return Statistic(np.nan, np.nan)
    centre = float(values[of].mean())
    scores = np.where(of, values - centre, 0.0).sum(axis=1)[of.any(axis=1)]
    clusters = len(scores)
    if clusters < 2:
        return Statistic(centre, np.nan)
    return Statistic(centre, float(np.sqrt(clusters / (clusters - 1) * np.sum(scores**2)) / total))


def root_mean_square(values: Real, of: NDArray[np.bool_], centre: float = 0.0) -> Statistic:
    """Root of the mean square of some of the values around a centre, with its standard error.

    The error is that of the mean square over twice the root; for single values a cluster around their mean it is the
    kurtosis form `sqrt((m4 - m2^2) / n) / (2 sqrt(m2))`, which holds for heavy tails where the normal-theory form
    `sigma / sqrt(2 n)` fails.

    Parameters
    ----------
    values, of
        As for `mean`.
    centre
        What the deviations are from.
    """
    square = mean((values - centre) ** 2, of)
    root = float(np.sqrt(square.value))
    return Statistic(root, square.error / (2 * root) if root > 0 else 0.0)


def rate(hits: NDArray[np.bool_], of: NDArray[np.bool_], confidence: float = 0.95) -> Rate:
    """Share of hits with Wilson's interval, for clusters that may depend within.

    The interval is that of as many independent trials as have the spread seen between clusters, never more than there
    are (Wilson 1927; Korn and Graubard 1998 for the effective number).

    Parameters
    ----------
    hits, of
        Which trials hit, and which count; shape (cluster, trial).
    confidence
        Coverage of the interval.
    """
    share = mean(hits.astype(float), of)
    total = float(of.sum())
    if total == 0:
        return Rate(np.nan, np.nan, np.nan)
    p = share.value
    spread = p * (1 - p)
    if hits.shape[1] > 1 and share.error > 0:
        total = min(total, spread / share.error**2)
    z = float(ndtri(0.5 + confidence / 2))
    centre = (p + z**2 / (2 * total)) / (1 + z**2 / total)
    half = z * np.sqrt(spread / total + z**2 / (4 * total**2)) / (1 + z**2 / total)
    return Rate(p, centre - half if p > 0 else 0.0, centre + half if p < 1 else 1.0)
