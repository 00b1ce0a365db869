"""What the engine costs: dispatch, storing and merging against a bare loop, and two jobs against one.

Run it alone on a quiet machine: `.venv/bin/python benchmarks/engine.py`. All ratios are of one run.
"""

import tempfile
import time
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path
from statistics import median
from typing import NamedTuple

from studies import catalogue, engine, report
from studies.allocation import keep_freed_memory
from studies.design import blocks, methods, points, task
from studies.measure import measure
from studies.parallel import one_thread
from studies.study import Study

BLOCKS, REPEATS = 64, 5


class Times(NamedTuple):
    """Seconds on the wall clock, and of this process's processor."""

    wall: float
    processor: float

    @classmethod
    def now(cls) -> "Times":
        """The clocks."""
        return cls(time.perf_counter(), time.process_time())

    def since(self, start: "Times") -> "Times":
        """Between two readings."""
        return Times(self.wall - start.wall, self.processor - start.processor)


def study() -> Study:
    """Blocks of about 0.2 s."""
    values = {
        "patch.snr": [5],
        "patch.looks": [33],
        "sonar.bandwidth": ["30 kHz"],
        "trials.block": 1500,
        "trials.count": 1500 * BLOCKS,
    }
    return catalogue.study("wrap-errors").with_values(values)


def bare(numbers: list[int]) -> Times:
    """Times that the same work takes in a plain loop."""
    work = study()
    point = next(points(work))
    chosen = methods(work, point)
    keep_freed_memory()
    with one_thread():
        start = Times.now()
        for number in numbers:
            measure(task(work, point, number), chosen, work.trials.block, 2026)
        return Times.now().since(start)


def with_engine(jobs: int, backend: str) -> Times:
    """Times of a run with its report's statistics."""
    work = study()
    with tempfile.TemporaryDirectory() as folder:
        start = Times.now()
        engine.run(work, engine.Run(jobs=jobs, backend=backend), Path(folder))
        report.result(work, engine.store_of(work, 2026, Path(folder)))
        return Times.now().since(start)


def two_processes(numbers: list[int]) -> Times:
    """Times of the same work in two bare processes."""
    with ProcessPoolExecutor(2) as pool:
        list(pool.map(bare, [[0], [0]]))
        start = Times.now()
        list(pool.map(bare, [numbers[::2], numbers[1::2]]))
        return Times.now().since(start)


def main() -> None:
    """Print the ratios."""
    numbers = list(range(blocks(study())))
    bare([0])
    with_engine(2, "loky")
    cases = {
        "bare": lambda: bare(numbers),
        "sequential": lambda: with_engine(1, "sequential"),
        "bare, two processes": lambda: two_processes(numbers),
        "loky, two jobs": lambda: with_engine(2, "loky"),
    }
    seconds: dict[str, list[float]] = {name: [] for name in cases}
    processor: dict[str, list[float]] = {name: [] for name in cases}
    for _ in range(REPEATS):
        for name, run in cases.items():
            took = run()
            seconds[name].append(took.wall)
            processor[name].append(took.processor)
    middle = {name: median(times) for name, times in seconds.items()}
    for name, times in seconds.items():
        print(f"{name:20s} {middle[name]:6.2f} s  ({min(times):.2f} to {max(times):.2f})")
    print(f"a block takes {middle['bare'] / len(numbers):.3f} s")
    for kind, times in (("wall clock", seconds), ("processor", processor)):
        overheads = [with_ / without - 1 for with_, without in zip(times["sequential"], times["bare"], strict=True)]
        runs = ", ".join(f"{overhead:.2%}" for overhead in overheads)
        print(f"overhead of the engine, {kind}: {median(overheads):.2%} (runs: {runs})")
    print(f"two bare processes are {middle['bare'] / middle['bare, two processes']:.2f} times as fast as one")
    print(f"two jobs are {middle['sequential'] / middle['loky, two jobs']:.2f} times as fast as one")


if __name__ == "__main__":
    main()
