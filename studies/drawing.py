"""What a study shows of its results: a short table, and figures of curves or by a function of one's own."""

from collections.abc import Iterable, Mapping, Sequence
from types import MappingProxyType
from typing import Any, Literal, Self

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from pydantic import model_validator

from sim.band import Real
from studies import figures
from studies.named import called, imported
from studies.section import Name, Section, suggestion

Traces = Mapping[str, Real]
"""Arrays of one example, by name, for figures."""

Examples = Sequence[tuple[Mapping[str, Any], Traces]]
"""The varied values of a design point with the traces of its first trial, for every point that has some."""


MAIN = ("estimator", "window", "wrap_rate", "delay_std_in_wrap", "std_over_crlb", "rmse", "ground_range", "snr_db")
"""Columns that a summary has where none is named."""

LABELS: Mapping[str, str] = MappingProxyType(
    {
        "snr": "SNR [dB]",
        "snr_db": "SNR [dB]",
        "bandwidth": "bandwidth [Hz]",
        "centre_frequency": "centre frequency [Hz]",
        "baseline": "baseline [m]",
        "altitude": "altitude [m]",
        "ground_range": "ground range [m]",
        "delay": "delay [wraps]",
        "wrap_rate": "wrap-error rate",
        "std_over_crlb": "in-wrap STD / CRLB",
        "delay_bias": "bias in the right wrap [s]",
        "delay_std_in_wrap": "STD in the right wrap [s]",
        "delay_std_total": "STD, wraps included [s]",
        "rmse": "RMSE [s]",
        "seconds_per_pixel": "time a pixel [s]",
    }
)
"""What axes say of a column where the study has no words for it."""


class SummarySection(Section):
    """Which columns and rows of the table answer the question on a terminal.

    Parameters
    ----------
    columns
        Names of columns; what varies and the main results where none is given.
    where
        Only rows whose column has this value, or one of these; all rows where there are none.
    """

    columns: tuple[str, ...] = ()
    where: Mapping[str, Any] = {}

    def of(self, table: pd.DataFrame) -> pd.DataFrame:
        """The short table; ValueError for a column that the table does not have."""
        columns = self.columns or [name for name in table.columns if name in MAIN or self._varies(table, name)]
        kept = np.ones(len(table), dtype=bool)
        for column, values in self.where.items():
            check_columns("summary", [column], table.columns)
            wanted = values if isinstance(values, list | tuple) else [values]
            kept &= np.any(
                [np.isclose(table[column], v) if _is_number(v) else table[column] == v for v in wanted], axis=0
            )
        check_columns("summary", columns, table.columns)
        return table.loc[kept if kept.any() else ~kept, list(columns)]

    @staticmethod
    def _varies(table: pd.DataFrame, name: str) -> bool:
        before = (
            list(table.columns).index(name) < list(table.columns).index("estimator") if "estimator" in table else True
        )
        return before or (name == "region" and table[name].nunique() > 1)


