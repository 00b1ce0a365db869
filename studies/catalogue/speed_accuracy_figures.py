"""Figures of cost against error: every setting a point, those that no other beats filled and numbered."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import FixedLocator, NullLocator

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

    def draw(panel: Axes, rows: pd.DataFrame) -> None:
        half = 1.96 * rows.rmse_over_crlb_se
        low = np.maximum(rows.rmse_over_crlb - half, 0.5)
        _points(panel, rows, rows.rmse_over_crlb, low, rows.rmse_over_crlb + half)
        panel.axhline(1.0, color="black", linewidth=0.9)
        panel.axhline(rows.ziv_zakai.iloc[0] / rows.crlb.iloc[0], color="black", linewidth=0.9, linestyle="--")
        panel.set_ylim(0.3, 1000)

    solid = Line2D([], [], color="black", linewidth=0.9, label="Cramér-Rao bound")
    dashed = Line2D(
        [], [], color="black", linewidth=0.9, linestyle="--", label="Ziv-Zakai bound of the window, with wraps"
    )
    return _drawn(table, draw, "RMSE / CRLB", [solid, dashed], "")


def pareto_wraps(table: pd.DataFrame, examples: Examples) -> Figure:
    """Time a pixel against wrap-error rate, a panel for each window and coherence."""

    def draw(panel: Axes, rows: pd.DataFrame) -> None:
        rate, low = (np.maximum(column, LEAST_RATE) for column in (rows.wrap_rate, rows.wrap_rate_low))
        _points(panel, rows, rate, low, rows.wrap_rate_high)
        likelihood = rows[(rows.estimator == "maximum-likelihood") & (rows.setting == "default")]
        panel.axhline(likelihood.predicted_wrap_rate.iloc[0], color="black", linewidth=0.9, linestyle="--")
        panel.set_ylim(0.1 * LEAST_RATE, 1e3)
        panel.yaxis.set_major_locator(FixedLocator([1e-5, 1e-4, 1e-3, 1e-2, 0.1, 1.0]))
        panel.yaxis.set_minor_locator(NullLocator())

    words = "predicted for maximum likelihood, of a periodic window"
    dashed = Line2D([], [], color="black", linewidth=0.9, linestyle="--", label=words)
    return _drawn(table, draw, f"wrap-error rate (none seen: {LEAST_RATE:g})", [dashed], ", as in the figure of RMSE")


def _drawn(
    table: pd.DataFrame, draw: Callable[[Axes, pd.DataFrame], None], y_label: str, lines: list[Line2D], where: str
) -> Figure:
    """A panel for each window and coherence, with a legend of the methods and lines."""
    found = table[table.of == "estimator"]
    coherences, looks = pd.unique(found.coherence), pd.unique(found.looks)
    figure, axes = figures.grid(len(coherences), len(looks), width=5.2, height=3.7)
    for line, coherence in zip(axes, coherences, strict=True):
        for panel, window in zip(line, looks, strict=True):
            panel.set_title(f"coherence {coherence:g}, window of {window:.0f} looks", fontsize=10)
            panel.set_xscale("log")
            panel.set_yscale("log")
            draw(panel, found[(found.coherence == coherence) & (found.looks == window)])
        line[0].set_ylabel(y_label)
    for panel in axes[-1]:
        panel.set_xlabel("processor time a pixel [ns]")
    methods = [
        Line2D([], [], marker=MARKERS[number], color=COLOURS[number], linestyle="", label=str(name))
        for number, name in enumerate(pd.unique(found.estimator))
    ]
    title = (
        f"filled and numbered: beaten by no other in time and RMSE{where}; bars: 95 % intervals, and quartiles of time"
    )
    figure.legend(handles=[*methods, *lines], loc="outside lower center", ncols=5, title=title, fontsize=9)
    return figure


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
