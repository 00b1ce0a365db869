"""The stages whose cost the study `scaling` measures, what each is varied over, and what is promised of it."""

import os
import tempfile
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import takewhile
from pathlib import Path
from time import perf_counter, process_time
from typing import Any

import numpy as np

from estimators import (
    CombinedNeighbours,
    CrossCorrelation,
    Estimator,
    FixedWindow,
    FullBandPhaseSlope,
    Interferogram,
    MaximumLikelihood,
    MultiChromatic,
    SplitSpectrum,
    TwoWindow,
    VaryingWindow,
    WindowPolicy,
)
from sim import EchoPair, Scene, Sonar, TrawlMark, echo_blocks, plan, simulate, speckle_pair
from studies import catalogue, engine, report
from studies.timing import Case


def spread(least: float, most: float, count: int) -> list[int]:
    """Whole numbers whose ratios are alike, both ends among them."""
    return [round(n) for n in np.geomspace(least, most, count)]


SAMPLES = [64, 256, 1024, 4096, 16384, 65536]
"""Of records, with fast transforms all alike; the smallest tell the fixed cost."""

ROWS = spread(1, 256, 7)
BATCHES = [16 * n for n in spread(1, 16, 5)]
"""Rows of scenes: multiples of those that are simulated together."""

LENGTHS = spread(20, 640, 6)
"""Of scenes, in ground range [m]."""

DENSITIES = spread(4, 128, 6)
"""Scatterers in a resolution."""

WINDOWS = [9, 17, 33, 65, 129, 257]
SEARCHES = spread(1, 32, 6)
"""Largest delay that is searched [1 / B]."""

BLOCKS = spread(2, 32, 5)
"""Of the engine's trials."""

RECORD, WINDOW, TALL = 512, 33, 160
"""Samples of a record of which something else is varied, those of the usual window, and rows that hold tall windows."""


PAGES = 0.1
"""Promised beside 1 of what does so little that it tells what memory costs when it is fresh from the system: a patch
takes 62 ns a pixel up to 20,000 pixels, and 80 to 85 ns beyond, with a page fault for every 4 kB."""

CACHES = 0.1
"""Promised beside 1 over the many lags of the phase slope, whose products come from the cache that processors share,
while those of few stay near."""

SERIAL = 0.1
"""Promised beside -1 over jobs: for what one process does alone, and for the memory that all share."""


def n_log_n(sizes: Sequence[float]) -> float:
    """Slope of `n log n`, `1 + 1 / ln n`, in the middle of sizes."""
    return 1 + 1 / float(np.mean(np.log(sizes)))


@dataclass(frozen=True)
class Sweep:
    """One stage over one variable.

    Attributes
    ----------
    stage, variable
        What they are called.
    sizes
        Of the variable, rising.
    cases
        The work at each.
    time, memory
        Promised exponents; None where none is promised.
    clock
        Of the times.
    """

    stage: str
    variable: str
    sizes: Sequence[float]
    cases: Sequence[Case]
    time: float | None
    memory: float | None
    clock: Callable[[], float] = process_time


def sweeps(sonar: Sonar, rows: int, rng: np.random.Generator) -> Iterator[Sweep]:
    """All of them; one at a time, as each holds its echoes.

    Parameters
    ----------
    sonar
        Of all stages.
    rows
        Rows of what is not varied over rows.
    rng
        Source of the echoes.
    """
    yield from _patches(sonar, rows)
    yield from _scenes(sonar, rows)
    for name, method in METHODS.items():
        yield from _estimator(name, method, sonar, rows, rng)
    yield from _windows(sonar, rows, rng)
    yield from _engine()


def _patches(sonar: Sonar, rows: int) -> Iterator[Sweep]:
    def case(rows: int, samples: int) -> Case:
        return lambda: _patch(sonar, rows, samples, np.random.default_rng(1))

    yield Sweep("patch", "samples", SAMPLES, [case(rows, n) for n in SAMPLES], n_log_n(SAMPLES), 1)
    yield Sweep("patch", "rows", ROWS, [case(n, RECORD) for n in ROWS], 1 + PAGES, 1)


def _patch(sonar: Sonar, rows: int, samples: int, rng: np.random.Generator) -> EchoPair:
    return speckle_pair(
        (rows, samples),
        coherence=0.9,
        delay=0.1 * sonar.wrap,
        centre_frequency=sonar.centre_frequency,
        bandwidth=sonar.bandwidth,
        sample_rate=4 / 3 * sonar.bandwidth,
        rng=rng,
    )


def _scenes(sonar: Sonar, rows: int) -> Iterator[Sweep]:
    near = 20.0

    def case(scene: Scene, rows: int, **chosen: Any) -> tuple[int, Case]:
        required = plan(scene, sonar, snr=15.0, rows=rows, **chosen)

        def work() -> EchoPair:
            return simulate(scene, sonar, rng=np.random.default_rng(1), snr=15.0, rows=rows, required=required)

        return required.grid.samples, work

    def in_blocks(scene: Scene, rows: int) -> Case:
        required = plan(scene, sonar, snr=15.0, rows=rows)

        def work() -> None:
            made = echo_blocks(
                scene, sonar, rng=np.random.default_rng(1), snr=15.0, rows=rows, required=required, block=16
            )
            for _ in made:
                pass

        return work

    scenes = [Scene((near, near + length)) for length in LENGTHS]
    short = scenes[0]
    furrowed = Scene(short.ground_range, (TrawlMark(30.0, 30.0),))
    for delays in ("scatterers", "warp"):
        stage = f"scene, {delays}"
        sizes, cases = zip(*(case(scene, 4 * rows, delays=delays) for scene in scenes), strict=True)
        # Scatterers outweigh the transforms of what they add up to.
        grows = 1.0 if delays == "scatterers" else n_log_n(sizes)
        yield Sweep(stage, "samples", sizes, cases, grows, 1)
        yield Sweep(stage, "rows", BATCHES, [case(short, n, delays=delays)[1] for n in BATCHES], 1, 1)
    dense = [case(short, 4 * rows, delays="scatterers", scatterers_per_resolution=float(n))[1] for n in DENSITIES]
    yield Sweep("scene, scatterers", "scatterers", DENSITIES, dense, 1, 1)
    # The most that one row holds is none of what rows have each.
    some = ROWS[1:]
    each = [case(furrowed, n)[1] for n in some]
    yield Sweep("scene, a section for each row", "rows", some, each, 1, 1)
    yield Sweep("scene, in blocks of rows", "rows", BATCHES, [in_blocks(short, n) for n in BATCHES], 1, 0)


