"""What the engine costs: dispatch, storing and merging against a bare loop, and two jobs against one.

Run it alone on a quiet machine: `.venv/bin/python benchmarks/engine.py`. All ratios are of one run.
"""

import tempfile
import time
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path
from statistics import median

from studies import catalogue, engine, report
from studies.design import blocks, methods, points, task
from studies.measure import measure
from studies.parallel import one_thread
from studies.study import Study

BLOCKS, REPEATS = 24, 5


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


def bare(numbers: list[int]) -> float:
    """Seconds that the same work takes in a plain loop."""
    work = study()
    point = next(points(work))
    chosen = methods(work, point)
    with one_thread():
        start = time.perf_counter()
        for number in numbers:
            measure(task(work, point, number), chosen, work.trials.block, 2026)
        return time.perf_counter() - start


def with_engine(jobs: int, backend: str) -> float:
    """Seconds of a run with its report's statistics."""
    work = study()
    with tempfile.TemporaryDirectory() as folder:
        start = time.perf_counter()
        engine.run(work, engine.Run(jobs=jobs, backend=backend), Path(folder))
        report.result(work, engine.store_of(work, 2026, Path(folder)))
        return time.perf_counter() - start


def two_processes(numbers: list[int]) -> float:
    """Seconds of the same work in two bare processes."""
    with ProcessPoolExecutor(2) as pool:
        list(pool.map(bare, [[0], [0]]))
        start = time.perf_counter()
        list(pool.map(bare, [numbers[::2], numbers[1::2]]))
        return time.perf_counter() - start


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
    seconds = {name: [] for name in cases}
    for _ in range(REPEATS):
        for name, run in cases.items():
            seconds[name].append(run())
    middle = {name: median(times) for name, times in seconds.items()}
    for name, times in seconds.items():
        print(f"{name:20s} {middle[name]:6.2f} s  ({min(times):.2f} to {max(times):.2f})")
    print(f"a block takes {middle['bare'] / len(numbers):.3f} s")
    overheads = [with_ / without - 1 for with_, without in zip(seconds["sequential"], seconds["bare"], strict=True)]
    print(f"overhead of the engine: {median(overheads):.2%} (runs: {', '.join(f'{o:.2%}' for o in overheads)})")
    print(f"two bare processes are {middle['bare'] / middle['bare, two processes']:.2f} times as fast as one")
    print(f"two jobs are {middle['sequential'] / middle['loky, two jobs']:.2f} times as fast as one")


if __name__ == "__main__":
    main()
