"""Statistics of delay errors, each with its Monte Carlo standard error; trials may carry weights."""

from typing import NamedTuple

import numpy as np
from scipy.special import betaincinv, ndtri, stdtrit

from sim.band import Real
from studies.moments import QUANTITIES, Moments


class Statistic(NamedTuple):
    """A statistic and its standard error."""

    value: float
    error: float


class Interval(NamedTuple):
    """A share of trials, and its interval."""

    value: float
    low: float
    high: float


class Parts(NamedTuple):
    """Shares of the mean square error: bias and spread in the right wrap, and wrong wraps; they add up to 1."""

    bias: float
    spread: float
    wraps: float


def ratio(moments: Moments, of: str, over: str) -> Statistic:
    """Ratio of two sums, such as a mean.

    With the deviations `s_c = a_c - (A / B) b_c` of `C` clusters the error is `sqrt(C / (C - 1) sum s_c^2) / B`
    (linearisation of a ratio; Cochran 1977, chapter 6). For one trial a cluster a mean has its usual standard error;
    with likelihood ratios as weights it is the self-normalised estimate of importance sampling.

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
    return _std(moments, "right_square", "right_error", "right")


def std(moments: Moments) -> Statistic:
    """Standard deviation of all errors, wraps included [wraps]; its error as of `std_in_wrap`."""
    return _std(moments, "square", "error", "tried")


def rmse(moments: Moments) -> Statistic:
    """Root mean square of all errors, wraps included [wraps]; its error as of `std_in_wrap`."""
    return _root(ratio(moments, "square", "tried"))


def parts_of_mse(moments: Moments) -> Parts:
    """Where the mean square error comes from.

    With the wrap rate `p` and bias and spread in the right wrap, `MSE = (1 - p)(bias^2 + std^2) + p E[e^2 | wrong]`.
    """
    square, right = moments["square"], moments["right"]
    if not (square > 0 and right > 0):
        return Parts(np.nan, np.nan, np.nan) if not square > 0 else Parts(0.0, 0.0, 1.0)
    bias = moments["right_error"] ** 2 / right / square
    within = moments["right_square"] / square
    return Parts(bias, max(within - bias, 0.0), 1 - within)


def effective_trials(moments: Moments) -> float:
    """Trials of equal weight that would tell as much, `(sum w)^2 / sum w^2` (Kish 1965)."""
    return moments["tried"] ** 2 / moments.square_weight if moments.square_weight > 0 else 0.0


def effective_hits(moments: Moments, of: str) -> float:
    """Clusters of equal weight that would tell as much of what is counted, `(sum x)^2 / sum x^2`."""
    index = QUANTITIES.index(of)
    square = float(moments.products[index, index])
    return moments[of] ** 2 / square if square > 0 else 0.0


def wilson(moments: Moments, of: str, over: str = "tried", confidence: float = 0.95) -> Interval:
    """Share of the trials with Wilson's interval, for clusters that may depend within, and for weights.

    The interval is that of as many independent trials as have the spread seen between clusters (Wilson 1927; Korn and
    Graubard 1998 for the effective number).

    Parameters
    ----------
    moments
        Sums over the trials.
    of, over
        A quantity that counts trials, such as "wrong", and what it is a share of.
    confidence
        Coverage of the interval.
    """
    p, trials = _share(moments, of, over)
    if not trials > 0:
        return Interval(p, np.nan, np.nan)
    z = float(ndtri(0.5 + confidence / 2))
    centre = (p + z**2 / (2 * trials)) / (1 + z**2 / trials)
    half = z * np.sqrt(p * (1 - p) / trials + z**2 / (4 * trials**2)) / (1 + z**2 / trials)
    return Interval(p, centre - half if p > 0 else 0.0, centre + half if p < 1 else 1.0)


def clopper_pearson(moments: Moments, of: str, over: str = "tried", confidence: float = 0.95) -> Interval:
    """Share of the trials with the exact binomial interval, which covers at least as often as it says.

    Clopper and Pearson (1934), in the incomplete beta function; the number of trials as of `wilson`.
    """
    p, trials = _share(moments, of, over)
    if not trials > 0:
        return Interval(p, np.nan, np.nan)
    hits, tail = p * trials, (1 - confidence) / 2
    low = float(betaincinv(hits, trials - hits + 1, tail)) if p > 0 else 0.0
    high = float(betaincinv(hits + 1, trials - hits, 1 - tail)) if p < 1 else 1.0
    return Interval(p, low, high)


def _share(moments: Moments, of: str, over: str) -> tuple[float, float]:
    """A share, and the number of independent trials of equal weight that give it as exactly.

    Trials of one cluster depend on each other. What their clusters' spread tells of them is itself uncertain, so that
    the number is taken times `(z / t)^2` with Student's t of the clusters (Korn and Graubard 1998); where no spread was
    seen, a cluster counts as one trial, and a single cluster tells nothing.
    """
    p, error = ratio(moments, of, over)
    if not moments.weighted and moments.trials <= moments.clusters:
        return p, moments[over]
    if moments.clusters < 2:
        return p, np.nan
    caution = (ndtri(0.975) / stdtrit(moments.clusters - 1, 0.975)) ** 2
    if moments.weighted:
        return p, caution * p * (1 - p) / error**2 if error > 0 else effective_trials(moments)
    if not error > 0:
        return p, float(moments.clusters)
    # Dependence within clusters can only take from the trials.
    return p, min(moments[over], caution * p * (1 - p) / error**2)


def _std(moments: Moments, square: str, error: str, over: str) -> Statistic:
    mean = ratio(moments, error, over).value
    return _root(_linear(moments, {square: 1.0, error: -2 * mean, over: mean**2}, over))


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
    return Statistic(value, spread_of_sum(weights, moments.products, moments.clusters) / whole)


def spread_of_sum(weights: Real, products: Real, clusters: int) -> float:
    """Standard error of a weighted sum of quantities that is 0 in all, from the products of their cluster sums."""
    if clusters < 2:
        return np.nan
    between = max(float(weights @ products @ weights), 0.0)
    return float(np.sqrt(between * clusters / (clusters - 1)))


def _root(square: Statistic) -> Statistic:
    root = float(np.sqrt(np.maximum(square.value, 0.0)))
    return Statistic(root, 0.0 if root == 0 else square.error / (2 * root))