Method = Callable[[WindowPolicy, float], Estimator]

METHODS: Mapping[str, Method] = {
    "interferogram": lambda window, search: Interferogram(window),
    "cross-correlation": lambda window, search: CrossCorrelation(window, search=search),
    "maximum-likelihood": lambda window, search: MaximumLikelihood(window, search=search),
    "phase-slope": lambda window, search: FullBandPhaseSlope(window, search=search),
    "split-spectrum": lambda window, search: SplitSpectrum(window),
    "multi-chromatic": lambda window, search: MultiChromatic(window),
    "two-window": lambda window, search: TwoWindow(CrossCorrelation(window, search=search)),
    "combined-neighbours": lambda window, search: CombinedNeighbours(CrossCorrelation(window, search=search)),
}
"""With a window and the largest delay to look for [s]."""

LAGS: Mapping[str, int] = {"cross-correlation": 4, "maximum-likelihood": 4, "phase-slope": 32}
"""Lags in `1 / B` of those whose search is varied."""


def _estimator(name: str, method: Method, sonar: Sonar, rows: int, rng: np.random.Generator) -> Iterator[Sweep]:
    def case(rows: int, samples: int, window: WindowPolicy, resolutions: float = 1.0) -> Case:
        pair = _patch(sonar, rows, samples, rng)
        estimator = method(window, resolutions / sonar.bandwidth)
        return lambda: estimator.estimate(pair)

    usual = FixedWindow(1, WINDOW)
    yield Sweep(name, "samples", SAMPLES, [case(1, n, usual) for n in SAMPLES], 1, None)
    yield Sweep(name, "rows", ROWS, [case(n, RECORD, usual) for n in ROWS], 1, None)
    in_time = [case(4 * rows, RECORD, FixedWindow(1, n)) for n in WINDOWS]
    # Where larger windows are accurate enough, neighbours are not asked.
    flat = None if name == "combined-neighbours" else 0
    yield Sweep(name, "window in time", WINDOWS, in_time, flat, 0)
    if name in LAGS:
        lags = [2 * LAGS[name] * n + 1 for n in SEARCHES]
        grows = 1 + CACHES if name == "phase-slope" else 1.0
        yield Sweep(name, "lags", lags, [case(4 * rows, RECORD, usual, n) for n in SEARCHES], grows, None)


def _windows(sonar: Sonar, rows: int, rng: np.random.Generator) -> Iterator[Sweep]:
    """Windows along track, and windows of eight sizes that vary with range."""

    def case(pair: EchoPair, method: Method, window: WindowPolicy) -> Case:
        estimator = method(window, 1 / sonar.bandwidth)
        return lambda: estimator.estimate(pair)

    tall, flat = _patch(sonar, TALL, RECORD, rng), _patch(sonar, 4 * rows, RECORD, rng)
    for name in ("interferogram", "cross-correlation"):
        method = METHODS[name]
        sizes = [n for n in WINDOWS if n <= TALL]
        along = [case(tall, method, FixedWindow(n, 1)) for n in sizes]
        # Blocks of the search hold eight windows, up to a limit.
        yield Sweep(name, "window along track", sizes, along, 0, 0 if name == "interferogram" else None)
        steps = [np.repeat(np.ceil(n * np.arange(1, 9) / 8), RECORD // 8).astype(np.int64) for n in WINDOWS]
        varying = [case(flat, method, VaryingWindow(np.ones_like(step), step)) for step in steps]
        yield Sweep(f"{name}, window varies", "window in time", WINDOWS, varying, 0, 0)


def _engine() -> Iterator[Sweep]:
    """Trials in small blocks, with what it takes to store and merge them; jobs with blocks of the size advised."""
    point = {"patch.snr": [5], "patch.looks": [33], "sonar.bandwidth": ["30 kHz"]}
    study = catalogue.study("wrap-errors").with_values(point)

    def case(blocks: int, block: int, jobs: int) -> Case:
        work = study.with_values({"trials.count": blocks * block, "trials.block": block})

        def run() -> object:
            with tempfile.TemporaryDirectory() as folder:
                engine.run(work, engine.Run(jobs=jobs), Path(folder))
                return report.result(work, engine.store_of(work, 2026, Path(folder))).table

        return run

    few = 25
    yield Sweep("engine", "trials", [n * few for n in BLOCKS], [case(n, few, 1) for n in BLOCKS], 1, 0)
    jobs = list(takewhile(lambda n: n <= (os.cpu_count() or 1), (1, 2, 4, 8, 16, 32)))
    if len(jobs) > 1:
        many = [case(24 * jobs[-1], 500, n) for n in jobs]
        yield Sweep("engine", "jobs", jobs, many, SERIAL - 1, None, clock=perf_counter)
