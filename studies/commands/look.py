"""What there is to run, and what a study file would do."""

from pathlib import Path
from typing import Annotated

import numpy as np
import typer

from studies import catalogue, engine
from studies.commands.terminal import console, one_line_errors
from studies.design import Point, methods
from studies.scene_picture import scene_picture
from studies.study import Study
from studies.swath import Swath


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


def check(
    file: Annotated[str, typer.Argument(help="A study file, or the name of a shipped study.")],
    picture: Annotated[Path | None, typer.Argument(help="Of --plot, the file; NAME.png by default.")] = None,
    plot: Annotated[bool, typer.Option("--plot", help="Make a picture of the scene, of the first point.")] = False,
) -> None:
    """Check a study file, and say what it would run; of a scene, how it would be simulated."""
    with one_line_errors():
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
