"""What calls cost: processor time in turns, and the memory they take at once."""

import time
import tracemalloc
from collections.abc import Callable, Mapping
from typing import NamedTuple

import numpy as np

from sim.band import Real

Case = Callable[[], object]


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


def in_turns(
    cases: Mapping[str, Case], repeats: int, clock: Callable[[], float] = time.process_time
) -> dict[str, Real]:
    """Time of every repeat of each case [s], shape (repeat,); by default on this process's processor.

    Each is called once before, so that code is compiled and memory at hand. Then all take turns, so that a busy moment
    strikes all alike, and a ratio of two is that within a turn. On the processor's clock, time that the process waits
    for others does not count; that of all its threads does.
    """
    for case in cases.values():
        case()
    spent: dict[str, list[float]] = {name: [] for name in cases}
    for _ in range(repeats):
        for name, case in cases.items():
            start = clock()
            case()
            spent[name].append(clock() - start)
    return {name: np.array(values) for name, values in spent.items()}


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
