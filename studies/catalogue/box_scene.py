"""Paper A's figure 2: delays of a floor with boxes, pixel by pixel and windowed."""

from collections.abc import Sequence

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from studies import figures
from studies.drawing import Examples, Traces

LIMIT = 4.0
"""Largest delay in the figures [wraps]."""


def phase_slope(table: pd.DataFrame, examples: Examples) -> Figure:
    """Paper A's four panels: phase slope and refined, without noise and with; one row of the along-track."""
    return _panels(table, examples, ["phase-slope 1x1", "phase-slope-refined 1x1"])


def cross_correlation(table: pd.DataFrame, examples: Examples) -> Figure:
    """The same scene by windowed cross-correlation."""
    windows = pd.unique(table.window[table.estimator == "cross-correlation"])
    return _panels(table, examples, [f"cross-correlation {window}" for window in windows])


def answer(table: pd.DataFrame) -> str:
    """Shares in the right wrap of single pixels, and what averaging makes of the outliers."""
    outside = table[table.region == "outside"]
    said = []
    for snr in pd.unique(outside.snr):
        rows = outside[outside.snr == snr]
        noise = f"at {snr:g} dB" if np.isfinite(snr) else "without noise"
        single = rows[rows.estimator == "phase-slope"]
        wrong, outliers = float(single.wrap_rate.iloc[0]), float(single.outlier_rate.iloc[0])
        said.append(f"{1 - wrong:.1%} of single pixels {noise} ({outliers:.1%} outliers)")
    averaged = outside[(outside.estimator == "cross-correlation") & (outside.window == "1x33")]
    return (
        f"Outside layover the phase slope is in the right wrap for {' and '.join(said)}; averaging over 33 samples "
        f"leaves {averaged.outlier_rate.max():.2g} outliers and {averaged.wrap_rate.max():.2g} wrong wraps at the most."
    )


def _panels(table: pd.DataFrame, examples: Examples, estimates: Sequence[str]) -> Figure:
    figure, axes = figures.grid(len(examples), len(estimates), width=5.2, height=3.0)
    for line, (varied, found) in zip(axes, examples, strict=True):
        snr = float(varied.get("scene.snr", np.inf))
        noise = f"{snr:g} dB SNR" if np.isfinite(snr) else "no noise"
        for panel, estimate in zip(line, estimates, strict=True):
            _panel(panel, found, estimate, table.wrap.iloc[0])
            panel.set_title(f"{noise}, {estimate}", fontsize=10)
        line[0].set_ylabel("delay [wraps]")
    for panel in axes[-1]:
        panel.set_xlabel("slant range [m]")
    handles, labels = axes[0][0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=4, markerscale=6, fontsize=9)
    return figure


def _panel(panel: Axes, found: Traces, estimate: str, wrap: float) -> None:
    slant = found["slant range"]
    for number, branch in enumerate(found["truth"]):
        panel.plot(slant, branch / wrap, color="red", linewidth=2.5, label=None if number else "truth", rasterized=True)
    for label, key, colour in (("interferogram", "interferogram 1x1", "#2f6fff"), ("estimate", estimate, "black")):
        if key in found:
            panel.plot(
                slant,
                found[key] / wrap,
                ".",
                color=colour,
                markersize=1.4,
                markeredgewidth=0,
                label=label,
                rasterized=True,
            )
    unseen = np.isnan(found["truth"]).all(axis=0)
    panel.fill_between(slant, -LIMIT, LIMIT, where=unseen, color="0.9", linewidth=0, zorder=0, label="shadow")
    panel.set_ylim(-LIMIT, LIMIT)
