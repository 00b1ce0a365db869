"""The command `twinecho`."""

import os
import sys
import tomllib
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from itertools import chain, count
from pathlib import Path
from typing import Annotated, Any

import numpy as np
import pandas as pd
import typer
from rich.console import Console

from estimators.pixels import Pixels
from sim import checks
from studies import catalogue, engine, manifest, prediction, report, shards
from studies.design import Point, methods
from studies.estimate_file import estimate_file
from studies.estimate_picture import estimate_picture
from studies.progress import progress
from studies.replay import one_block, one_trial
from studies.scene_picture import scene_picture
from studies.status import status as status_of
from studies.study import Study
from studies.swath import Swath
from studies.swath_figure import swath_figure

app = typer.Typer(no_args_is_help=True, add_completion=False, rich_markup_mode=None, pretty_exceptions_enable=False)
console = Console(highlight=False, markup=False)

Folder = Annotated[Path, typer.Argument(help="Folder of a run.")]


@app.callback()
def twinecho() -> None:
    """Monte Carlo studies of absolute delay estimation in interferometric synthetic aperture sonar."""


@app.command("list")
def list_studies() -> None:
    """List the shipped studies with their estimators and axes."""
    for name in catalogue.NAMES:
        study = catalogue.study(name)
        console.print(f"{name}: {study.question}", soft_wrap=True)
        if study.estimators:
            console.print(f"  estimators: {', '.join(section.name for section in study.estimators)}", soft_wrap=True)
        for axis in study.axes:
            for key, values in axis.items():
                console.print(f"  --set {key}={','.join(str(value) for value in values)}", soft_wrap=True)
        console.print(f"  file: {catalogue.path_of(name)}", soft_wrap=True)


@app.command()
def check(
    file: Annotated[str, typer.Argument(help="A study file, or the name of a shipped study.")],
    picture: Annotated[Path | None, typer.Argument(help="Of --plot, the file; NAME.png by default.")] = None,
    plot: Annotated[bool, typer.Option("--plot", help="Make a picture of the scene, of the first point.")] = False,
) -> None:
    """Check a study file, and say what it would run; of a scene, how it would be simulated."""
    with _one_line_errors():
        if picture is not None and not plot:
            raise ValueError(f"{picture} is given without --plot; it must be with it")
        study = catalogue.study(file)
        design = engine.check(study)
        trials = study.trials
        console.print(f"{study.name}: {study.question}", soft_wrap=True)
        if not design:
            if plot:
                raise ValueError(f"{study.name} has no scene; --plot must be for one that has")
            return
        console.print(f"{len(design)} design points of up to {trials.count} trials, in blocks of {trials.block}")
        for method in methods(study, design[0]):
            console.print(f"  {' '.join(method.labels)}: {method.section.method}", soft_wrap=True)
        _show_plans(study, design)
        if plot:
            _plot(study, design[0], picture or Path(f"{study.name}.png"))


@app.command()
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
    with _one_line_errors():
        values = dict(_key_and_value(text) for text in setting or [])
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


@app.command()
def status(folder: Folder) -> None:
    """Count the blocks of a run that are there, missing and hold failures, for each design point."""
    with _one_line_errors():
        table = status_of(*manifest.study_of(folder), folder)
        console.print(table.to_string(index=False), soft_wrap=True)
        console.print(f"{table.there.sum()} of {(table.there + table.missing).sum()} blocks are there")


@app.command("report")
def report_again(folder: Folder) -> None:
    """Make the tables, figures and page of a run anew from its block files."""
    with _one_line_errors():
        _report(folder)


@app.command()
def replay(
    folder: Folder,
    point: Annotated[int, typer.Argument(help="Number of the design point, from 0.")],
    block: Annotated[int, typer.Argument(help="Number of the block, from 0.")],
    trial: Annotated[int | None, typer.Argument(help="Number of the trial in the block, from 0.")] = None,
) -> None:
    """Measure one block of a run again, in the foreground, and show what it gives, or what one of its trials gives."""
    with _one_line_errors():
        study, seed = manifest.study_of(folder)
        table = one_block(study, seed, point, block) if trial is None else one_trial(study, seed, point, block, trial)
        console.print(table.to_string(index=False, float_format="{:.6g}".format), soft_wrap=True)


