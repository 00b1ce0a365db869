"""Estimates of a measured pair."""

from pathlib import Path
from typing import Annotated, Any

import typer

from studies.commands.terminal import console, one_line_errors, toml_value
from studies.estimate_file import estimate_file
from studies.estimate_picture import estimate_picture
from studies.options import searching_to
from studies.progress import progress


def estimate(
    file: Annotated[Path, typer.Argument(help="A pair in netCDF, HDF5 or npz (docs/measured-data.md).")],
    estimator: Annotated[
        str, typer.Option(help="A class of estimators, an entry point, or module:object.")
    ] = "CrossCorrelation",
    window: Annotated[str, typer.Option(help="What to average over, as ROWSxSAMPLES.")] = "9x9",
    search: Annotated[float | None, typer.Option(help="Largest delay to look for [s].")] = None,
    option: Annotated[
        list[str] | None,
        typer.Option(help="Another option of the estimator, as NAME=VALUE, written as in a study; may be repeated."),
    ] = None,
    out: Annotated[Path | None, typer.Option(help="File for the estimates; FILE-estimate.nc here by default.")] = None,
    block: Annotated[int | None, typer.Option(help="Rows at a time, rounded up to whole windows.")] = None,
) -> None:
    """Estimate delays of a measured pair, and depths where the file places it: OUT.nc, and OUT.png to look at."""
    with one_line_errors():
        out = out or Path(f"{file.stem}-estimate.nc")
        options = {**searching_to(estimator, search), **dict(_name_and_value(text) for text in option or [])}
        with progress(file.name, "rows") as show:
            said = estimate_file(file, estimator, window, out, options=options, block=block, progress=show)
        picture = out.with_suffix(".png")
        estimate_picture(out).savefig(picture, dpi=110)
        console.print(f"wrote {out} and {picture}: {said}", soft_wrap=True)


def _name_and_value(text: str) -> tuple[str, Any]:
    name, separator, value = text.partition("=")
    if not (name and separator):
        raise ValueError(f"--option is {text!r}; it must be NAME=VALUE")
    return name, toml_value(value)
