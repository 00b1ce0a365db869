"""The conformance suite for an estimator of one's own."""

from typing import Annotated

import numpy as np
import typer

from estimators.conformance import distinct, examined
from studies.commands.terminal import console, one_line_errors
from studies.estimate_file import fixed_window
from studies.method import EstimatorSection, Method

MOST_PIXELS = 10_000
"""Of a window, so that trying it takes seconds."""


def check_estimator(
    estimator: Annotated[str, typer.Argument(help="module:object, the name of an entry point, or a shipped class.")],
    window: Annotated[str, typer.Option(help="What it averages over, as ROWSxSAMPLES.")] = "3x33",
) -> None:
    """Try what every estimator must do on one; say what fails. Exit status 0 where nothing does, 1 where something."""
    with one_line_errors():
        size = fixed_window(window)
        if size.pixels > MOST_PIXELS:
            raise ValueError(f"window has {size.pixels} pixels; it must have {MOST_PIXELS} at the most")
        made = Method(EstimatorSection(name="checked", method=estimator), size).build(np.random.default_rng(0))
    shape = max(9, size.rows), max(256, 2 * size.samples)
    tried = examined(made, shape=shape, window=size)
    found = distinct(tried)
    for said in found:
        console.print(" ".join(said.split()), soft_wrap=True)
    counted = f"{len(found)} findings" if len(found) != 1 else "1 finding"
    where = f"with a window of {size} pixels, on {shape[0]} x {shape[1]} samples of simulated speckle"
    console.print(f"{estimator}: {counted}, {where}. Checked: {', '.join(tried)}.", soft_wrap=True)
    if found:
        raise typer.Exit(1)
