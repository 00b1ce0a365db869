"""The size of a square window that gives a depth as good as is asked for.

A square of M rows has the side `M dx` and `N = a M^2` looks, with `a = alpha dx / dy`; paper B has square pixels,
`dx = dy = d xi` and `a = alpha`. `std_one` is the bound of the depth from a single look, `depth_crlb(1, ...)`, so that
`sigma_z = std_one / sqrt(N)` (paper B, equation 3).
"""

from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from estimators.pixels import Pixels
from estimators.ranges import Ranges
from sim.band import Real

WrapErrors = Callable[[ArrayLike, ArrayLike, ArrayLike], Real]
"""Probability of a wrap error from looks, coherence and relative bandwidth; it falls with coherence."""

Condition = Callable[[NDArray[np.int64]], NDArray[np.bool_]]


def side_of_constant_std(std_one: Real, std: float, pixels: Pixels) -> Real:
    """Rows of the square whose depth has the standard deviation `std` [m]: `a M^2 = (std_one / std)^2`.

    Real numbers of the shape of `std_one`. Source: paper B, equation 5.
    """
    side: Real = std_one / std / np.sqrt(pixels.looks_in(1.0))
    return side


def side_of_constant_ratio(std_one: Real, kappa: float, pixels: Pixels) -> Real:
    """Rows of the square whose side is `kappa` times the standard deviation of its depth: `M dx = kappa sigma_z`.

    `M^2 = kappa std_one / (dx sqrt(a))`, in real numbers of the shape of `std_one`. Source: paper B, equations 6 and 7.
    """
    side: Real = np.sqrt(kappa * std_one / (pixels.along_track * np.sqrt(pixels.looks_in(1.0))))
    return side


def smallest_safe(extent: Real, looks: Real, ranges: Ranges, kappa: float, few_wraps: Condition) -> NDArray[np.int64]:
    """Number of the smallest window that is wide enough for its depth and has few wrap errors.

    Both `extent >= kappa depth_std` and the wrap-error probability are easier to meet the larger a window is, so that
    the smallest is found by halving.

    Parameters
    ----------
    extent
        Sides of the windows, rising [m], shape (window,).
    looks
        Looks in them at each range, shape (window, range); of less than one no window does.
    ranges
        How well a depth can be told at each range.
    kappa
        Side over exact spread of the depth, at least; 0 asks for none.
    few_wraps
        Tells of a number of a window for each range, shape (range,), where it has few enough wrap errors.

    Returns
    -------
    array
        Shape (range,); the number of windows where none does.
    """
    count, places = looks.shape
    place = np.arange(places)
    low, high = np.zeros(places, dtype=np.int64), np.full(places, count)
    while np.any(low < high):
        middle = (low + high) // 2
        tried = np.minimum(middle, count - 1)
        wide = extent[tried] >= kappa * ranges.depth_std(looks[tried, place])
        does = (wide & few_wraps(tried)) | (low >= high)
        low, high = np.where(does, low, middle + 1), np.where(does, middle, high)
    return low


def least_coherence(predict: WrapErrors, looks: Real, relative_bandwidth: float, most: float) -> Real:
    """Lowest coherence at which so many looks have at most a given wrap-error probability, within 1e-12.

    For many ranges and few sizes of windows: a prediction for each size costs less than one for each range.

    Parameters
    ----------
    predict
        The prediction, as `estimators.bounds.wrap_error_probability`.
    looks
        Any shape; of less than one look none has it, and the result is infinite.
    relative_bandwidth
        `B / fc`.
    most
        The probability, above 0.
    """
    distinct, which = np.unique(looks, return_inverse=True)
    low, high = np.zeros(distinct.shape), np.ones(distinct.shape)
    for _ in range(40):
        middle = (low + high) / 2
        does = predict(distinct, middle, relative_bandwidth) <= most
        low, high = np.where(does, low, middle), np.where(does, middle, high)
    for extreme in (np.ones_like(high), np.zeros_like(high)):
        does = predict(distinct, extreme, relative_bandwidth) <= most
        high = np.where(does, np.minimum(high, extreme), np.where(extreme == 1, np.inf, high))
    needed: Real = high[which].reshape(looks.shape)
    return needed
