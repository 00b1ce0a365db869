"""Run a study: blocks of trials, in parallel, into a table and figures."""

import json
import os
import platform
from collections.abc import Callable, Iterator, Sequence
from dataclasses import asdict, dataclass, fields
from importlib import metadata
from pathlib import Path
from typing import Any

import pandas as pd
from joblib import Parallel, delayed

from studies import seeds
from studies.study import Block, Point, Study
from studies.table import tabulate

BACKENDS = ("loky", "threading", "sequential")


@dataclass(frozen=True)
class Run:
    """How to run a study.

    Attributes
    ----------
    methods
        Names of the estimators to compare; all of the study's where empty.
    seed
        Root of all random numbers.
    jobs
        Blocks at a time; as joblib counts them.
    backend
        One of joblib's, of `BACKENDS`.
    """

    methods: tuple[str, ...] = ()
    seed: int = 2026
    jobs: int = -1
    backend: str = "loky"


@dataclass(frozen=True, eq=False)
class Result:
    """A finished study: its table, and an example of each design point."""

    table: pd.DataFrame
    traces: Sequence[tuple[Point, dict[str, Any]]]


def tasks(study: Study) -> list[tuple[Point, int, int]]:
    """All blocks of a study: design point, number of the block, trials in it."""
    starts = range(0, study.trials, study.block_trials)
    return [
        (point, number, min(study.block_trials, study.trials - start))
        for point in study.points()
        for number, start in enumerate(starts)
    ]


def check(study: Study, how: Run) -> tuple[str, ...]:
    """Names of the estimators that a run compares; ValueError for an unknown estimator or backend, or a bad seed."""
    known = tuple(study.methods())
    for name in how.methods:
        if name not in known:
            raise ValueError(f"estimator is {name!r}; of {study.name} it must be one of {', '.join(known)}")
    if how.backend not in BACKENDS:
        raise ValueError(f"backend is {how.backend!r}; it must be one of {', '.join(BACKENDS)}")
    seeds.check(how.seed)
    if how.jobs == 0:
        raise ValueError("jobs is 0; it must be 1 or more, or -1 for one a processor")
    return how.methods or known


def run(study: Study, how: Run, progress: Callable[[int, int], None] = lambda done, total: None) -> Result:
    """Simulate and estimate all blocks of a study, and tabulate their errors.

    The table depends on the study, its estimators and the seed alone, but for the measured times.

    Parameters
    ----------
    study
        What to run.
    how
        Which estimators, which seed, on how many processes.
    progress
        Called with the number of blocks done and in all.

    Raises
    ------
    ValueError
        For an unknown estimator or backend, and for whatever the study finds wrong.
    """
    methods = check(study, how)
    todo = tasks(study)
    blocks: list[Block] = []
    progress(0, len(todo))
    for block in _blocks(study, methods, how, todo):
        blocks.append(block)
        progress(len(blocks), len(todo))
    together: dict[str, tuple[Point, list[Block]]] = {}
    for (point, _, _), block in zip(todo, blocks, strict=True):
        together.setdefault(json.dumps(point, sort_keys=True), (point, []))[1].append(block)
    table = tabulate((point, [b.measurements for b in found]) for point, found in together.values())
    return Result(table, [(point, dict(found[0].traces)) for point, found in together.values()])


def _blocks(study: Study, methods: Sequence[str], how: Run, todo: Sequence[tuple[Point, int, int]]) -> Iterator[Block]:
    threads = {"inner_max_num_threads": 1} if how.backend == "loky" else {}
    parallel = Parallel(n_jobs=how.jobs, backend=how.backend, return_as="generator", **threads)
    found: Iterator[Block] = parallel(
        delayed(study.measure)(point, methods, trials, seeds.generator(how.seed, point, number))
        for point, number, trials in todo
    )
    return found


def write(study: Study, how: Run, result: Result, folder: Path) -> list[Path]:
    """Write manifest, table and figures of a study; returns their paths.

    Raises
    ------
    OSError
        Where the folder cannot be written.
    """
    figures = folder / "figures"
    figures.mkdir(parents=True, exist_ok=True)
    manifest = folder / "manifest.json"
    manifest.write_text(json.dumps(provenance(study, how), indent=2) + "\n")
    table = folder / "table.csv"
    result.table.to_csv(table, index=False)
    paths = [manifest, table]
    for name, figure in study.figures(result.table, result.traces).items():
        paths.append(figures / f"{name}.png")
        figure.savefig(paths[-1], dpi=150)
    return paths


def provenance(study: Study, how: Run) -> dict[str, Any]:
    """What made a result: the study and its parameters, the run, the versions and the machine."""
    return {
        "study": study.name,
        "question": study.question,
        "parameters": {field.name: getattr(study, field.name) for field in fields(study)},
        "run": asdict(how),
        "versions": {name: metadata.version(name) for name in ("twinecho", "numpy", "scipy", "finufft", "joblib")},
        "python": platform.python_version(),
        "machine": f"{platform.machine()}, {os.cpu_count()} processors",
    }
