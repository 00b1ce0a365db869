"""Applying an estimator so that whatever it does, the study goes on."""

from collections.abc import Iterator
from dataclasses import fields, replace
from time import perf_counter
from typing import NamedTuple

import numpy as np

from estimators import DelayEstimate, Estimator, FixedWindow
from estimators.windows import WindowPolicy
from sim import EchoPair
from studies.measurement import Failure
from studies.named import words_of

SEARCHES = 64
"""Calls that may fail in a row while the trials at fault are looked for; where none succeeds, all count as failed."""


class Attempt(NamedTuple):
    """What an estimator made of a pair: NaN and not valid where it failed, what it said there, and its time [s]."""

    estimate: DelayEstimate
    raised: list[Failure]
    seconds: float


def attempt(estimator: Estimator, pair: EchoPair, window: WindowPolicy) -> Attempt:
    """Apply an estimator to a pair, without its truth.

    Where it raises and the rows are estimated one by one, halves are tried, and halves of these: only the rows at
    fault fail. Nothing is drawn again.
    """
    unseen = replace(pair, truth=None)
    for series in (unseen.primary, unseen.secondary):
        # All estimators see the same echoes.
        series.setflags(write=False)
    start = perf_counter()
    by_rows = isinstance(window, FixedWindow) and window.rows == 1
    parts = list(_parts(estimator, unseen, 0, by_rows, [SEARCHES]))
    seconds = perf_counter() - start
    estimates = [estimate for estimate, _ in parts]
    whole = (
        estimates[0]
        if len(parts) == 1
        else DelayEstimate(*(np.concatenate([getattr(e, f.name) for e in estimates]) for f in fields(DelayEstimate)))
    )
    return Attempt(whole, [failure for _, failures in parts for failure in failures], seconds)


def _parts(
    estimator: Estimator, pair: EchoPair, first: int, by_rows: bool, left: list[int]
) -> Iterator[tuple[DelayEstimate, list[Failure]]]:
    rows = pair.shape[0]
    try:
        estimate = _checked(estimator.estimate(pair), pair)
    except (Exception, SystemExit) as error:  # Whatever a user's estimator does must not stop the study.
        left[0] -= 1
        if by_rows and rows > 1 and left[0] > 0:
            half = rows // 2
            yield from _parts(estimator, pair.rows(slice(0, half)), first, by_rows, left)
            yield from _parts(estimator, pair.rows(slice(half, rows)), first + half, by_rows, left)
        else:
            said = words_of(error)
            yield _nothing(pair), [Failure(first + row, said) for row in range(rows)]
    else:
        left[0] = SEARCHES
        yield estimate, []


def _checked(estimate: DelayEstimate, pair: EchoPair) -> DelayEstimate:
    """The estimate with every array in the shape of the pair; ValueError where one cannot be."""
    arrays = {}
    for field in fields(DelayEstimate):
        given = np.asarray(getattr(estimate, field.name))
        if given.dtype.kind not in "biuf":
            raise ValueError(f"{field.name} is of type {given.dtype}; it must be real numbers")
        array = given.astype(np.bool_ if field.name == "valid" else np.float64, copy=False)
        try:
            arrays[field.name] = np.broadcast_to(array, pair.shape)
        except ValueError:
            raise ValueError(f"{field.name} has the shape {array.shape}; it must be {pair.shape}") from None
    return DelayEstimate(**arrays)


def _nothing(pair: EchoPair) -> DelayEstimate:
    unknown = np.full(pair.shape, np.nan)
    return DelayEstimate(*(unknown,) * 7, valid=np.zeros(pair.shape, dtype=np.bool_))
