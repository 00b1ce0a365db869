"""The look that all figures share."""

from matplotlib.axes import Axes
from matplotlib.figure import Figure

COLOURS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9")
"""Okabe and Ito's palette, told apart by colour-blind readers."""

MARKERS = ("o", "s", "^", "D", "v", "P")

LINES = ("--", ":", "-.", (0, (5, 1, 1, 1, 1, 1)), (0, (1, 3)), (0, (6, 3)))


def grid(
    rows: int, columns: int, *, width: float = 3.6, height: float = 2.8, share_x: bool = True, share_y: bool = True
) -> tuple[Figure, list[list[Axes]]]:
    """A figure of panels that share their axes where they may; sizes in inches a panel."""
    figure = Figure(figsize=(width * columns + 0.6, height * rows + 0.6), layout="constrained")
    axes = figure.subplots(rows, columns, sharex=share_x, sharey=share_y, squeeze=False)
    for panel in axes.flat:
        panel.grid(alpha=0.3, linewidth=0.5)
    return figure, [list(line) for line in axes]
