"""Paper B's figures 3, 4 and 9, images of the seabed, from what the blocks of a strip have stored."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.collections import QuadMesh
from matplotlib.figure import Figure

from sim.band import Real
from studies import figures
from studies.catalogue.long_range import ADAPTIVE, FIXED, short
from studies.drawing import Examples, Traces

BEFORE = 41
"""Columns of an image over which its level is taken away."""


def image(table: pd.DataFrame, examples: Examples) -> Figure:
    """Figure 3: image intensity over its level at that range, 40 dB of it."""
    figure, panels = _maps(examples, 1)
    for line, (varied, found) in zip(panels, examples, strict=True):
        level = 10 * np.log10(np.maximum(found["intensity"], 1e-12))
        level -= pd.Series(np.median(level, axis=0)).rolling(BEFORE, center=True, min_periods=1).median().to_numpy()
        shown = _map(line[0], found, level, (-25, 15), "gray")
        line[0].set_title(f"{_name(varied)} SNR", fontsize=10)
        figure.colorbar(shown, ax=line[0], label="intensity over its median [dB]", pad=0.01)
    return figure


def average_depth(table: pd.DataFrame, examples: Examples) -> Figure:
    """Figure 4: depth over range, averaged along track and over 1 m, with 25 m of it beside a single line."""
    figure, axes = figures.grid(len(examples), 1, width=8.0, height=3.2)
    for (panel,), (varied, found) in zip(axes, examples, strict=True):
        ground, heights = found["ground range"], found[f"phase {FIXED}"]
        for label, values, colour in (("estimated", heights, 0), ("true", found["truth"], 1)):
            middles, mean = _per_metre(ground, values)
            panel.plot(middles, mean, color=figures.COLOURS[colour], linewidth=1, label=label, zorder=3 - colour)
        panel.set(ylim=(-0.6, 0.6), ylabel="height [m]")
        panel.set_title(f"{_name(varied)} SNR", fontsize=10)
        inset = panel.inset_axes((0.08, 0.62, 0.4, 0.33))
        near = (ground >= 100) & (ground < 125)
        middles, mean = _per_metre(ground[near], heights[:, near])
        inset.plot(ground[near], heights[len(heights) // 2, near], color="red", linewidth=0.7, label="single line")
        inset.plot(middles, mean, color=figures.COLOURS[0], linewidth=1.2)
        inset.tick_params(labelsize=7)
        inset.set_xlim(100, 125)
        panel.plot([], [], color="red", linewidth=0.7, label="single line (inset)")
        panel.legend(loc="lower left", fontsize=8, ncols=3)
    axes[-1][0].set_xlabel("ground range [m]")
    return figure


def depth_maps(table: pd.DataFrame, examples: Examples) -> Figure:
    """Figure 9: depth with the fixed window and the adaptive one, 1 m of it."""
    windows = (FIXED, ADAPTIVE)
    figure, panels = _maps(examples, len(windows))
    for line, (varied, found) in zip(panels, examples, strict=True):
        for panel, window in zip(line, windows, strict=True):
            shown = _map(panel, found, found[f"phase {window}"], (-0.5, 0.5), "viridis")
            panel.set_title(f"{_name(varied)} SNR, {short(window)}", fontsize=10)
        figure.colorbar(shown, ax=line, label="height [m]", pad=0.01)
    return figure


def _name(varied: Mapping[str, Any]) -> str:
    return "modelled" if "scene.sediment" in varied else "paper"


def _per_metre(ground: Real, values: Real) -> tuple[Real, Real]:
    """Mean of an image over rows and each metre of ground range."""
    metre = np.floor(ground).astype(int)
    middles = np.unique(metre)
    known = np.isfinite(values)
    total, count = (
        np.bincount(metre - middles[0], array.sum(axis=0)) for array in (np.where(known, values, 0.0), known)
    )
    with np.errstate(invalid="ignore"):
        return middles + 0.5, (total / count)[middles - middles[0]]


def _maps(examples: Examples, columns: int) -> tuple[Figure, Sequence[Sequence[Axes]]]:
    figure, axes = figures.grid(len(examples), columns, width=8.0 / columns, height=2.4)
    for line in axes:
        line[0].set_ylabel("along track [m]")
        for panel in line:
            panel.grid(False)
    for panel in axes[-1]:
        panel.set_xlabel("ground range [m]")
    return figure, axes


def _map(panel: Axes, found: Traces, values: Real, limits: tuple[float, float], colours: str) -> QuadMesh:
    along = (np.arange(len(values)) + 0.5) * found["row extent"][0]
    return panel.pcolormesh(
        found["ground range"],
        along,
        values,
        vmin=limits[0],
        vmax=limits[1],
        cmap=colours,
        shading="nearest",
        rasterized=True,
    )
