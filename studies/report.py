"""What a run found: tables, figures and a page, from its block files alone."""

from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pandas as pd

from studies.blocks import Store
from studies.comparison import Comparison
from studies.design import Point, computed, methods, points
from studies.drawing import Examples
from studies.measurement import Measurement
from studies.named import called, imported
from studies.page import page
from studies.plain_answer import plain_answer
from studies.stopping import Standing, measured_blocks
from studies.study import Study
from studies.table import row, with_depths


@dataclass(frozen=True, eq=False)
class Result:
    """A study's tables, and an example of each design point.

    Attributes
    ----------
    table
        A row for each design point, estimator, window and region.
    differences
        Every two estimators against each other on the same echoes.
    failures
        A row for each trial in which an estimator gave no number.
    missing
        Blocks that the study asks for and an estimator lacks, of how many.
    hidden
        Design points that are stored, but that the study does not ask for.
    examples
        For figures.
    """

    table: pd.DataFrame
    differences: pd.DataFrame
    failures: pd.DataFrame
    examples: Examples
    missing: tuple[int, int] = (0, 0)
    hidden: int = 0

    @property
    def warnings(self) -> list[str]:
        """What a reader must know of the table: rows that rest on few weights, and failures."""
        said: list[str] = []
        if "few_dominate" not in self.table:
            return said
        few = int(self.table.few_dominate.sum())
        if self.missing[0]:
            said.append(f"{self.missing[0]} of {self.missing[1]} blocks are missing; the same run goes on with them")
        if few:
            said.append(f"in {few} of {len(self.table)} rows a few trials have most of the weight (few_dominate)")
        failed = int(self.table.failures.sum())
        if failed:
            name, error = Counter(zip(self.failures.estimator, self.failures.error, strict=True)).most_common(1)[0][0]
            counted = f"{failed} of {int(self.table.trials.sum())} estimates failed"
            said.append(f"{counted}, most often {name}: {error}; failures.csv has the trials")
        if self.hidden:
            said.append(f"blocks of {self.hidden} other design points are stored and not shown")
        return said


def result(study: Study, store: Store) -> Result:
    """Statistics of all that a store holds of a study; a block in memory at a time, merged in block order.

    Parameters
    ----------
    study
        Which points, estimators and blocks count.
    store
        Its block files; of a study without trials, which is computed here, it is not read.

    Returns
    -------
    Result
        Tables and examples.

    Raises
    ------
    ValueError
        Where no block is there.
    """
    if not study.simulates:
        tables = [_beside(varied, section.table(sonar)) for varied, section, sonar in computed(study)]
        return Result(pd.concat(tables, ignore_index=True), pd.DataFrame(), pd.DataFrame(), [])
    rows: list[dict[str, Any]] = []
    differences: list[dict[str, Any]] = []
    failures: list[dict[str, Any]] = []
    examples = []
    missing = wanted = 0
    design = list(points(study))
    for point in design:
        of_point = _Sums(study, point)
        for block, by_method in measured_blocks(study, point, store.read(point)):
            of_point.add(block, by_method)
        for standing in of_point.standings.values():
            missing, wanted = missing + standing.missing.size, wanted + standing.target
        rows += [row(point, measurement) for measurement in of_point.sums()]
        differences += [{**point.columns, **found} for found in of_point.comparison.rows()]
        failures += of_point.failures
        traces = store.read_traces(point)
        if traces:
            examples.append((point.varied, traces))
    if not rows:
        raise ValueError(f"{store.folder} holds no finished block; run the study first")
    table = with_depths(pd.DataFrame(rows))
    return Result(
        table, pd.DataFrame(differences), pd.DataFrame(failures), examples, (missing, wanted), store.others(design)
    )


def _beside(varied: Mapping[str, Any], table: pd.DataFrame) -> pd.DataFrame:
    """A table with what varies in front."""
    return table.assign(**varied)[[*varied, *table.columns]]


class _Sums:
    """Sums over the blocks of a point, in order."""

    def __init__(self, study: Study, point: Point) -> None:
        self.point = point
        self.standings = {method.labels: Standing(study, method.section.blocks) for method in methods(study, point)}
        self.comparison = Comparison()
        self.failures: list[dict[str, Any]] = []

    def add(self, block: int, by_method: dict[tuple[str, str], list[Measurement]]) -> None:
        counted = []
        for labels, standing in self.standings.items():
            found = by_method.get(labels, [])
            if found and standing.add(block, found):
                counted.append(found)
                self.failures += [
                    {
                        **self.point.columns,
                        "estimator": m.estimator,
                        "window": m.window,
                        "region": m.region,
                        "block": block,
                        "trial": failure.trial,
                        "error": failure.error,
                    }
                    for m in found
                    for failure in m.failed
                ]
        self.comparison.add([m for found in counted for m in found])

    def sums(self) -> list[Measurement]:
        return [measurement for standing in self.standings.values() for measurement in standing.sums.values()]


def write(study: Study, found: Result, folder: Path) -> list[Path]:
    """Write the tables, the figures and the page of a study.

    Parameters
    ----------
    study, found
        The study, and what came of it.
    folder
        Where to; that of the run, which has the manifest that the page quotes.

    Returns
    -------
    list of Path
        All that was written.

    Raises
    ------
    ValueError
        For a figure or summary that asks for a column that there is not.
    OSError
        Where the folder cannot be written.
    """
    (folder / "figures").mkdir(parents=True, exist_ok=True)
    tables = {"table": found.table, "differences": found.differences, "failures": found.failures}
    paths = []
    for name, table in tables.items():
        path = folder / f"{name}.csv"
        path.unlink(missing_ok=True)
        if not table.empty:
            table.to_csv(path, index=False)
            paths.append(path)
    drawn = {section.name: section.drawn(found.table, found.examples) for section in study.figures}
    for name, figure in drawn.items():
        paths.append(folder / "figures" / f"{name}.png")
        figure.savefig(paths[-1], dpi=150)
    paths.append(folder / "report.html")
    paths[-1].write_text(
        page(study, found.table, answer(study, found), found.warnings, drawn, folder), encoding="utf-8"
    )
    return paths


def answer(study: Study, found: Result) -> str:
    """What the table says to the question, in a sentence; where the study has no words for it, plain ranges."""
    if study.answer is None:
        return plain_answer(found.table)
    return called(f"answer {study.answer}", imported(study.answer, "answer"), str, found.table)


def summary(study: Study, found: Result) -> pd.DataFrame:
    """The few columns and rows that answer the question."""
    return study.summary.of(found.table)
