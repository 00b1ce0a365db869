"""Climbs from any lag to a local maximum, and what says where they begin."""

import numpy as np
from numpy.typing import ArrayLike

from estimators.estimate import Estimator
from estimators.lag_product import power
from estimators.peak import Index
from sim import EchoPair
from sim.band import Complex, Real

Start = Estimator | ArrayLike
"""Another estimator, or its delays [s]: an array that broadcasts to the shape of the pair."""


def first_from(products: Complex, start: Index) -> Index:
    """Lag of the local maximum where a climb from a lag of each pixel's own ends.

    Parameters
    ----------
    products
        Lag products, shape (lag, rows, time).
    start
        Shape (rows, time); a lag before the first or beyond the last is taken to that.

    Returns
    -------
    array
        Shape (rows, time). From the middle lag it is that of `estimators.peak.first_from_zero`.
    """
    magnitude = power(products)
    lags = len(magnitude)
    start = np.clip(start, 0, lags - 1)
    lag = np.arange(lags).reshape(-1, 1, 1)
    falls = np.ones(magnitude.shape, dtype=np.bool_)
    np.less_equal(magnitude[1:], magnitude[:-1], out=falls[:-1])
    ahead = (falls & (lag >= start)).argmax(axis=0)
    falls[0] = True
    np.less_equal(magnitude[:-1], magnitude[1:], out=falls[1:])
    behind = lags - 1 - (falls & (lag <= start))[::-1].argmax(axis=0)
    beside = (np.take_along_axis(magnitude, np.clip(start + step, 0, lags - 1)[None], axis=0)[0] for step in (1, -1))
    upper, lower = beside
    found: Index = np.where((ahead > start) & ((upper >= lower) | (behind == start)), ahead, behind)
    return found


def start_of(start: Start, pair: EchoPair) -> Real:
    """Delays at which climbs begin [s], of the shape of the pair; NaN where the other estimator finds none valid.

    Raises
    ------
    ValueError
        For an array that does not broadcast to the shape of the pair.
    """
    if isinstance(start, Estimator):
        other = start.estimate(pair)
        return np.broadcast_to(np.where(other.valid, other.delay, np.nan), pair.shape)
    delays = np.asarray(start, dtype=float)
    try:
        return np.broadcast_to(delays, pair.shape)
    except ValueError:
        raise ValueError(
            f"start has the shape {delays.shape}; it must broadcast to that of the pair, {pair.shape}"
        ) from None
