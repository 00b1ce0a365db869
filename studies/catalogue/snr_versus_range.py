"""Paper B's figure 2, and the scattering strength behind it with the handbook's own points."""

from importlib import resources

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from sim import SEDIMENTS, scattering_strength
from sim.scattering import Model
from studies import figures
from studies.drawing import Examples

MODELS: tuple[Model, ...] = ("small-slope", "apl-uw")


def answer(table: pd.DataFrame) -> str:
    """By how much each seabed's SNR varies over the swath, and where it ends."""
    said = []
    for model in pd.unique(table.scattering):
        rows = table[table.scattering == model]
        spans = rows.groupby("sediment", sort=False).snr_db.agg(lambda snr: snr.max() - snr.min())
        ends = rows[rows.ground_range == rows.ground_range.max()].set_index("sediment").snr_db
        each = ", ".join(f"{name} {span:.0f} dB (to {ends[name]:.1f} dB)" for name, span in spans.items())
        said.append(f"{model}: {each}")
    far = table.ground_range.max()
    return f"Over the swath the SNR varies, and ends at {far:g} m, by {'; '.join(said)}."


def snr(table: pd.DataFrame, examples: Examples) -> Figure:
    """SNR over ground range, a panel for each scattering model and a line for each seabed."""
    models = list(pd.unique(table.scattering))
    figure, axes = figures.grid(1, len(models), width=4.8, height=3.6)
    for panel, model in zip(axes[0], models, strict=True):
        rows = table[table.scattering == model]
        for number, (name, line) in enumerate(rows.groupby("sediment", sort=False)):
            style = figures.LINES[number - 1] if number else "-"
            panel.plot(line.ground_range, line.snr_db, color=figures.COLOURS[number], linestyle=style, label=str(name))
        panel.set_title(model, fontsize=10)
        panel.set_xlabel("ground range [m]")
    axes[0][0].set_ylabel("SNR [dB]")
    handles, labels = axes[0][0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=4, fontsize=9)
    return figure


def strength(table: pd.DataFrame, examples: Examples) -> Figure:
    """Scattering strength over grazing angle of both models, and the handbook's table for the first."""
    with resources.files(__package__).joinpath("tr9407.csv").open() as file:
        handbook = pd.read_csv(file)
    cases = list(handbook.groupby(["sediment", "frequency_khz"], sort=False))
    figure, axes = figures.grid(1, len(cases), width=3.4, height=3.4)
    angle = np.linspace(0.5, 90.0, 359)
    for panel, (_, points) in zip(axes[0], cases, strict=True):
        name, kilohertz = str(points.sediment.iloc[0]), float(points.frequency_khz.iloc[0])
        sediment = SEDIMENTS[name]
        volume = points.volume_parameter_override.iloc[0]
        as_tabulated = sediment if np.isnan(volume) else sediment.adjusted(volume_parameter=float(volume))
        for number, (model, bed) in enumerate(zip(MODELS, (sediment, as_tabulated), strict=True)):
            level = scattering_strength(bed, angle, kilohertz * 1e3, model=model, sound_speed=1528.0)
            panel.plot(angle, level, color=figures.COLOURS[number], linestyle=("--", "-")[number], label=model)
        panel.plot(points.grazing_deg, points.strength_db, "o", color="black", markersize=3.5, label="TR 9407, table")
        panel.set_title(f"{name}, {kilohertz:g} kHz", fontsize=10)
        panel.set_xlabel("grazing angle [degrees]")
        panel.set_ylim(-62, 5)
    axes[0][0].set_ylabel("scattering strength [dB]")
    handles, labels = axes[0][0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=3, fontsize=9)
    return figure
