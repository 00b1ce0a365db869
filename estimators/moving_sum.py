"""Sums over a moving window, at a cost that does not depend on its length."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from estimators.window_kernels import (
    MORE,
    NOTHING,
    PERIOD,
    sum_in_time,
    sum_over_rows,
    varying_sum_in_time,
    varying_sum_over_rows,
)

Numbers = NDArray[Any]
Size = int | NDArray[np.intp]
"""Of a window: the same everywhere, or one for every time, shape (time,)."""


def window_sum(array: Numbers, rows: Size, samples: Size, *, circular: bool) -> Numbers:
    """Sum over the window around each pixel, in double precision.

    The window of time `t` holds the samples `t - samples // 2` to `t - samples // 2 + samples - 1`, and rows likewise.
    No row lies beyond the array; in time it goes on periodically, or nothing lies beyond it. A bright pixel leaves no
    rounding error where it is not in the window; with sizes that vary it leaves 1e-31 of itself.

    Parameters
    ----------
    array
        Real or complex, shape (..., rows, time).
    rows, samples
        Size of the window, at least 1; where the array is circular, at most `time` samples.
    circular
        Whether the array is periodic in time.

    Returns
    -------
    array
        Of the same shape; (..., rows, 1) where every window holds the whole period, as all sums over time are then one.

    Raises
    ------
    ValueError
        For a size out of range, and for sizes of another shape than (time,).
    """
    planes = np.ascontiguousarray(array).reshape(-1, *array.shape[-2:])
    summed = [_summed(plane, None, rows, samples, circular) for plane in planes]
    return np.stack(summed).reshape(*array.shape[:-1], -1)


def product_sum(first: Numbers, second: Numbers, rows: Size, samples: Size, *, circular: bool) -> Numbers:
    """Sum of `conj(first) second` over the window around each pixel, as `window_sum`; no product is kept.

    Parameters
    ----------
    first, second
        Complex, shape (rows, time).
    rows, samples, circular
        As in `window_sum`.
    """
    return _summed(np.ascontiguousarray(first), np.ascontiguousarray(second), rows, samples, circular)


def product_sum_within(
    first: Numbers, second: Numbers, begins: tuple[int, int], rows: int, samples: int, out: Numbers
) -> None:
    """Sum of `conj(first) second` as `product_sum`, where the arrays hold more columns than are asked for.

    Parameters
    ----------
    first, second
        Complex, shape (rows, columns), with `samples` columns more on either side of those that are asked for.
    begins
        Columns of both from which on the sums are asked for.
    rows, samples
        Size of the window.
    out
        Takes the sums, shape (rows, time).
    """
    in_time = out if rows == 1 else np.empty_like(out)
    sum_in_time(first, second, begins, out.shape[1], samples, MORE, in_time)
    if rows > 1:
        _over_rows(in_time, rows, out)


def _summed(first: Numbers, second: Numbers | None, rows: Size, samples: Size, circular: bool) -> Numbers:
    number = first.shape[1]
    height, width = (_size(name, size, number) for name, size in (("rows", rows), ("samples", samples)))
    longest = int(np.max(width))
    if circular and longest > number:
        raise ValueError(f"samples is {longest}; it must not exceed the period, {number}")
    kind, beyond = np.complex128 if np.iscomplexobj(first) else np.float64, PERIOD if circular else NOTHING
    if isinstance(width, np.ndarray):
        in_time = np.empty(first.shape, dtype=kind)
        varying_sum_in_time(first, second, (0, 0), number, width, beyond, in_time)
    else:
        in_time = np.empty((len(first), 1 if circular and width == number else number), dtype=kind)
        sum_in_time(first, second, (0, 0), number, width, beyond, in_time)
    if isinstance(height, np.ndarray):
        out = np.empty(first.shape, dtype=kind)
        varying_sum_over_rows(np.ascontiguousarray(np.broadcast_to(in_time, first.shape)), height, out)
        return out
    return in_time if height == 1 else _over_rows(in_time, height, np.empty_like(in_time))


def _over_rows(in_time: Numbers, rows: int, out: Numbers) -> Numbers:
    # Of complex numbers both parts are summed alike.
    sum_over_rows(in_time.view(np.float64), rows, out.view(np.float64))
    return out


def _size(name: str, size: Size, number: int) -> Size:
    given = np.asarray(size)
    if given.shape not in ((), (number,)):
        raise ValueError(f"{name} has the shape {given.shape}; it must be one size, or one for each of {number} times")
    if not np.issubdtype(given.dtype, np.integer) or given.min() < 1:
        raise ValueError(f"{name} has the value {given.min()}; sizes must be whole numbers of at least 1")
    return int(given) if given.ndim == 0 else np.ascontiguousarray(given, dtype=np.intp)
