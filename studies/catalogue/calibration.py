"""How far predictions can be trusted: predicted against simulated wrap-error rates and spreads."""

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from studies import figures
from studies.drawing import Examples

TOLERANCE = 0.05
"""Share by which a prediction may be off."""


def holds(table: pd.DataFrame) -> NDArray[np.bool_]:
    """Where the predicted wrap-error rate lies within the 95 % interval of the simulated one, or within 5 % of it."""
    within = table.predicted_wrap_rate.between(table.wrap_rate_low, table.wrap_rate_high)
    near = np.abs(table.predicted_wrap_rate / table.wrap_rate - 1) <= TOLERANCE
    return np.asarray(within | near, dtype=np.bool_)


def answer(table: pd.DataFrame) -> str:
    """The verdict: for how many points the prediction holds, the worst ratio, and where it stands."""
    said = []
    for name in pd.unique(table.estimator):
        rows = table[table.estimator == name]
        good, inside = holds(rows), rows.predicted_wrap_rate.between(rows.wrap_rate_low, rows.wrap_rate_high)
        ratio = (rows.wrap_rate / rows.predicted_wrap_rate).to_numpy()
        furthest = int(np.argmax(np.abs(np.log(np.maximum(ratio, 1e-3)))))
        worst = rows.iloc[furthest]
        spread = (rows.delay_std_in_wrap / rows.predicted_delay_std)[rows.wrap_rate < 0.1]
        said.append(
            f"{name}: the predicted wrap-error rate lies in the 95 % interval at {inside.mean():.0%} of {len(rows)} "
            f"points, within it or 5 % of it at {good.mean():.0%}{_where(rows[~good])}; simulated over predicted is at "
            f"worst {ratio[furthest]:.2f}, for {worst.looks:.0f} looks, B/fc = {worst.relative_bandwidth:g} and a rate "
            f"of {worst.wrap_rate:.1e}; the in-wrap spread is {spread.min():.2f} to {spread.max():.2f} times the "
            f"predicted one at rates below .1"
        )
    return ". ".join(said) + "."


def _where(rows: pd.DataFrame) -> str:
    if rows.empty:
        return ""
    by_band = rows.groupby("relative_bandwidth").size()
    return " (not at " + ", ".join(f"{n} of B/fc = {band:g}" for band, n in by_band.items()) + ")"


def reliability(table: pd.DataFrame, examples: Examples) -> Figure:
    """Simulated against predicted wrap-error rate, and their ratio, a column for each estimator."""
    names = list(pd.unique(table.estimator))
    figure, axes = figures.grid(2, len(names), width=4.2, height=3.4, share_y=False)
    for number, name in enumerate(names):
        rows = table[table.estimator == name]
        for place, (band, of_band) in enumerate(rows.groupby("relative_bandwidth")):
            colour, marker = figures.COLOURS[place], figures.MARKERS[place]
            predicted = of_band.predicted_wrap_rate
            # Bands stand a little beside each other, to keep their intervals apart.
            for panel, scale, x in (
                (axes[0][number], 1.0, predicted),
                (axes[1][number], predicted, predicted * 1.35 ** (place - 1)),
            ):
                panel.vlines(x, of_band.wrap_rate_low / scale, of_band.wrap_rate_high / scale, color=colour)
                panel.plot(x, of_band.wrap_rate / scale, marker, color=colour, markersize=4, label=f"B/fc = {band:g}")
        diagonal = np.array([3e-7, 1.0])
        axes[0][number].plot(diagonal, diagonal, color="black", linewidth=0.8)
        axes[0][number].set_yscale("log")
        axes[0][number].set_title(name, fontsize=10)
        axes[1][number].axhspan(1 - TOLERANCE, 1 + TOLERANCE, color="0.9", zorder=0)
        axes[1][number].axhline(1.0, color="black", linewidth=0.8)
        axes[1][number].set_ylim(0.5, 2.2)
        axes[1][number].set_xscale("log")
        axes[1][number].set_xlabel("predicted wrap-error rate")
    axes[0][0].set_ylabel("simulated wrap-error rate")
    axes[1][0].set_ylabel("simulated / predicted")
    _legend(figure, axes[0][0], "bars: 95 % intervals; grey: within 5 %; below, bands stand beside each other")
    return figure


def spread(table: pd.DataFrame, examples: Examples) -> Figure:
    """In-wrap standard deviation over the predicted one, against the wrap-error rate, a panel for each estimator."""
    names = list(pd.unique(table.estimator))
    figure, axes = figures.grid(1, len(names), width=4.2, height=3.4)
    for panel, name in zip(axes[0], names, strict=True):
        rows = table[table.estimator == name]
        for place, (band, of_band) in enumerate(rows.groupby("relative_bandwidth")):
            ratio = of_band.delay_std_in_wrap / of_band.predicted_delay_std
            error = of_band.delay_std_in_wrap_se / of_band.predicted_delay_std
            panel.errorbar(
                of_band.predicted_wrap_rate,
                ratio,
                1.96 * error,
                fmt=figures.MARKERS[place],
                color=figures.COLOURS[place],
                markersize=4,
                label=f"B/fc = {band:g}",
            )
        panel.axhline(1.0, color="black", linewidth=0.8)
        panel.set_xscale("log")
        panel.set_xlabel("predicted wrap-error rate")
        panel.set_title(name, fontsize=10)
    axes[0][0].set_ylabel("in-wrap STD / predicted")
    _legend(figure, axes[0][0], "bars: 95 % intervals")
    return figure


def _legend(figure: Figure, panel: Axes, title: str) -> None:
    handles, labels = panel.get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=4, title=title, fontsize=9)
