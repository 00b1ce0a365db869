"""What a run found: table and figures, from its block files alone."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import groupby
from pathlib import Path

import pandas as pd

from studies import engine
from studies.blocks import Store
from studies.study import Point, Study, Traces
from studies.table import tabulate


@dataclass(frozen=True, eq=False)
class Result:
    """A study's table, and an example of each design point."""

    table: pd.DataFrame
    traces: Sequence[tuple[Point, Traces]]


def result(study: Study, store: Store, methods: Sequence[str]) -> Result:
    """Statistics of all blocks that a store holds of some of a study's estimators; one block in memory at a time.

    Raises
    ------
    ValueError
        Where no block is there.
    """
    by_point = [(point, list(tasks)) for point, tasks in groupby(engine.tasks(study), lambda task: task.point)]
    table = tabulate(
        (point, ([m for m in store.read(task) if m.labels["estimator"] in methods] for task in tasks))
        for point, tasks in by_point
    )
    if table.empty:
        raise ValueError(f"{store.folder} holds no finished block; run the study first")
    return Result(table, [(point, store.read_traces(tasks[0])) for point, tasks in by_point])


def write(study: Study, found: Result, folder: Path) -> list[Path]:
    """Write the table and the figures of a study; returns their paths.

    Raises
    ------
    OSError
        Where the folder cannot be written.
    """
    figures = folder / "figures"
    figures.mkdir(parents=True, exist_ok=True)
    paths = [folder / "table.csv"]
    found.table.to_csv(paths[0], index=False)
    for name, figure in study.figures(found.table, found.traces).items():
        paths.append(figures / f"{name}.png")
        figure.savefig(paths[-1], dpi=150)
    return paths
