"""The figure of a prediction over ground range."""

import pandas as pd
from matplotlib.figure import Figure

from studies import figures

PANELS = (
    ("snr_db", "SNR of one receiver [dB]", "linear", None),
    ("coherence", "coherence", "linear", None),
    ("depth_std", "depth STD [m]", "log", "best_depth_std"),
    ("wrap_error_rate", "wrap-error rate", "log", "best_wrap_error_rate"),
    ("best_window", "window [pixels on a side]", "linear", None),
)
"""Column, label, scale, and the column of the best window drawn with it."""


def swath_figure(predicted: pd.DataFrame, window: str) -> Figure:
    """SNR, coherence, depth spread, wrap-error rate and best window over ground range, a line for each sediment.

    Parameters
    ----------
    predicted
        Of `studies.predict`, several of them with a column `seabed` that tells them apart.
    window
        What the stated window is called in the legend.
    """
    figure, axes = figures.grid(2, 3, width=3.6, height=2.8, share_y=False)
    panels = [panel for line in axes for panel in line]
    for panel, (column, label, scale, best) in zip(panels, PANELS, strict=False):
        for number, (seabed, rows) in enumerate(predicted.groupby("seabed", sort=False)):
            colour = figures.COLOURS[number % len(figures.COLOURS)]
            style = ("--" if column == "best_window" else "-") + ("o" if len(rows) < 3 else "")
            shown = rows[column].where(rows[column] > (0 if scale == "log" or column == "best_window" else -1e9))
            panel.plot(rows.ground_range, shown, style, color=colour, linewidth=1.4, label=str(seabed))
            if best:
                panel.plot(rows.ground_range, rows[best], "--", color=colour, linewidth=1.0)
        panel.set_yscale(scale)
        panel.set_title(label, fontsize=10)
        if column == "wrap_error_rate":
            panel.set_ylim(1e-8, 1.5)
    for panel in panels:
        panel.xaxis.set_tick_params(labelbottom=True)
        panel.set_xlabel("ground range [m]")
    handles, labels = axes[0][0].get_legend_handles_labels()
    panels[-1].set_axis_off()
    panels[-1].legend(handles, labels, loc="center", title=f"solid: {window}\ndashed: best window", fontsize=9)
    return figure
