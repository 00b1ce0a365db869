"""Sums over a moving window, at a cost that does not depend on its length."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from estimators.window_kernels import sum_in_time, sum_over_rows, varying_sum_in_time, varying_sum_over_rows

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
    summed = [_summed(plane, None, (0, 0), plane.shape[1], rows, samples, circular) for plane in planes]
    return np.stack(summed).reshape(*array.shape[:-1], -1)


def product_sum(
    first: Numbers,
    second: Numbers,
    rows: Size,
    samples: Size,
    *,
    circular: bool,
    begins: tuple[int, int] = (0, 0),
    length: int | None = None,
    out: Numbers | None = None,
) -> Numbers:
    """Sum of `conj(first) second` over the window around each pixel, as `window_sum`; no product is kept.

    Parameters
    ----------
    first, second
        Complex, shape (rows, columns).
    rows, samples, circular
        As in `window_sum`.
    begins, length
        Where in their columns the series begin, and how many samples they have; all by default.
    out
        Takes the sums, where given.
    """
    number = first.shape[1] if length is None else length
    series = np.ascontiguousarray(first), np.ascontiguousarray(second)
    return _summed(*series, begins, number, rows, samples, circular, out)


def _summed(
    first: Numbers,
    second: Numbers | None,
    begins: tuple[int, int],
    number: int,
    rows: Size,
    samples: Size,
    circular: bool,
    out: Numbers | None = None,
) -> Numbers:
    height, width = (_size(name, size, number) for name, size in (("rows", rows), ("samples", samples)))
    longest = int(np.max(width))
    if circular and longest > number:
        raise ValueError(f"samples is {longest}; it must not exceed the period, {number}")
    kind = np.complex128 if np.iscomplexobj(first) else np.float64
    all_times = 1 if circular and not isinstance(width, np.ndarray) and width == number else number
    shape = len(first), number if isinstance(height, np.ndarray) else all_times
    if out is None:
        out = np.empty(shape, dtype=kind)
    one_row = not isinstance(height, np.ndarray) and height == 1
    in_time = out if one_row else np.empty((len(first), all_times), dtype=kind)
    if isinstance(width, np.ndarray):
        varying_sum_in_time(first, second, begins, number, width, circular, in_time)
    else:
        sum_in_time(first, second, begins, number, width, circular, in_time)
    if isinstance(height, np.ndarray):
        varying_sum_over_rows(np.ascontiguousarray(np.broadcast_to(in_time, shape)), height, out)
    elif not one_row:
        # Of a complex number both parts are summed alike.
        sum_over_rows(in_time.view(np.float64), height, out.view(np.float64))
    return out


def _size(name: str, size: Size, number: int) -> Size:
    given = np.asarray(size)
    if given.shape not in ((), (number,)):
        raise ValueError(f"{name} has the shape {given.shape}; it must be one size, or one for each of {number} times")
    if not np.issubdtype(given.dtype, np.integer) or given.min() < 1:
        raise ValueError(f"{name} has the value {given.min()}; sizes must be whole numbers of at least 1")
    return int(given) if given.ndim == 0 else np.ascontiguousarray(given, dtype=np.intp)
