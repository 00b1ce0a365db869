"""Figures of cost against error: every setting a point, those that no other beats filled and numbered."""

from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from studies import figures
from studies.drawing import Examples

NANO = 1e9

COLOURS = (*figures.COLOURS, "#000000")
MARKERS = (*figures.MARKERS, "X")
"""One for each of the seven methods."""

LEAST_RATE = 1e-5
"""Where points stand at which no wrap was wrong."""


def pareto(table: pd.DataFrame, examples: Examples) -> Figure:
    """Time a pixel against RMSE over the bound, a panel for each window and coherence."""
    figure, panels = _panels(table)
    for panel, rows in panels:
        low = rows.rmse_over_crlb - 1.96 * rows.rmse_over_crlb_se
        high = rows.rmse_over_crlb + 1.96 * rows.rmse_over_crlb_se
        _points(panel, rows, rows.rmse_over_crlb, np.maximum(low, 0.5), high)
        panel.axhline(1.0, color="black", linewidth=0.9)
        panel.axhline(rows.ziv_zakai.iloc[0] / rows.crlb.iloc[0], color="black", linewidth=0.9, linestyle="--")
        panel.set_ylim(0.6, 2000)
    lines = [("-", "Cramér-Rao bound"), ("--", "Ziv-Zakai bound, wraps included")]
    return _finished(figure, panels, "RMSE / CRLB", lines)


def pareto_wraps(table: pd.DataFrame, examples: Examples) -> Figure:
    """Time a pixel against wrap-error rate, a panel for each window and coherence."""
    figure, panels = _panels(table)
    for panel, rows in panels:
        rate = np.maximum(rows.wrap_rate, LEAST_RATE)
        _points(panel, rows, rate, np.maximum(rows.wrap_rate_low, LEAST_RATE), rows.wrap_rate_high)
        likelihood = rows[(rows.estimator == "maximum-likelihood") & (rows.setting == "default")]
        panel.axhline(likelihood.predicted_wrap_rate.iloc[0], color="black", linewidth=0.9, linestyle="--")
        panel.set_ylim(0.4 * LEAST_RATE, 100)
    lines = [("--", "predicted for maximum likelihood in a periodic window")]
    return _finished(figure, panels, f"wrap-error rate (none seen: {LEAST_RATE:g})", lines)


def _panels(table: pd.DataFrame) -> tuple[Figure, list[tuple[Axes, pd.DataFrame]]]:
    found = table[table.of == "estimator"]
    coherences, looks = pd.unique(found.coherence), pd.unique(found.looks)
    figure, axes = figures.grid(len(coherences), len(looks), width=5.2, height=3.7)
    panels = []
    for line, coherence in zip(axes, coherences, strict=True):
        for panel, window in zip(line, looks, strict=True):
            panel.set_title(f"coherence {coherence:g}, window of {window:.0f} looks", fontsize=10)
            panels.append((panel, found[(found.coherence == coherence) & (found.looks == window)]))
    return figure, panels


def _points(panel: Axes, rows: pd.DataFrame, y: Any, low: Any, high: Any) -> None:
    cost = rows.seconds_per_pixel * NANO
    for number, name in enumerate(pd.unique(rows.estimator)):
        for dominated in (True, False):
            here = (rows.estimator == name) & (rows.dominated == dominated)
            colour, alpha = COLOURS[number], 0.45 if dominated else 1.0
            panel.vlines(cost[here], low[here], high[here], color=colour, linewidth=0.9, alpha=alpha)
            panel.hlines(
                y[here], rows.seconds_low[here] * NANO, rows.seconds_high[here] * NANO, color=colour, alpha=alpha
            )
            panel.plot(
                cost[here],
                y[here],
                MARKERS[number],
                color=colour,
                markersize=6 if not dominated else 5,
                markerfacecolor="white" if dominated else colour,
                alpha=alpha,
                linestyle="",
            )
    _name(panel, rows, cost, y)


def _name(panel: Axes, rows: pd.DataFrame, cost: Any, y: Any) -> None:
    """Join the front, number it from the cheapest on, and list what the numbers stand for."""
    front = rows[~rows.dominated].sort_values("seconds_per_pixel")
    panel.step(cost[front.index], y[front.index], where="post", color="0.6", linewidth=0.8, zorder=0)
    for number, index in enumerate(front.index, start=1):
        place = (-3, -15) if number % 2 else (-3, 8)
        panel.annotate(str(number), (cost[index], y[index]), xytext=place, textcoords="offset points", fontsize=8)
    names = [f"{number} {row.estimator}, {row.setting}" for number, row in enumerate(front.itertuples(), start=1)]
    panel.text(0.98, 0.97, "\n".join(names), transform=panel.transAxes, ha="right", va="top", fontsize=7.5)


def _finished(
    figure: Figure, panels: list[tuple[Axes, pd.DataFrame]], y_label: str, lines: list[tuple[str, str]]
) -> Figure:
    for panel, _ in panels:
        panel.set_xscale("log")
        panel.set_yscale("log")
        if panel.get_subplotspec().is_first_col():
            panel.set_ylabel(y_label)
        if panel.get_subplotspec().is_last_row():
            panel.set_xlabel("processor time a pixel [ns]")
    handles = [
        Line2D([], [], marker=MARKERS[number], color=COLOURS[number], linestyle="", label=str(name))
        for number, name in enumerate(pd.unique(panels[0][1].estimator))
    ]
    handles += [Line2D([], [], color="black", linewidth=0.9, linestyle=style, label=words) for style, words in lines]
    title = "filled and numbered: beaten by no other in time and RMSE; bars: 95 % intervals, and quartiles of time"
    figure.legend(handles=handles, loc="outside lower center", ncols=5, title=title, fontsize=9)
    return figure
