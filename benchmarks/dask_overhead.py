"""What a task costs on a Dask scheduler with two workers, against two loky jobs and one process, on the same study.

Run it alone on a quiet machine: `.venv/bin/python -P benchmarks/dask_overhead.py`. All figures are of one run. Blocks
are so small that most of the time is spent to hand them out and store what they give.
"""

import socket
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from studies import catalogue, engine
from studies.engine import Run
from studies.study import Study

FEW, MANY, REPEATS = 100, 400, 4


def study(tasks: int) -> Study:
    """As many blocks of ten trials of 9 looks, at one design point."""
    values = {
        "patch.snr": [5],
        "patch.looks": [9],
        "sonar.bandwidth": ["30 kHz"],
        "trials.block": 10,
        "trials.count": 10 * tasks,
    }
    return catalogue.study("wrap-errors").with_values(values).of_estimators(["cross-correlation"])


def seconds(tasks: int, how: Run) -> float:
    """Of a run into an empty folder."""
    with tempfile.TemporaryDirectory() as folder:
        start = time.perf_counter()
        engine.run(study(tasks), how, Path(folder))
        return time.perf_counter() - start


@contextmanager
def cluster(workers: int) -> Iterator[str]:
    """Address of a scheduler with workers of one thread each, started as on a cluster."""
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    dask = (
        [sys.executable, "-m", "distributed.cli.dask_scheduler"],
        [sys.executable, "-m", "distributed.cli.dask_worker"],
    )
    address = f"tcp://127.0.0.1:{port}"
    commands = (
        [dask, "scheduler", "--host", "127.0.0.1", "--port", str(port), "--no-dashboard"],
        [dask, "worker", address, "--nworkers", str(workers), "--nthreads", "1", "--no-dashboard"],
    )
    started = [subprocess.Popen(words, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL) for words in commands]
    try:
        yield address
    finally:
        for process in reversed(started):
            process.terminate()
            process.wait()


def main() -> None:
    """Print seconds for each task, and what a run costs besides."""
    with cluster(2) as address:
        ways = {
            "one process": Run(jobs=1, backend="sequential"),
            "loky, two jobs": Run(jobs=2),
            "Dask, two workers": Run(backend="dask", scheduler=address),
        }
        least = {name: {FEW: float("inf"), MANY: float("inf")} for name in ways}
        for how in ways.values():
            seconds(20, how)
        for _ in range(REPEATS):
            for name, how in ways.items():
                for tasks in (FEW, MANY):
                    least[name][tasks] = min(least[name][tasks], seconds(tasks, how))
    for name, took in least.items():
        each = (took[MANY] - took[FEW]) / (MANY - FEW)
        rest = took[FEW] - FEW * each
        print(f"{name:18s} {1e3 * each:6.2f} ms a task, {rest:.2f} s besides; {MANY} tasks took {took[MANY]:.2f} s")


if __name__ == "__main__":
    main()
