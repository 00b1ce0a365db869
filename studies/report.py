"""What a run found: table and figures, from its block files alone."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import groupby
from pathlib import Path
from typing import Any

import pandas as pd

from studies import engine
from studies.blocks import Store, Task
from studies.study import Measurement, Point, Study, Traces
from studies.table import tabulate


@dataclass(frozen=True, eq=False)
class Result:
    """A study's table, the blocks in which estimates failed, and an example of each design point."""

    table: pd.DataFrame
    failures: pd.DataFrame
    traces: Sequence[tuple[Point, Traces]]


def result(study: Study, store: Store, methods: Sequence[str]) -> Result:
    """Statistics of all blocks that a store holds of some of a study's estimators; one block in memory at a time.

    Raises
    ------
    ValueError
        Where no block is there.
    """
    failures: list[dict[str, Any]] = []

    def measurements(task: Task) -> list[Measurement]:
        found = [m for m in store.read(task) if m.labels["estimator"] in methods]
        failures.extend(
            {**task.point, **m.labels, "block": task.block, "failures": m.failures, "first": m.failure}
            for m in found
            if m.failures
        )
        return found

    by_point = [(point, list(tasks)) for point, tasks in groupby(engine.tasks(study), lambda task: task.point)]
    table = tabulate((point, (measurements(task) for task in tasks)) for point, tasks in by_point)
    if table.empty:
        raise ValueError(f"{store.folder} holds no finished block; run the study first")
    return Result(table, pd.DataFrame(failures), [(point, store.read_traces(tasks[0])) for point, tasks in by_point])


def write(study: Study, found: Result, folder: Path) -> list[Path]:
    """Write the table, the failures if any, and the figures of a study; returns their paths.

    Raises
    ------
    OSError
        Where the folder cannot be written.
    """
    figures = folder / "figures"
    figures.mkdir(parents=True, exist_ok=True)
    paths = [folder / "table.csv"]
    found.table.to_csv(paths[0], index=False)
    if not found.failures.empty:
        paths.append(folder / "failures.csv")
        found.failures.to_csv(paths[-1], index=False)
    for name, figure in study.figures(found.table, found.traces).items():
        paths.append(figures / f"{name}.png")
        figure.savefig(paths[-1], dpi=150)
    return paths
