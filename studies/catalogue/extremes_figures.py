"""What the extremes show: a matrix of verdicts, and where wraps are right."""

import numpy as np
import pandas as pd
from matplotlib.colors import ListedColormap
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from studies import figures
from studies.catalogue.extremes import METHODS
from studies.drawing import Examples

VERDICTS = {
    "exact": ("#009e73", "exact"),
    "as claimed": ("#56b4e9", "within what is claimed"),
    "invalid": ("#dddddd", "flagged invalid"),
    "refused": ("#e69f00", "refused in one line"),
    "fails": ("#d55e00", "fails"),
}

SWEPT = ("SNR [dB]", "relative bandwidth", "window [samples]", "looks")


def verdicts(table: pd.DataFrame, examples: Examples) -> Figure:
    """Methods over cases; a cell has a strip for each value, in the order of the label."""
    rows = table[table.estimator.isin(list(METHODS))]
    cases, names = list(pd.unique(rows.case)), list(pd.unique(rows.estimator))
    figure = Figure(figsize=(11.5, 0.36 * len(cases) + 2.4), layout="constrained")
    axes = figure.subplots()
    for y, case in enumerate(cases):
        for x, name in enumerate(names):
            cell = rows[(rows.case == case) & (rows.estimator == name)]
            width = 0.94 / len(cell)
            for strip, verdict in enumerate(cell.verdict):
                axes.barh(
                    y, width, left=x - 0.47 + strip * width, height=0.84, color=VERDICTS[verdict][0], edgecolor="white"
                )
    labels = [f"{case}:  {_values(rows[rows.case == case].value.unique())}" for case in cases]
    axes.set_yticks(range(len(cases)), labels, fontsize=8)
    axes.set_xticks(range(len(names)), names, rotation=30, ha="left", fontsize=9)
    axes.xaxis.tick_top()
    axes.tick_params(length=0)
    axes.set_ylim(len(cases) - 0.5, -0.5)
    axes.set_xlim(-0.5, len(names) - 0.5)
    axes.spines[:].set_visible(False)
    handles = [Patch(color=colour, label=label) for colour, label in VERDICTS.values()]
    figure.legend(handles=handles, loc="outside lower center", ncols=len(handles), fontsize=9)
    return figure


def _values(values: pd.Series) -> str:
    return ", ".join(f"1 - {1 - value:.0e}" if 0 < 1 - value < 1e-3 else f"{value:.3g}" for value in values)


def right_wraps(table: pd.DataFrame, examples: Examples) -> Figure:
    """Share of all estimates that are valid and in the right wrap, a panel for each case that is swept."""
    figure, axes = figures.grid(1, len(SWEPT), width=3.9, height=3.8, share_x=False, share_y=False)
    colours = ListedColormap([*(f"{0.25 + 0.75 * step / 10:.3f}" for step in range(10)), VERDICTS["exact"][0]])
    names = list(pd.unique(table.estimator[table.estimator.isin(list(METHODS))]))
    for panel, case in zip(axes[0], SWEPT, strict=True):
        rows = table[(table.case == case) & table.estimator.isin(list(METHODS))]
        share = (rows.valid - rows.wrong) / rows.estimates
        grid = rows.assign(share=share).pivot(index="estimator", columns="value", values="share").loc[names]
        # Ten greys for what is below, and green.
        shown = np.where(grid >= 0.99, 1.05, np.minimum(grid.fillna(0.0), 0.98))
        panel.imshow(shown, cmap=colours, vmin=0, vmax=1.0999, aspect="auto")
        panel.grid(visible=False)
        for y, line in enumerate(grid.to_numpy()):
            for x, value in enumerate(line):
                # Rounded down, so that 99 is green.
                words = "-" if np.isnan(value) else f"{np.floor(100 * value + 1e-9):.0f}"
                colour = "k" if value >= 0.5 else "w"
                panel.text(x, y, words, ha="center", va="center", fontsize=7, color=colour)
        panel.set_xticks(range(grid.shape[1]), [f"{value:g}" for value in grid.columns], fontsize=8)
        first = panel is axes[0][0]
        panel.set_yticks(range(len(names)), names if first else [""] * len(names), fontsize=9)
        panel.set_xlabel(case)
    figure.suptitle(
        "Per cent of all estimates that are valid and in the right wrap; green: 99 and more; -: refused", fontsize=10
    )
    return figure
