"""Statistics of delay errors, each with its Monte Carlo standard error."""

from typing import NamedTuple

import numpy as np
from scipy.special import ndtri

from sim.band import Real
from studies.moments import QUANTITIES, Moments


class Statistic(NamedTuple):
    """A statistic and its standard error."""

    value: float
    error: float


class Rate(NamedTuple):
    """A share of trials, and its interval."""

    value: float
    low: float
    high: float


def ratio(moments: Moments, of: str, over: str) -> Statistic:
    """Ratio of two sums, such as a mean.

    With the deviations `s_c = a_c - (A / B) b_c` of `C` clusters the error is `sqrt(C / (C - 1) sum s_c^2) / B`
    (linearisation of a ratio; Cochran 1977, chapter 6). For one trial a cluster a mean has its usual standard error.

    Parameters
    ----------
    moments
        Sums over the trials.
    of, over
        Two of the `QUANTITIES`, `A` and `B`.

    Returns
    -------
    Statistic
        NaN where `B` is 0; the error is NaN for a single cluster.
    """
    return _linear(moments, {of: 1.0}, over)


def std_in_wrap(moments: Moments) -> Statistic:
    """Standard deviation of the errors in the right wrap, around their mean [wraps].

    The error is that of the mean square over twice the root; for one trial a cluster it is the kurtosis form
    `sqrt((m4 - m2^2) / n) / (2 sqrt(m2))`, which holds for heavy tails where the normal-theory form `sigma / sqrt(2 n)`
    fails.
    """
    bias = ratio(moments, "right_error", "right").value
    return _root(_linear(moments, {"right_square": 1.0, "right_error": -2 * bias, "right": bias**2}, "right"))


def rmse(moments: Moments) -> Statistic:
    """Root mean square of all errors, wraps included [wraps]; its error as of `std_in_wrap`."""
    return _root(ratio(moments, "square", "tried"))


def rate(moments: Moments, of: str, confidence: float = 0.95) -> Rate:
    """Share of the trials with Wilson's interval, for clusters that may depend within.

    The interval is that of as many independent trials as have the spread seen between clusters, never more than there
    are (Wilson 1927; Korn and Graubard 1998 for the effective number).

    Parameters
    ----------
    moments
        Sums over the trials.
    of
        "wrong", "outlier" or "right".
    confidence
        Coverage of the interval.
    """
    p, error = ratio(moments, of, "tried")
    trials = moments["tried"]
    if trials == 0:
        return Rate(np.nan, np.nan, np.nan)
    spread = p * (1 - p)
    if trials > moments.clusters and error > 0:
        trials = min(trials, spread / error**2)
    z = float(ndtri(0.5 + confidence / 2))
    centre = (p + z**2 / (2 * trials)) / (1 + z**2 / trials)
    half = z * np.sqrt(spread / trials + z**2 / (4 * trials**2)) / (1 + z**2 / trials)
    return Rate(p, centre - half if p > 0 else 0.0, centre + half if p < 1 else 1.0)


def _linear(moments: Moments, of: dict[str, float], over: str) -> Statistic:
    """Ratio of a linear combination of sums to a sum, with the error of its linearisation."""
    whole = moments[over]
    if whole == 0:
        return Statistic(np.nan, np.nan)
    weights = np.zeros(len(QUANTITIES))
    for quantity, weight in of.items():
        weights[QUANTITIES.index(quantity)] += weight
    value = float(weights @ moments.totals) / whole
    weights[QUANTITIES.index(over)] -= value
    if moments.clusters < 2:
        return Statistic(value, np.nan)
    between = max(_quadratic(weights, moments.products), 0.0) * moments.clusters / (moments.clusters - 1)
    return Statistic(value, float(np.sqrt(between)) / whole)


def _quadratic(weights: Real, products: Real) -> float:
    return float(weights @ products @ weights)


def _root(square: Statistic) -> Statistic:
    root = float(np.sqrt(np.maximum(square.value, 0.0)))
    return Statistic(root, 0.0 if root == 0 else square.error / (2 * root))