@app.command()
def merge(
    folder: Annotated[Path, typer.Argument(help="Folder for the whole run.")],
    parts: Annotated[list[Path], typer.Argument(help="Folders of its shards.")],
) -> None:
    """Join shards of a run into one folder, and list what is missing."""
    with _one_line_errors():
        missing = shards.merge(folder, parts)
        _report(folder)
        if missing.empty:
            console.print("nothing is missing")
        else:
            console.print(f"{len(missing)} blocks are missing:")
            console.print(missing.head(20).to_string(index=False), soft_wrap=True)
            if len(missing) > 20:
                console.print("...")


@app.command()
def predict(
    sonar: Annotated[str, typer.Option(help="Name of a sonar.")] = "hisas-1032",
    sediment: Annotated[
        list[str] | None, typer.Option(help="Name of a seabed; may be repeated. Coarse sand where nothing is given.")
    ] = None,
    coherence: Annotated[float | None, typer.Option(help="The coherence instead of a seabed, 0 to 1.")] = None,
    window: Annotated[int, typer.Option(help="Side of the window [pixels].")] = 9,
    looks: Annotated[float | None, typer.Option(help="Independent looks in the window instead.")] = None,
    near: Annotated[float, typer.Option(help="Nearest ground range [m].")] = 40.0,
    far: Annotated[float, typer.Option(help="Furthest ground range [m].")] = 400.0,
    ranges: Annotated[int, typer.Option(help="How many ranges.")] = 361,
    pixel: Annotated[float, typer.Option(help="Side of a pixel [m].")] = 0.02,
    looks_per_pixel: Annotated[float, typer.Option(help="Independent looks in a pixel.")] = 0.4,
    kappa: Annotated[float, typer.Option(help="Size of the best window over its depth STD.")] = 2.0,
    most_wrap_errors: Annotated[float, typer.Option(help="Largest wrap-error rate of the best window.")] = 0.01,
    out: Annotated[Path, typer.Option(help="Folder for table and figure.")] = Path("out/predict"),
) -> None:
    """Say what to expect over ground range, without simulation: SNR, coherence, depth STD, wrap errors, best window."""
    with _one_line_errors():
        seabeds: list[str | None] = [None] if coherence is not None else list(sediment or ["coarse sand"])
        if coherence is not None and sediment:
            raise ValueError("coherence and sediment are both given; it must be one of them")
        checks.within("far", far, near, 1e6, "m")
        found = [
            prediction.predict(
                prediction.sonar_of(sonar),
                np.linspace(near, far, checks.count("ranges", ranges)),
                sediment=seabed,
                coherence=coherence,
                window=window,
                looks=looks,
                pixels=Pixels(along_track=pixel, range=pixel, looks=looks_per_pixel),
                kappa=kappa,
                most_wrap_errors=most_wrap_errors,
            ).assign(seabed=seabed or f"coherence {coherence:g}")
            for seabed in seabeds
        ]
        table = pd.concat(found, ignore_index=True)
        figure = swath_figure(table, f"{window} x {window} pixels" if looks is None else f"{looks:g} looks")
        out.mkdir(parents=True, exist_ok=True)
        table.to_csv(out / "table.csv", index=False)
        figure.savefig(out / "figure.png", dpi=150)
        short = table.groupby("seabed", sort=False).nth(list(range(0, ranges, max(1, ranges // 8))))
        short = short[["seabed", *(column for column in short.columns if column != "seabed")]]
        console.print(short.to_string(index=False, float_format="{:.3g}".format), soft_wrap=True)
        console.print(f"{out / 'table.csv'}\n{out / 'figure.png'}", soft_wrap=True)


@app.command()
def estimate(
    file: Annotated[Path, typer.Argument(help="A pair in netCDF, HDF5 or npz (docs/measured-data.md).")],
    estimator: Annotated[str, typer.Option(help="A class of estimators, or module:object.")] = "CrossCorrelation",
    window: Annotated[str, typer.Option(help="What to average over, as ROWSxSAMPLES.")] = "9x9",
    search: Annotated[float | None, typer.Option(help="Largest delay to look for [s].")] = None,
    out: Annotated[Path | None, typer.Option(help="File for the estimates; FILE-estimate.nc here by default.")] = None,
    block: Annotated[int | None, typer.Option(help="Rows at a time, rounded up to whole windows.")] = None,
) -> None:
    """Estimate delays of a measured pair, and depths where the file places it: OUT.nc, and OUT.png to look at."""
    with _one_line_errors():
        out = out or Path(f"{file.stem}-estimate.nc")
        options = {} if search is None else {"search": search}
        with progress(file.name, "rows") as show:
            said = estimate_file(file, estimator, window, out, options=options, block=block, progress=show)
        picture = out.with_suffix(".png")
        estimate_picture(out).savefig(picture, dpi=110)
        console.print(f"wrote {out} and {picture}: {said}", soft_wrap=True)


def _show_plans(study: Study, design: list[Point]) -> None:
    """The plan of every scene of a study, once for points of the same."""
    seen: list[str] = []
    for point in design:
        if isinstance(point.world, Swath):
            text = str(point.world.required(point.sonar, study.trials.block))
            if text not in seen:
                varied = ", ".join(f"{name} {value}" for name, value in point.columns.items())
                console.print(f"simulation of {study.trials.block} rows{f' at {varied}' if varied else ''}:")
                console.print(text, soft_wrap=True)
            seen.append(text)


def _plot(study: Study, point: Point, picture: Path) -> None:
    if not isinstance(point.world, Swath):
        raise ValueError(f"{study.name} has no scene; --plot must be for one that has")
    scene_picture(point.world, point.sonar, np.random.default_rng(2026)).savefig(picture, dpi=150)
    console.print(str(picture), soft_wrap=True)


def _configured(name: str, quick: bool, values: dict[str, Any], estimators: list[str]) -> Study:
    study = catalogue.study(name)
    study = study.for_a_first_look() if quick else study
    return study.with_values(values).of_estimators(estimators)


def _key_and_value(text: str) -> tuple[str, Any]:
    key, separator, value = text.partition("=")
    if not separator:
        raise ValueError(f"--set is {text!r}; it must be KEY=VALUE")
    parts = (
        [_parsed(part.strip()) for part in value.split(",")] if not value.startswith(("[", "{")) else [_parsed(value)]
    )
    return key, parts[0] if len(parts) == 1 else parts


def _parsed(text: str) -> Any:
    """A value as TOML reads it, or text where it does not."""
    try:
        return tomllib.loads(f"value = {text}")["value"]
    except tomllib.TOMLDecodeError:
        return text


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


@contextmanager
def _one_line_errors() -> Iterator[None]:
    try:
        yield
    except (ValueError, OSError, ImportError, OverflowError, MemoryError, RecursionError) as error:
        said = " ".join(str(error).split()) or f"{type(error).__name__}: a value is too large"
        print(f"twinecho: {said}", file=sys.stderr)
        raise typer.Exit(2) from None
    except KeyboardInterrupt:
        print("twinecho: stopped; what is finished of a run is stored, and the same command goes on", file=sys.stderr)
        raise typer.Exit(130) from None


def main() -> None:
    """Run the command line."""
    warnings.showwarning = _one_line_warning
    # What a study file names may lie beside it.
    sys.path.insert(0, os.getcwd())
    app()


def _one_line_warning(message: Warning | str, *_: object, **__: object) -> None:
    print(f"twinecho: warning: {' '.join(str(message).split())}", file=sys.stderr)
