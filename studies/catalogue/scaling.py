"""How time and memory of every stage grow, with fitted exponents beside those that `docs/scaling.md` promises."""

from collections.abc import Iterator
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import NullFormatter

from sim import Sonar
from sim.band import Real
from studies import figures
from studies.catalogue.scaling_stages import Sweep, sweeps
from studies.drawing import Examples
from studies.parallel import one_thread
from studies.power_law import power_law
from studies.timing import in_turns, peak_bytes

TOLERANCE = 0.1
"""How far an exponent may be from what is promised."""


def measure(sonar: Sonar, rows: int, rng: np.random.Generator) -> pd.DataFrame:
    """A row for each stage, variable, cost (`of` "time" [s] or "memory" [bytes]) and size.

    What belongs to all sizes of a sweep, `exponent`, `exponent_se`, what is `promised` and whether it is `within`
    `TOLERANCE` of that, and the cost of the `smallest` and `largest`, stands in each of its rows. Costs are fitted by
    `fixed + scale size^exponent` (`studies.power_law`), those promised to be flat by the power alone. Times are
    processor seconds but over jobs; of several turns the least counts. Memory is that of `studies.timing.peak_bytes`.
    All is done on one thread.

    Parameters
    ----------
    sonar
        Of all stages.
    rows
        Rows of what is not varied over rows; each size is timed so many times and once more.
    rng
        Source of the echoes.
    """
    found: list[dict[str, Any]] = []
    with one_thread():
        for sweep in sweeps(sonar, rows, rng):
            cases = dict(zip(map(str, sweep.sizes), sweep.cases, strict=True))
            turns = np.array(list(in_turns(cases, rows + 1, sweep.clock).values()))
            found += _rows(sweep, "time", turns, sweep.time)
            if sweep.variable != "jobs":
                peaks = np.array([[peak_bytes(case)] for case in sweep.cases], dtype=float)
                found += _rows(sweep, "memory", peaks, sweep.memory)
    return pd.DataFrame(found)


def _rows(sweep: Sweep, of: str, turns: Real, promised: float | None) -> Iterator[dict[str, Any]]:
    costs = turns.min(axis=1)
    if len(costs) > 2:
        law = power_law(sweep.sizes, costs, fixed=promised != 0)
    else:
        # Of two sizes only turns that differ tell the standard error.
        law = power_law(np.repeat(sweep.sizes, turns.shape[1]), turns.ravel(), fixed=False)
    whole = {
        "exponent": law.exponent,
        "exponent_se": law.exponent_se,
        "promised": np.nan if promised is None else promised,
        "within": "" if promised is None else "yes" if abs(law.exponent - promised) <= TOLERANCE else "no",
        "fixed": law.fixed,
        "smallest": float(costs[0]),
        "largest": float(costs[-1]),
    }
    for number, (size, cost, fitted) in enumerate(zip(sweep.sizes, costs, law.at(sweep.sizes), strict=True)):
        of_size = {"number": number, "size": size, "cost": float(cost), "fitted": float(fitted)}
        yield {"stage": sweep.stage, "variable": sweep.variable, "of": of, **of_size, **whole}


def answer(table: pd.DataFrame) -> str:
    """How many exponents are as promised, which are not, and the speed-up of two jobs."""
    sweeps_of = table[table.number == 0]
    promised = sweeps_of[sweeps_of.promised.notna()]
    kept = promised.within == "yes"
    off = [
        f"{row.of} of {row.stage} over {row.variable}: {row.exponent:.2f} for {row.promised:.2f}"
        for row in promised[~kept].itertuples()
    ]
    said = f"{kept.sum()} of {len(promised)} promised exponents are found within {TOLERANCE:g}"
    said += f" (not: {'; '.join(off)})" if off else ""
    named = [
        ("cross-correlation", "samples"),
        ("cross-correlation", "lags"),
        ("cross-correlation", "window in time"),
        ("interferogram", "rows"),
        ("patch", "samples"),
        ("engine", "trials"),
    ]
    times = sweeps_of[sweeps_of.of == "time"].set_index(["stage", "variable"]).exponent
    exponents = [f"{stage} over {over} {times[stage, over]:.2f}" for stage, over in named if (stage, over) in times]
    said += f"; of time: {', '.join(exponents)}" if exponents else ""
    jobs = table[(table.variable == "jobs") & (table.of == "time")]
    if len(jobs):
        most = jobs.iloc[-1]
        said += f"; {most['size']:.0f} jobs are {most.smallest / most.largest:.2f} times as fast as one"
    return f"{said}."


