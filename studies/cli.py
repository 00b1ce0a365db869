"""The command `twinecho`."""

import sys
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import fields, replace
from difflib import get_close_matches
from itertools import chain, count
from pathlib import Path
from time import perf_counter
from typing import Annotated, Any, get_args, get_origin, get_type_hints

import pandas as pd
import typer
from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn, TimeRemainingColumn

from studies import engine, manifest
from studies import report as results
from studies.catalogue import STUDIES
from studies.study import Study
from studies.table import tabulate

app = typer.Typer(no_args_is_help=True, add_completion=False, rich_markup_mode=None, pretty_exceptions_enable=False)
console = Console(highlight=False)


@app.callback()
def twinecho() -> None:
    """Monte Carlo studies of absolute delay estimation in interferometric synthetic aperture sonar."""


@app.command("list")
def list_studies() -> None:
    """List the shipped studies, their parameters and their estimators."""
    for name, make in STUDIES.items():
        study = make()
        console.print(f"{name}: {study.question}")
        console.print(f"  estimators: {', '.join(study.methods())}")
        for field in fields(study):
            console.print(f"  --set {field.name}={_text(getattr(study, field.name))}")


@app.command()
def run(
    names: Annotated[list[str], typer.Argument(help="Names of studies; see `twinecho list`.")],
    quick: Annotated[bool, typer.Option(help="A smaller sweep for a first look.")] = False,
    estimator: Annotated[list[str] | None, typer.Option(help="Only this estimator; may be repeated.")] = None,
    setting: Annotated[
        list[str] | None, typer.Option("--set", help="A parameter, as KEY=VALUE; may be repeated.")
    ] = None,
    trials: Annotated[int | None, typer.Option(help="Trials at each design point.")] = None,
    jobs: Annotated[int, typer.Option(help="Blocks at a time; -1 for one a processor.")] = -1,
    backend: Annotated[str, typer.Option(help="loky, threading, sequential or dask.")] = "loky",
    scheduler: Annotated[str | None, typer.Option(help="Address of a Dask scheduler, for --backend dask.")] = None,
    seed: Annotated[int, typer.Option(help="Root of all random numbers.")] = 2026,
    out: Annotated[Path, typer.Option(help="Folder for the results.")] = Path("out"),
    fail_fast: Annotated[bool, typer.Option("--fail-fast", help="End at the first estimate that fails.")] = False,
    fresh: Annotated[bool, typer.Option("--fresh", help="Start anew beside an earlier run.")] = False,
) -> None:
    """Run studies, or go on with an earlier run: OUT/NAME/ gets the blocks, the table, the figures and the manifest."""
    with _one_line_errors():
        values = dict(_key_and_value(text) for text in setting or [])
        if trials is not None:
            values["trials"] = str(trials)
        studies = [configured(name, quick, values) for name in names]
        how = engine.Run(
            methods=tuple(estimator or ()),
            seed=seed,
            jobs=jobs,
            backend=backend,
            scheduler=scheduler,
            fail_fast=fail_fast,
        )
        for study in studies:
            engine.check(study, how)
        for study in studies:
            folder = _free(out / study.name) if fresh else out / study.name
            _run_with_progress(study, how, folder)
            _report(study, how.methods or tuple(study.methods()), how.seed, folder)


@app.command()
def status(folder: Annotated[Path, typer.Argument(help="Folder of a run.")]) -> None:
    """Count the blocks of a run that are there, missing and hold failures, for each design point."""
    with _one_line_errors():
        study, methods, seed = _earlier(folder)
        store = engine.store_of(study, seed, folder)
        rows = []
        for task in engine.tasks(study):
            found = store.read(task)
            rows.append(
                {
                    **task.point,
                    "there": not engine.missing(store, task, methods),
                    "missing": bool(engine.missing(store, task, methods)),
                    "failures": sum(measurement.failures for measurement in found),
                }
            )
        table = pd.DataFrame(rows)
        counted = table.groupby(list(study.points()[0]), dropna=False, sort=False).sum().reset_index()
        console.print(counted.to_string(index=False), soft_wrap=True)
        console.print(f"{int(table.there.sum())} of {len(table)} blocks are there")


@app.command()
def report(folder: Annotated[Path, typer.Argument(help="Folder of a run.")]) -> None:
    """Make table and figures of a run anew from its block files."""
    with _one_line_errors():
        study, methods, seed = _earlier(folder)
        _report(study, methods, seed, folder)


