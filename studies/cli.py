"""The command `twinecho`."""

import sys
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import fields, replace
from difflib import get_close_matches
from pathlib import Path
from typing import Annotated, Any, get_args, get_origin, get_type_hints

import pandas as pd
import typer
from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn, TimeRemainingColumn

from studies import engine
from studies.catalogue import STUDIES
from studies.study import Study

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
    backend: Annotated[str, typer.Option(help="loky, threading or sequential.")] = "loky",
    seed: Annotated[int, typer.Option(help="Root of all random numbers.")] = 2026,
    out: Annotated[Path, typer.Option(help="Folder for the results.")] = Path("out"),
) -> None:
    """Run studies: OUT/NAME/ gets the table, the figures and the manifest of each."""
    with _one_line_errors():
        values = dict(_key_and_value(text) for text in setting or [])
        if trials is not None:
            values["trials"] = str(trials)
        studies = [configured(name, quick, values) for name in names]
        how = engine.Run(methods=tuple(estimator or ()), seed=seed, jobs=jobs, backend=backend)
        for study in studies:
            engine.check(study, how)
        for study in studies:
            result = _with_progress(study, how)
            paths = engine.write(study, how, result, out / study.name)
            _show(study, result.table)
            for path in paths:
                console.print(str(path), soft_wrap=True)


def configured(name: str, quick: bool, values: Mapping[str, str]) -> Study:
    """A shipped study with some parameters set from text.

    Raises
    ------
    ValueError
        For an unknown study or parameter, and for a value that it does not take.
    """
    if name not in STUDIES:
        near = get_close_matches(name, STUDIES)
        hint = f"; did you mean {near[0]}?" if near else ""
        raise ValueError(f"study is {name!r}; it must be one of {', '.join(STUDIES)}{hint}")
    study = STUDIES[name]()
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


def _with_progress(study: Study, how: engine.Run) -> engine.Result:
    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        MofNCompleteColumn(),
        TimeElapsedColumn(),
        TimeRemainingColumn(),
    )
    with Progress(*columns, console=Console(stderr=True)) as bar:
        task = bar.add_task(study.name)
        return engine.run(study, how, lambda done, total: bar.update(task, completed=done, total=total))


def _show(study: Study, table: pd.DataFrame) -> None:
    console.print(f"\n{study.name}: {study.question}", soft_wrap=True)
    short = study.summary(table)
    console.print(short.to_string(index=False, float_format="{:.3g}".format), soft_wrap=True)


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
