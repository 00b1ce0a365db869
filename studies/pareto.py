"""Which of several choices are beaten by another in cost and error together."""

import numpy as np
from numpy.typing import NDArray

from sim.band import Real

DIGITS = 3
"""Significant digits to which errors are compared: beyond, they differ by rounding or by the trials drawn."""


def to_digits(value: float) -> float:
    """A number to as many digits as count."""
    return float(f"{value:.{DIGITS - 1}e}")


def beaten_by(cost: Real, error: Real) -> NDArray[np.intp]:
    """For each choice the cheapest of those that beat it, and -1 for those that none does: the Pareto front.

    One beats another that costs no less and errs no less, to `DIGITS` digits, and does more of one of them. Whose cost
    or error is NaN neither beats nor is beaten.

    Parameters
    ----------
    cost, error
        Of each choice, at least 0, shape (choice,).
    """
    rounded = np.array([to_digits(value) for value in error])
    no_worse = (cost[:, None] <= cost) & (rounded[:, None] <= rounded)
    beats = no_worse & ((cost[:, None] < cost) | (rounded[:, None] < rounded))
    cheapest: NDArray[np.intp] = np.where(beats, cost[:, None], np.inf).argmin(axis=0)
    return np.where(beats.any(axis=0), cheapest, -1)