@app.command()
def replay(
    folder: Annotated[Path, typer.Argument(help="Folder of a run.")],
    point: Annotated[int, typer.Argument(help="Number of the design point, from 0.")],
    block: Annotated[int, typer.Argument(help="Number of the block, from 0.")],
) -> None:
    """Measure one block of a run again, in the foreground, and show what it gives."""
    with _one_line_errors():
        study, methods, seed = _earlier(folder)
        points = study.points()
        if not 0 <= point < len(points):
            raise ValueError(f"point is {point}; it must lie between 0 and {len(points) - 1}")
        of_point = [task for task in engine.tasks(study) if task.point == points[point]]
        if not 0 <= block < len(of_point):
            raise ValueError(f"block is {block}; it must lie between 0 and {len(of_point) - 1}")
        found = engine.measure(study, of_point[block], methods, seed).measurements
        table = tabulate([(points[point], [found])])
        for measurement in found:
            if measurement.failure:
                console.print(f"{' '.join(measurement.labels.values())}: {measurement.failure}", soft_wrap=True)
        labels = [column for measurement in found[:1] for column in measurement.labels]
        shown = table[[*labels, "trials", "failures", "wrap_errors", "delay_bias", "delay_std_in_wrap", "rmse"]]
        console.print(shown.to_string(index=False, float_format="{:.6g}".format), soft_wrap=True)


def _earlier(folder: Path) -> tuple[Study, tuple[str, ...], int]:
    """Study, estimators and seed of an earlier run."""
    found = manifest.read(folder)
    name = found["design"]["study"]
    study = manifest.restored(_known(name), found["parameters"])
    return study, tuple(found["methods"]), int(found["design"]["seed"])


def _free(folder: Path) -> Path:
    """The folder, or the first of its name with a number that does not exist."""
    numbered = (folder.with_name(f"{folder.name}-{number}") for number in count(2))
    return next(path for path in chain([folder], numbered) if not path.exists())


def _known(name: str) -> type[Study]:
    if name not in STUDIES:
        near = get_close_matches(name, STUDIES)
        hint = f"; did you mean {near[0]}?" if near else ""
        raise ValueError(f"study is {name!r}; it must be one of {', '.join(STUDIES)}{hint}")
    return STUDIES[name]


def configured(name: str, quick: bool, values: Mapping[str, str]) -> Study:
    """A shipped study with some parameters set from text.

    Raises
    ------
    ValueError
        For an unknown study or parameter, and for a value that it does not take.
    """
    study = _known(name)()
    study = study.quick() if quick else study
    types = get_type_hints(type(study))
    known = [field.name for field in fields(study)]
    for key in values:
        if key not in known:
            raise ValueError(f"parameter is {key!r}; of {name} it must be one of {', '.join(known)}")
    changes = {key: _parsed(key, text, types[key]) for key, text in values.items()}
    changed: Study = replace(study, **changes)
    return changed


def _key_and_value(text: str) -> tuple[str, str]:
    key, separator, value = text.partition("=")
    if not separator:
        raise ValueError(f"--set is {text!r}; it must be KEY=VALUE")
    return key, value


def _parsed(key: str, text: str, kind: Any) -> Any:
    if get_origin(kind) is tuple:
        return tuple(_parsed(key, part, get_args(kind)[0]) for part in text.split(","))
    try:
        return kind(text)
    except ValueError:
        wanted = "a whole number" if kind is int else "a number"
        raise ValueError(f"{key} is {text!r}; it must be {wanted}") from None


def _text(value: Any) -> str:
    return ",".join(f"{part:g}" for part in value) if isinstance(value, tuple) else f"{value:g}"


def _run_with_progress(study: Study, how: engine.Run, folder: Path) -> None:
    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        MofNCompleteColumn(),
        TimeElapsedColumn(),
        TimeRemainingColumn(),
    )
    terminal = Console(stderr=True)
    if not terminal.is_terminal:
        engine.run(study, how, folder, _Lines(study.name))
        return
    with Progress(*columns, console=terminal) as bar:
        task = bar.add_task(study.name)
        engine.run(study, how, folder, lambda done, total: bar.update(task, completed=done, total=total))


class _Lines:
    """Progress as a plain line for each tenth of the blocks, with the time that the rest will take."""

    def __init__(self, name: str) -> None:
        self.name, self.start, self.first, self.shown = name, perf_counter(), -1, -1

    def __call__(self, done: int, total: int) -> None:
        tenth = 10 * done // total
        self.first = done if self.first < 0 else self.first
        if tenth == self.shown:
            return
        self.shown = tenth
        seconds = perf_counter() - self.start
        left = f", {seconds * (total - done) / (done - self.first):.0f} s left" if done > self.first else ""
        print(f"{self.name}: {done} of {total} blocks in {seconds:.0f} s{left}", file=sys.stderr, flush=True)


def _report(study: Study, methods: tuple[str, ...], seed: int, folder: Path) -> None:
    """Write table and figures of what a folder holds; show a short table and the paths."""
    found = results.result(study, engine.store_of(study, seed, folder), methods)
    paths = [folder / manifest.NAME, *results.write(study, found, folder)]
    console.print(f"\n{study.name}: {study.question}", soft_wrap=True)
    short = study.summary(found.table)
    console.print(short.to_string(index=False, float_format="{:.3g}".format), soft_wrap=True)
    for path in paths:
        console.print(str(path), soft_wrap=True)


@contextmanager
def _one_line_errors() -> Iterator[None]:
    try:
        yield
    except (ValueError, OSError) as error:
        print(f"twinecho: {' '.join(str(error).split())}", file=sys.stderr)
        raise typer.Exit(2) from None


def main() -> None:
    """Run the command line."""
    app()
