"""What calls cost: processor time in turns, and the memory they take at once."""

import math
import time
import tracemalloc
from collections.abc import Callable, Mapping
from typing import NamedTuple

import numpy as np

from sim.band import Real

Case = Callable[[], object]

COPIED = 2**21
"""Complex pixels of either series that are copied to compare with: 67 MB together, which no cache holds."""


class Quartiles(NamedTuple):
    """Median of repeats, and their first and third quartile."""

    median: float
    low: float
    high: float

    @classmethod
    def of(cls, values: Real) -> "Quartiles":
        """Of measured values."""
        low, median, high = np.quantile(values, (0.25, 0.5, 0.75))
        return cls(float(median), float(low), float(high))


class Price(NamedTuple):
    """Processor time a pixel [s], and in copies of a pixel of both series."""

    seconds: Quartiles
    copies: Quartiles


def prices(cases: Mapping[str, Case], pixels: int, repeats: int) -> dict[str, Price]:
    """What each case costs a pixel, beside copying two series of complex128 in memory in the same turn (`in_turns`)."""
    source = np.ones((2, COPIED), dtype=complex)
    target = np.empty_like(source)
    copying, *spent = in_turns({"": lambda: np.copyto(target, source), **cases}, repeats).values()
    each = (times / pixels for times in spent)
    return {
        name: Price(Quartiles.of(times), Quartiles.of(times / (copying / COPIED)))
        for name, times in zip(cases, each, strict=True)
    }


SHORTEST = 0.004
"""Seconds of a turn at least: what is shorter is called several times in it."""


def in_turns(
    cases: Mapping[str, Case], repeats: int, clock: Callable[[], float] = time.process_time
) -> dict[str, Real]:
    """Time of a call of each case in every turn [s], shape (repeat,); by default on this process's processor.

    Each is called before, so that code is compiled and memory at hand. Then all take turns, so that a busy moment
    strikes all alike, and a ratio of two is that within a turn. What is short is called several times in its turn, and
    their mean counts: the first finds the caches as another case left them. On the processor's clock, time that the
    process waits for others does not count; that of all its threads does.
    """
    often = {name: _often(case, clock) for name, case in cases.items()}
    spent: dict[str, list[float]] = {name: [] for name in cases}
    for _ in range(repeats):
        for name, case in cases.items():
            spent[name].append(_spent(case, clock, often[name]))
    return {name: np.array(values) for name, values in spent.items()}


def _often(case: Case, clock: Callable[[], float]) -> int:
    """How many calls take `SHORTEST`; a thousand at the most."""
    took = _spent(case, clock)
    # What is short is called once more, as the first call is slow.
    took = _spent(case, clock) if took < SHORTEST else took
    return max(1, math.ceil(SHORTEST / max(took, SHORTEST / 1000)))


def _spent(case: Case, clock: Callable[[], float], times: int = 1) -> float:
    start = clock()
    for _ in range(times):
        case()
    return (clock() - start) / times


def peak_bytes(case: Case) -> int:
    """Most bytes that a call holds at once beyond what was there before, what it returns included."""
    tracemalloc.start()
    try:
        before = tracemalloc.get_traced_memory()[0]
        kept = case()
        peak = tracemalloc.get_traced_memory()[1]
        del kept
        return peak - before
    finally:
        tracemalloc.stop()
