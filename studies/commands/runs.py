"""Runs of studies: to start, go on with, look at, repeat in part and join."""

import sys
from itertools import chain, count
from pathlib import Path
from typing import Annotated, Any

import typer

from studies import catalogue, engine, manifest, report, shards
from studies.commands.terminal import console, one_line_errors, toml_value
from studies.progress import progress
from studies.replay import one_block, one_trial
from studies.status import status as status_of
from studies.study import Study

Folder = Annotated[Path, typer.Argument(help="Folder of a run.")]


def run(
    names: Annotated[list[str], typer.Argument(help="Names of shipped studies (see `twinecho list`), or study files.")],
    quick: Annotated[bool, typer.Option("--quick", help="A smaller sweep for a first look.")] = False,
    estimator: Annotated[list[str] | None, typer.Option(help="Only this estimator; may be repeated.")] = None,
    setting: Annotated[
        list[str] | None,
        typer.Option(
            "--set", help="Another value, as KEY=VALUE, in SI units, or more of them along an axis; may be repeated."
        ),
    ] = None,
    trials: Annotated[int | None, typer.Option(help="Trials at each design point, at the most.")] = None,
    jobs: Annotated[int, typer.Option(help="Blocks at a time; -1 for one a processor.")] = -1,
    backend: Annotated[str, typer.Option(help="loky, threading, sequential or dask.")] = "loky",
    scheduler: Annotated[str | None, typer.Option(help="Address of a Dask scheduler, for --backend dask.")] = None,
    seed: Annotated[int, typer.Option(help="Root of all random numbers.")] = 2026,
    out: Annotated[Path, typer.Option(help="Folder for the results.")] = Path("out"),
    shard: Annotated[str, typer.Option(help="Only the K-th of N parts, as K/N, into a folder of its own.")] = "1/1",
    fail_fast: Annotated[bool, typer.Option("--fail-fast", help="End at the first estimate that fails.")] = False,
    fresh: Annotated[bool, typer.Option("--fresh/--resume", help="Start anew beside an earlier run.")] = False,
) -> None:
    """Run studies, or go on with an earlier run: OUT/NAME/ gets the blocks, the tables, the figures and the report."""
    with one_line_errors():
        values = dict(key_and_value(text) for text in setting or [])
        if trials is not None:
            values["trials.count"] = trials
        studies = [_configured(name, quick, values, estimator or []) for name in names]
        share = shards.parsed(shard)
        how = engine.Run(seed=seed, jobs=jobs, backend=backend, scheduler=scheduler, fail_fast=fail_fast, share=share)
        for study in studies:
            engine.check(study)
        for study in studies:
            name = study.name if share.of == 1 else f"{study.name}-shard-{share.number}-of-{share.of}"
            folder = _free(out / name) if fresh else out / name
            with progress(study.name, "blocks") as show:
                engine.run(study, how, folder, show)
            _report(folder)


def status(folder: Folder) -> None:
    """Count the blocks of a run that are there, missing and hold failures, for each design point."""
    with one_line_errors():
        table = status_of(*manifest.study_of(folder), folder)
        console.print(table.to_string(index=False), soft_wrap=True)
        console.print(f"{table.there.sum()} of {(table.there + table.missing).sum()} blocks are there")


def report_again(folder: Folder) -> None:
    """Make the tables, figures and page of a run anew from its block files."""
    with one_line_errors():
        _report(folder)


def replay(
    folder: Folder,
    point: Annotated[int, typer.Argument(help="Number of the design point, from 0.")],
    block: Annotated[int, typer.Argument(help="Number of the block, from 0.")],
    trial: Annotated[int | None, typer.Argument(help="Number of the trial in the block, from 0.")] = None,
) -> None:
    """Measure one block of a run again, in the foreground, and show what it gives, or what one of its trials gives."""
    with one_line_errors():
        study, seed = manifest.study_of(folder)
        table = one_block(study, seed, point, block) if trial is None else one_trial(study, seed, point, block, trial)
        console.print(table.to_string(index=False, float_format="{:.6g}".format), soft_wrap=True)


def merge(
    folder: Annotated[Path, typer.Argument(help="Folder for the whole run.")],
    parts: Annotated[list[Path], typer.Argument(help="Folders of its shards.")],
) -> None:
    """Join shards of a run into one folder, and list what is missing."""
    with one_line_errors():
        missing = shards.merge(folder, parts)
        _report(folder)
        if missing.empty:
            console.print("nothing is missing")
        else:
            console.print(f"{len(missing)} blocks are missing:")
            console.print(missing.head(20).to_string(index=False), soft_wrap=True)
            if len(missing) > 20:
                console.print("...")


def _configured(name: str, quick: bool, values: dict[str, Any], estimators: list[str]) -> Study:
    study = catalogue.study(name)
    study = study.for_a_first_look() if quick else study
    return study.with_values(values).of_estimators(estimators)


def key_and_value(text: str) -> tuple[str, Any]:
    """Key and value, or values, of an option --set."""
    key, separator, value = text.partition("=")
    if not separator:
        raise ValueError(f"--set is {text!r}; it must be KEY=VALUE")
    parts = [value] if value.startswith(("[", "{")) else [part.strip() for part in value.split(",")]
    values = [toml_value(part) for part in parts]
    return key, values[0] if len(values) == 1 else values


def _free(folder: Path) -> Path:
    """The folder, or the first of its name with a number that does not exist."""
    numbered = (folder.with_name(f"{folder.name}-{number}") for number in count(2))
    return next(path for path in chain([folder], numbered) if not path.exists())


def _report(folder: Path) -> None:
    """Write what a folder's blocks give; show a short table and the paths."""
    study, seed = manifest.study_of(folder)
    found = report.result(study, engine.store_of(study, seed, folder))
    paths = [folder / manifest.NAME, *report.write(study, found, folder)]
    console.print(f"\n{study.name}: {study.question}", soft_wrap=True)
    short = report.summary(study, found)
    console.print(short.to_string(index=False, float_format="{:.3g}".format), soft_wrap=True)
    said = report.answer(study, found)
    if said:
        console.print(said, soft_wrap=True)
    for text in found.warnings:
        print(f"twinecho: warning: {text}", file=sys.stderr)
    for path in paths:
        console.print(str(path), soft_wrap=True)
