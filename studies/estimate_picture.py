"""A picture of the estimates in a file."""

from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.colors import LogNorm, Normalize
from matplotlib.figure import Figure
from numpy.typing import NDArray

from sim.band import Real

MOST = 400, 800
"""Rows and samples that are drawn; of a larger file, as many evenly spaced ones."""

DYNAMIC_RANGE = 40.0
"""Of the image [dB]."""

DOUBTED = 0.1
"""Wrap-error probability from which on a value does not decide the range of the colours."""

LEAST = 1e-4
"""Wrap-error probability that is drawn as none."""


def estimate_picture(path: Path) -> Figure:
    """Image, delay or depth, coherence, predicted spread, wrap-error probability and validity over time and row.

    Parameters
    ----------
    path
        A file that `studies.estimate_file` wrote; no more of it is read than is drawn.
    """
    import h5netcdf

    with h5netcdf.File(path, "r") as file:
        shape = file["valid"].shape
        thin = tuple(slice(None, None, -(-size // most)) for size, most in zip(shape, MOST, strict=True))
        shown = {name: file[name][thin] for name in file.variables if file[name].ndim == 2}
        times = np.asarray(file["time"][:], dtype=float)
        places = np.asarray(file["along_track"][:], dtype=float) if "along_track" in file.variables else None
    figure = Figure(figsize=(11.0, 8.4), layout="constrained")
    axes = figure.subplots(3, 2, sharex=True, sharey=True)
    extent = (1e3 * times[0], 1e3 * times[-1], *_along(places, shape[0]))
    for panel, (title, label, values, norm, colours) in zip(axes.T.flat, _panels(shown), strict=True):
        drawn = panel.imshow(
            values,
            origin="lower",
            aspect="auto",
            interpolation="nearest",
            extent=extent,
            cmap=colours,
            norm=norm,
        )
        panel.set_facecolor("0.85")
        panel.set_title(title, fontsize=10, loc="left")
        figure.colorbar(drawn, ax=panel, label=label, pad=0.01)
    for panel in axes[:, 0]:
        panel.set_ylabel("row" if places is None else "along track [m]")
    for panel in axes[-1]:
        panel.set_xlabel("time [ms]")
    return figure


def _panels(shown: dict[str, NDArray[Any]]) -> list[tuple[str, str, Real, Normalize, str]]:
    """Title, label of the colours, values, their range and the map of every panel."""
    placed, image, doubt = "depth" in shown, shown["intensity"], shown["wrap_error_probability"]
    what, scale, unit = ("depth", 1.0, "m") if placed else ("delay", 1e6, "µs")
    value, std, valid = scale * shown[what], scale * shown[f"{what}_std"], shown["valid"].astype(float)
    # Guesses within the search range would hide the seabed.
    low, high = _ends(value[doubt < DOUBTED] if (doubt < DOUBTED).any() else value)
    top = _ends(image)[1]
    share = f"{100 * valid.mean():.3g} % of what is drawn"
    return [
        ("Image of the primary receiver", "power [dB]", image, Normalize(top - DYNAMIC_RANGE, top), "gray"),
        (what.capitalize(), f"{what} [{unit}]", value, Normalize(low, high), "viridis_r" if placed else "viridis"),
        (f"Predicted STD of the {what}", f"STD [{unit}]", std, LogNorm(*_ends(std[std > 0])), "magma"),
        ("Coherence", "coherence", shown["coherence"], Normalize(0, 1), "gray"),
        ("Predicted wrap-error probability", "probability", np.maximum(doubt, LEAST), LogNorm(LEAST, 1), "magma"),
        (f"Valid (white): {share}", "valid", valid, Normalize(0, 1), "gray"),
    ]


def _ends(values: NDArray[Any]) -> tuple[float, float]:
    """Ends of the colours: all but 1 % on either side of what is there."""
    there = values[np.isfinite(values)].astype(float)
    if not there.size:
        return 0.1, 1.0
    low, high = (float(end) for end in np.percentile(there, [1, 99]))
    return low, high if high > low else low + abs(low) / 100 + 1e-9


def _along(places: Real | None, rows: int) -> tuple[float, float]:
    first, last = (0.0, float(rows - 1)) if places is None else (float(places[0]), float(places[-1]))
    half = (last - first) / (rows - 1) / 2 if rows > 1 else 0.5
    return first - half, last + half
