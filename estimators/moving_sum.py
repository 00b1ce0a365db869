"""Sums over a moving window, at a cost that does not depend on its length."""

from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

Number = TypeVar("Number", bound=np.inexact[Any])


def circular_sum(array: NDArray[Number], length: int) -> NDArray[Number]:
    """Sum over windows of `length` samples along the last axis, as if the array went on periodically.

    Window `i` holds the samples `i - length // 2` to `i - length // 2 + length - 1`. It is put together from the tail
    of one block and the head of the next, of `length` samples each (van Herk): nothing is subtracted, so that a bright
    sample leaves no rounding error where it is not in the window.

    Parameters
    ----------
    array
        Shape (..., samples).
    length
        1 to samples.

    Returns
    -------
    array
        Of the same shape; (..., 1) where the window holds the whole period, as all sums are then one.
    """
    samples = array.shape[-1]
    if length == 1:
        return array
    if length == samples:
        whole: NDArray[Number] = array.sum(axis=-1, keepdims=True)
        return whole
    blocks = -(-samples // length) + 1
    first = np.arange(-(length // 2), blocks * length - length // 2)
    cells = np.take(array, first, axis=-1, mode="wrap").reshape(*array.shape[:-1], blocks, length)
    heads = np.zeros_like(cells)
    np.cumsum(cells[..., :-1], axis=-1, out=heads[..., 1:])
    tails = np.cumsum(cells[..., ::-1], axis=-1)[..., ::-1]
    flat = (*array.shape[:-1], (blocks - 1) * length)
    return (tails[..., :-1, :] + heads[..., 1:, :]).reshape(flat)[..., :samples]


def clipped_sum(array: NDArray[Number], length: int, axis: int) -> NDArray[Number]:
    """Sum over windows as `circular_sum`, but nothing lies beyond the ends of the array, and along any axis."""
    if length == 1:
        return array
    moved = np.moveaxis(array, axis, -1)
    padded = np.concatenate([moved, np.zeros((*moved.shape[:-1], length), dtype=array.dtype)], axis=-1)
    return np.moveaxis(circular_sum(padded, length)[..., : moved.shape[-1]], -1, axis)