class FigureSection(Section):
    """A figure: a curve for each estimator, in a panel for each value of up to two columns of the table.

    Parameters
    ----------
    name
        Name of its file.
    draw
        `module:function` of one's own instead: from the table and the examples to a Matplotlib figure.
    x, y
        Columns of the table.
    low, high
        Columns with the ends of an interval around y.
    error
        Column with the standard error of y; the bars are 1.96 times as long. Where none of the three is given, those
        that the table has of y.
    line
        Column with a prediction or bound of y, drawn as a line for each estimator.
    level
        A value of y to draw as a black line across.
    down, across
        Columns whose values make the rows and the columns of panels.
    scale
        "linear" or "log", of y.
    limits
        Ends of the y axis; on a log scale its lower end is where nothing was counted.
    x_label, y_label, legend
        Words.
    """

    name: Name
    draw: str | None = None
    x: str = ""
    y: str = ""
    low: str | None = None
    high: str | None = None
    error: str | None = None
    line: str | None = None
    level: float | None = None
    down: str | None = None
    across: str | None = None
    scale: Literal["linear", "log"] = "linear"
    limits: tuple[float, float] | None = None
    x_label: str | None = None
    y_label: str | None = None
    legend: str | None = None

    @model_validator(mode="after")
    def _says_what(self) -> Self:
        if self.draw is None and not (self.x and self.y):
            raise ValueError(f"figure {self.name} has no x and y; it must have both, or a function to draw it")
        return self

    @property
    def used(self) -> list[str]:
        """Columns of the table that it shows."""
        named = [self.x, self.y, self.low, self.high, self.error, self.line, self.down, self.across]
        return [column for column in named if column]

    def drawn(self, table: pd.DataFrame, examples: Examples) -> Figure:
        """The figure; ValueError for a column that the table does not have."""
        if self.draw is not None:
            return called(f"draw {self.draw}", imported(self.draw, "draw"), Figure, table, examples)
        check_columns(f"figure {self.name}", self.used, table.columns)
        downs, acrosses = _values(table, self.down), _values(table, self.across)
        figure, axes = figures.grid(len(downs), len(acrosses))
        for line, down in zip(axes, downs, strict=True):
            for panel, across in zip(line, acrosses, strict=True):
                here = _rows(_rows(table, self.down, down), self.across, across)
                for number, (name, rows) in enumerate(here.groupby("estimator", sort=False)):
                    self._curve(panel, rows.sort_values(self.x), number, str(name), table)
                self._finish(panel, {self.down: down, self.across: across})
        for line in axes:
            line[0].set_ylabel(self.y_label or _label(self.y))
        for panel in axes[-1]:
            panel.set_xlabel(self.x_label or _label(self.x))
        handles, labels = axes[0][0].get_legend_handles_labels()
        narrow = len(acrosses) == 1
        words = self.legend.replace("; ", "\n") if self.legend and narrow else self.legend
        columns = 1 if narrow else 4
        figure.legend(handles, labels, loc="outside lower center", ncols=columns, title=words, fontsize=9)
        return figure

    def _curve(self, panel: Axes, rows: pd.DataFrame, number: int, name: str, table: pd.DataFrame) -> None:
        colour = figures.COLOURS[number % len(figures.COLOURS)]
        marker = figures.MARKERS[number % len(figures.MARKERS)]
        if self.line:
            style = figures.LINES[number % len(figures.LINES)]
            panel.plot(rows[self.x], rows[self.line], color=colour, linewidth=1, linestyle=style)
        # Points of estimators stand a little beside each other, to keep their intervals apart.
        finite = table[self.x][np.isfinite(table[self.x].astype(float))]
        x = rows[self.x] + (number - 1) * 0.006 * (np.ptp(finite) if len(finite) else 0.0)
        floor = self.limits[0] if self.limits and self.scale == "log" else -np.inf
        low, high = self._interval(rows)
        panel.vlines(x, np.maximum(low, floor), np.maximum(high, floor), color=colour, linewidth=1)
        kind = "" if self.line else "-"
        panel.plot(
            x, np.maximum(rows[self.y], floor), f"{kind}{marker}", color=colour, markersize=4, linewidth=1, label=name
        )

    def _interval(self, rows: pd.DataFrame) -> tuple[Real, Real]:
        y = rows[self.y].to_numpy(dtype=float)
        low, high, error = self.low, self.high, self.error
        if (low, high, error) == (None, None, None):
            low, high, error = (n if n in rows else None for n in (f"{self.y}_low", f"{self.y}_high", f"{self.y}_se"))
        if error and not (low and high):
            half = 1.96 * rows[error].to_numpy(dtype=float)
            return y - half, y + half
        lowest, highest = (rows[column].to_numpy(dtype=float) if column else y for column in (low, high))
        return lowest, highest

    def _finish(self, panel: Axes, shown: Mapping[str | None, Any]) -> None:
        if self.level is not None:
            panel.axhline(self.level, color="black", linewidth=0.8)
        panel.set_yscale(self.scale)
        if self.limits:
            panel.set_ylim(*self.limits)
        title = ", ".join(f"{column.replace('_', ' ')} {_short(value)}" for column, value in shown.items() if column)
        panel.set_title(title, fontsize=10)


def _values(table: pd.DataFrame, column: str | None) -> list[Any]:
    return [None] if column is None else list(pd.unique(table[column]))


def _rows(table: pd.DataFrame, column: str | None, value: Any) -> pd.DataFrame:
    return table if column is None else table[table[column] == value]


def _label(column: str) -> str:
    return LABELS.get(column, column.replace("_", " "))


def _short(value: Any) -> str:
    return f"{value:g}" if _is_number(value) else str(value)


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)


def check_columns(place: str, columns: Iterable[str], known: Iterable[str]) -> None:
    """ValueError for a column that a table does not have; names the nearest."""
    there = list(known)
    for column in columns:
        if column not in there:
            raise ValueError(f"{place} has the column {column!r}; it must be {suggestion(column, there)}")
