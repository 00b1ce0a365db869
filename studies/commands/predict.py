"""What a sonar delivers over range, from theory."""

from pathlib import Path
from typing import Annotated

import numpy as np
import pandas as pd
import typer

from estimators.pixels import Pixels
from sim import checks
from studies import prediction
from studies.commands.terminal import console, one_line_errors
from studies.swath_figure import swath_figure


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
    with one_line_errors():
        seabeds: list[str | None] = [None] if coherence is not None else list(sediment or ["coarse sand"])
        if coherence is not None and sediment:
            raise ValueError("coherence and sediment are both given; it must be one of them")
        checks.within("near", near, 0.0, 1e6, "m")
        checks.within("far", far, near, 1e6, "m")
        checks.within("ranges", ranges, 1, 1e6)
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