PANELS = (
    ("samples", True),
    ("samples", False),
    ("rows", True),
    ("rows", False),
    ("window", False),
    ("lags", False),
    ("scatterers", True),
    ("trials", False),
    ("jobs", False),
)
"""Variables, and whether of the simulator's stages."""


def times(table: pd.DataFrame, examples: Examples) -> Figure:
    """Time over every variable: measured, fitted, and the slope that is promised through the largest size."""
    return _figure(table[table.of == "time"], "time [s]", 1.0)


def memories(table: pd.DataFrame, examples: Examples) -> Figure:
    """The same of memory."""
    return _figure(table[table.of == "memory"], "peak memory [MB]", 1e-6)


def _figure(table: pd.DataFrame, label: str, unit: float) -> Figure:
    simulator = table.stage.str.startswith(("patch", "scene"))
    # `window in time`, `along track` and that of a window that varies.
    variable = table.variable.str.split().str[0]
    chosen = [(name, sim, table[(variable == name) & (simulator == sim)]) for name, sim in PANELS]
    chosen = [panel for panel in chosen if len(panel[2])]
    figure, axes = figures.grid(3, 3, width=4.6, height=3.9, share_x=False, share_y=False)
    panels = [panel for line in axes for panel in line]
    for panel, (name, of_simulator, rows) in zip(panels, chosen, strict=False):
        for number, (_, curve) in enumerate(rows.groupby(["stage", "variable"], sort=False)):
            which = curve.stage.iloc[0] + curve.variable.iloc[0].removeprefix(name)
            _curve(panel, curve, number, which, unit)
        panel.set_xscale("log")
        panel.set_yscale("log")
        panel.set_xlabel(name)
        panel.set_title("simulator" if of_simulator else "engine" if name in ("trials", "jobs") else "estimators")
        panel.xaxis.set_minor_formatter(NullFormatter())
        low, high = panel.get_ylim()
        # What is flat is to look flat.
        room = max(1.0, np.sqrt(10 * low / high))
        panel.set_ylim(low / room, high * room)
        if name == "jobs":
            panel.set_xticks(rows["size"].unique(), [f"{n:.0f}" for n in rows["size"].unique()])
        if name == "window":
            # Room for the legend.
            panel.set_ylim(top=1e4 * panel.get_ylim()[1])
        panel.legend(fontsize=6, ncols=2 if name == "window" else 1)
    for panel in panels[len(chosen) :]:
        panel.set_axis_off()
    for line in axes:
        line[0].set_ylabel(label)
    figure.suptitle(
        "points: measured, with the fitted exponent; lines: fit, where something is promised; grey: slope promised",
        fontsize=10,
    )
    return figure


def _curve(panel: Axes, curve: pd.DataFrame, number: int, name: str, unit: float) -> None:
    colour = figures.COLOURS[number % len(figures.COLOURS)]
    marker = figures.MARKERS[(number + number // len(figures.COLOURS)) % len(figures.MARKERS)]
    size, last = curve["size"].to_numpy(dtype=float), curve.iloc[-1]
    if np.isfinite(last.promised):
        slope = last.fitted * (size / size[-1]) ** last.promised
        seen = slope > curve.cost.min() / 3
        panel.plot(size[seen], slope[seen] * unit, color="0.6", linewidth=1, linestyle="--", zorder=1)
        panel.plot(size, curve.fitted * unit, color=colour, linewidth=1)
    label = f"{name} {last.exponent:.2f}"
    panel.plot(size, curve.cost * unit, marker, color=colour, markersize=4, label=label)
