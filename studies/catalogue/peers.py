"""Other implementations of the same tasks beside ours: what each takes, and how far off it is, on the same data."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from importlib import import_module
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from estimators import bounds
from sim import Sonar
from sim.band import Complex, Real
from studies import figures
from studies.catalogue import peer_methods as methods
from studies.drawing import Examples
from studies.parallel import one_thread
from studies.timing import in_turns

TURNS = 3

WRAPS = 1.5
"""Largest true delay of the records [wraps]."""

COHERENCE, RECORD = 0.9, 16
"""Of the records whose delay is estimated, and their samples, critically sampled: 16 looks."""

UNITS: Mapping[str, str] = {
    "interferogram": "largest phase error beside a pixel 80 dB brighter [rad]",
    "delay of a record": "RMSE in the right wrap [wraps]",
    "phase slope": "error over the largest lag product",
    "echoes": "RMS error over RMS of the series",
}
"""What `error` is in each task."""

EXACT = 1e-17
"""Where an error of 0 is drawn."""


@dataclass(frozen=True)
class Task:
    """What several methods do to the same data.

    Attributes
    ----------
    name
        Of `UNITS`.
    parts
        Pixels, records or scatterers that each method is timed on.
    ours
        Names of ours, the first of which the others are compared with.
    methods
        All of them.
    errors
        From what a method gives to columns of the table, `error` among them.
    """

    name: str
    parts: Mapping[str, int]
    ours: tuple[str, ...]
    methods: Mapping[str, Callable[[], Any]]
    errors: Callable[[Any], Mapping[str, float]]


def measure(sonar: Sonar, rows: int, rng: np.random.Generator) -> pd.DataFrame:
    """A row for each task and method: processor time a pixel, record or scatterer, and how far off it is.

    `times_ours` is the time over that of the first of ours. `error` is what `UNITS` says; of delays also `bias` [wraps]
    with its standard error, `std_over_crlb`, both in the right wrap, and `wrap_rate`. All is done on one thread.

    Parameters
    ----------
    sonar
        Of the records and echoes.
    rows
        Rows of the image; there are eight times as many records.
    rng
        The only source of chance.
    """
    with one_thread():
        tasks = [_interferogram(rows, rng), _delays(sonar, 8 * rows, rng), _slope(rng), _echoes(sonar, rng)]
        return pd.concat([_measured(task) for task in tasks], ignore_index=True)


def _measured(task: Task) -> pd.DataFrame:
    there = {name: work for name, work in task.methods.items() if installed(name)}
    seconds = {name: float(times.min()) / task.parts[name] for name, times in in_turns(there, TURNS).items()}
    rows: list[dict[str, Any]] = []
    for name in task.methods:
        row: dict[str, Any] = {"task": task.name, "method": name, "ours": name in task.ours, "installed": name in there}
        if name in there:
            row |= {"version": version(name), "microseconds": 1e6 * seconds[name]}
            row |= {"times_ours": seconds[name] / seconds[task.ours[0]], **task.errors(there[name]())}
        rows.append(row)
    return pd.DataFrame(rows)


def module_of(method: str) -> str | None:
    """The package that a peer comes from, the first word of its name; None of what is ours."""
    known = {"scipy": "scipy", "scikit-image": "skimage"}
    return known.get(method.split()[0].split(".")[0])


def installed(method: str) -> bool:
    """Whether it can be imported."""
    module = module_of(method)
    try:
        return module is None or import_module(module) is not None
    except ImportError:
        return False


def version(method: str) -> str:
    """Of the package that a peer comes from."""
    module = module_of(method)
    return "" if module is None else str(import_module(module).__version__)


def _interferogram(rows: int, rng: np.random.Generator) -> Task:
    """Windows of 9 x 9 over an image with one pixel 80 dB brighter; errors are read where the window lacks it."""
    shape = max(rows, 32), 1024
    pair = rng.normal(size=(2, *shape)) + 1j * rng.normal(size=(2, *shape))
    pair[1] += 2 * pair[0]
    bright = shape[0] // 2, shape[1] // 2
    pair[:, bright[0], bright[1]] *= 1e4
    first, other = pair
    exact = methods.exact_interferogram(first, other)
    near = np.zeros(exact.shape, dtype=np.bool_)
    near[bright[0] - 8 : bright[0] + 1, bright[1] - 8 : bright[1] + 1] = True

    def errors(found: Complex) -> dict[str, float]:
        angle = np.angle(found[4:-4, 4:-4] * exact.conj())[~near]
        return {"error": float(np.abs(angle).max())}

    works: dict[str, Callable[[], Any]] = {
        "ours": lambda: methods.ours_interferogram(first, other),
        "ours, single precision": lambda: methods.ours_interferogram(*single),
        "scipy.ndimage uniform_filter": lambda: methods.uniform_filters(first, other),
        "scipy.ndimage uniform_filter, single precision": lambda: methods.uniform_filters(*single),
        "scipy.signal oaconvolve": lambda: methods.convolved(first, other),
    }
    single = first.astype(np.complex64), other.astype(np.complex64)
    return Task("interferogram", dict.fromkeys(works, first.size), tuple(works)[:2], works, errors)


def _delays(sonar: Sonar, records: int, rng: np.random.Generator) -> Task:
    """One delay of each record, of which nothing is known."""
    delay = rng.uniform(-WRAPS, WRAPS, records) * sonar.wrap
    pair = methods.records(sonar, (records, RECORD), COHERENCE, delay, rng)
    crlb = float(bounds.coherent_delay_crlb(RECORD, COHERENCE, sonar.centre_frequency, sonar.bandwidth))

    def errors(found: Real) -> dict[str, float]:
        error = found - delay
        right = np.abs(error) < 0.5 * sonar.wrap
        kept = error[right]
        return {
            "error": float(np.sqrt(np.mean(kept**2))) / sonar.wrap,
            "bias": float(kept.mean()) / sonar.wrap,
            "bias_se": float(kept.std() / np.sqrt(len(kept))) / sonar.wrap,
            "std_over_crlb": float(kept.std()) / crlb,
            "wrap_rate": float(1 - right.mean()),
        }

    works: dict[str, Callable[[], Any]] = {
        "ours, cross-correlation": lambda: methods.cross_correlation(pair),
        "ours, cross-correlation without refinement": lambda: methods.cross_correlation(pair, refine=False),
        "ours, maximum likelihood": lambda: methods.maximum_likelihood(pair),
        "scipy.signal resample, parabola": lambda: methods.resampled_peaks(pair),
        "scipy.signal resample, then our phase": lambda: methods.with_phase(pair, methods.resampled_peaks(pair)),
        "scipy.signal correlate, parabola": lambda: methods.correlated_peaks(pair),
        "scikit-image phase_cross_correlation": lambda: methods.scikit_image(pair, None),
        "scikit-image phase_cross_correlation, whitened": lambda: methods.scikit_image(pair, "phase"),
        "scikit-image phase_cross_correlation, then our phase": lambda: methods.with_phase(
            pair, methods.scikit_image(pair, None)
        ),
    }
    return Task("delay of a record", dict.fromkeys(works, records), tuple(works)[:3], works, errors)


def _slope(rng: np.random.Generator) -> Task:
    """Lag products of single pixels of a record of 512 samples, 33 lags each; the matrix at a few pixels only."""
    primary, secondary = rng.normal(size=(2, 512)) + 1j * rng.normal(size=(2, 512))
    times, lags = [3, 100, 400], np.arange(-16, 17)
    exact = methods.direct_lag_products(primary, secondary, times, lags)

    def errors(found: Complex) -> dict[str, float]:
        chosen = found if found.shape == exact.shape else found[:, times]
        return {"error": float(np.abs(chosen - exact).max() / np.abs(exact).max())}

    works: dict[str, Callable[[], Any]] = {
        "ours, lag products": lambda: methods.lag_products(primary, secondary, lags),
        "matrix of paper A": lambda: methods.of_matrix(primary, secondary, times, lags),
    }
    parts = {"ours, lag products": primary.size, "matrix of paper A": len(times)}
    return Task("phase slope", parts, tuple(works)[:1], works, errors)


def _echoes(sonar: Sonar, rng: np.random.Generator) -> Task:
    """One series of 4,096 scatterers anywhere in a record of 2,048 samples."""
    band, times, strengths = methods.scatterers(sonar, 2048, 4096, rng)
    exact = methods.direct_echoes(band, times, strengths)

    def errors(found: Complex) -> dict[str, float]:
        return {"error": float(np.linalg.norm(found - exact) / np.linalg.norm(exact))}

    works: dict[str, Callable[[], Any]] = {
        "ours, accuracy 2e-7": lambda: methods.our_echoes(band, times, strengths, 2e-7),
        "ours, accuracy 1e-12": lambda: methods.our_echoes(band, times, strengths, 1e-12),
        "nearest sample, FFT": lambda: methods.gridded_echoes(band, times, strengths),
        "direct summation, exact": lambda: methods.direct_echoes(band, times, strengths),
    }
    return Task("echoes", dict.fromkeys(works, len(strengths)), tuple(works)[:2], works, errors)


def answer(table: pd.DataFrame) -> str:
    """What peers take beside ours, and what they are off."""
    said = []
    for task, rows in table.groupby("task", sort=False):
        there = rows[rows.installed]
        ours = there.iloc[0]
        others = [
            f"{row.method} takes {row.times_ours:.3g} times as long and is off by {row.error:.2g}"
            for row in there[~there.ours].itertuples()
        ]
        said.append(f"{task}: {ours.method} {ours.microseconds:.3g} us, off by {ours.error:.2g}; {'; '.join(others)}")
    missing = list(table.method[~table.installed])
    return ". ".join(said) + (f". Not installed: {', '.join(missing)}" if missing else "") + "."


def figure(table: pd.DataFrame, examples: Examples) -> Figure:
    """Time against error in each task: ours full, peers hollow."""
    drawn, axes = figures.grid(2, 2, width=5.4, height=4.4, share_x=False, share_y=False)
    panels = [panel for line in axes for panel in line]
    for panel, (task, rows) in zip(panels, table[table.installed].groupby("task", sort=False), strict=True):
        for number, (_, row) in enumerate(rows.iterrows()):
            colour = figures.COLOURS[number % len(figures.COLOURS)]
            marker = figures.MARKERS[(number + number // len(figures.COLOURS)) % len(figures.MARKERS)]
            face = colour if row.ours else "none"
            style: dict[str, Any] = {"color": colour, "markerfacecolor": face, "label": row.method}
            if row.error == 0:
                style["label"] += f", drawn at {EXACT:g}"
            panel.plot(row.microseconds, max(row.error, EXACT), marker, **style)
        panel.set_xscale("log")
        panel.set_yscale("log")
        panel.margins(0.1)
        panel.set_title(str(task), fontsize=10)
        panel.set_ylabel(UNITS[str(task)], fontsize=8)
        unit = {"interferogram": "pixel", "delay of a record": "record", "phase slope": "pixel"}
        panel.set_xlabel(f"time a {unit.get(str(task), 'scatterer')} [us]")
        panel.legend(fontsize=7, loc="upper center", bbox_to_anchor=(0.5, -0.16), ncols=2)
    drawn.suptitle("full: ours; hollow: peers", fontsize=10)
    return drawn
