"""What a scene costs to simulate: at full size, against its bare transforms, and what coarser settings lose.

`python benchmarks/simulator.py` simulates 80 million pixels, a few minutes on two cores; `--rows 200` a strip.
"""

import argparse
import resource
import statistics
from collections.abc import Callable
from dataclasses import replace
from time import perf_counter

import finufft
import numpy as np

from sim import SONARS, EchoPair, Plan, Scene, TrawlMark, echo_blocks, plan, simulate

SONAR = SONARS["hisas-1032"]
MARKS = (
    TrawlMark(90.0, 20.0, 0.15),
    TrawlMark(150.0, -35.0, 0.1),
    TrawlMark(220.0, 70.0, 0.2),
    TrawlMark(330.0, -10.0),
)
SCENE = Scene((42.0, 442.0), MARKS, sediment="coarse sand")
PIXEL = 0.02
BLOCK = 256


def at_pixels(**chosen: object) -> Plan:
    """The plan of the scene with samples and rows a pixel apart."""
    made = plan(SCENE, SONAR, rows=64, row_spacing=PIXEL, **chosen)
    grid = replace(made.grid, sample_rate=SONAR.sound_speed / (2 * PIXEL))
    samples = int(np.ceil(made.grid.period * grid.sample_rate))
    return replace(made, grid=replace(grid, samples=samples + samples % 2))


def bare_transforms(made: Plan, repeats: int = 5) -> float:
    """Seconds of one core for the non-uniform FFTs of one row: median of their repeats."""
    rng = np.random.default_rng(0)
    bins = int(SONAR.bandwidth * made.grid.period) | 1
    samples = made.grid.samples
    spectrum = rng.standard_normal(bins) + 0j
    at_samples = np.sort(rng.uniform(0, 2 * np.pi, samples))
    scatterers = int(400 / SONAR.range_resolution * made.scatterers_per_resolution)
    places, strengths = np.sort(rng.uniform(0, 2 * np.pi, scatterers)), rng.standard_normal(scatterers) + 0j

    def to_series() -> None:
        finufft.nufft1d2(at_samples, spectrum, eps=made.accuracy, nthreads=1)

    def to_spectrum() -> None:
        finufft.nufft1d1(places, strengths, bins, eps=made.accuracy, nthreads=1)

    # Scatterers: both receivers, the secondary and its noise registered. A warp: the secondary.
    steps = [(to_spectrum, 2), (to_series, 2)] if made.delays == "scatterers" else [(to_series, 1)]
    return sum(times * median_of(step, repeats) for step, times in steps)


def median_of(step: Callable[[], None], repeats: int) -> float:
    """Median seconds of a step, after one to warm up."""
    step()
    spent = []
    for _ in range(repeats):
        start = perf_counter()
        step()
        spent.append(perf_counter() - start)
    return statistics.median(spent)


def peak_memory() -> float:
    """Largest resident size of this process so far [GiB]."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 2**20


def at_size(rows: int, made: Plan, jobs: int) -> None:
    """Simulate rows in blocks; time, memory, and the ratio to the bare transforms before and after."""
    before = bare_transforms(made)
    start = perf_counter()
    pixels = 0
    for pair in echo_blocks(
        SCENE, SONAR, rng=np.random.default_rng(1), rows=rows, required=made, block=BLOCK, jobs=jobs
    ):
        pixels += pair.primary.size
    spent = perf_counter() - start
    executed = rows + 2 * made.along_track.halo * -(-rows // BLOCK)
    bare = (before + bare_transforms(made)) / 2 * executed / jobs
    print(
        f"{made.delays:<10} {pixels / 1e6:6.1f} Mpx  {jobs} threads  {spent:7.1f} s",
        f"{spent / pixels * 1e9:6.0f} ns a pixel  bare transforms {bare:6.1f} s",
        f"ratio {spent / bare:4.1f}  peak {peak_memory():.2f} GiB",
        flush=True,
    )


def errors() -> None:
    """Errors of coarser settings against 32 scatterers in a resolution, 1e-14 and double precision, with their time."""
    scene, rows = Scene((60.0, 160.0), (TrawlMark(100.0, 0.0, 0.15),)), 32
    reference = plan(scene, SONAR, delays="scatterers", accuracy=1e-14)
    exact = simulate(scene, SONAR, rng=np.random.default_rng(1), rows=rows, required=reference)
    for accuracy in (1e-12, 2e-7, 1e-6, 1e-4, 1e-2):
        coarse = replace(reference, accuracy=accuracy)
        report(f"accuracy {accuracy:g}", scene, coarse, exact)
    report("single", scene, replace(reference, single=True), exact)
    for density in (1.0, 2.0, 4.0, 8.0, 16.0):
        coarse = replace(reference, scatterers_per_resolution=density)
        pair = simulate(scene, SONAR, rng=np.random.default_rng(1), rows=400, required=coarse)
        power = np.mean(np.abs(pair.primary[:, np.isfinite(pair.truth.delay)]) ** 2, axis=0)
        # Of 400 exponential powers the mean scatters by 1 / 20 by itself.
        uneven = np.sqrt(max(power.var() / power.mean() ** 2 - 1 / 400, 0))
        seconds = median_of(lambda made=coarse: simulate(scene, SONAR, rng=np.random.default_rng(1), required=made), 5)
        print(
            f"{density:4g} scatterers in a resolution: mean power uneven by {uneven:.3f}, {seconds * 1e3:.1f} ms a row"
        )


def report(name: str, scene: Scene, made: Plan, exact: EchoPair) -> None:
    """Relative error of both series."""
    pair = simulate(scene, SONAR, rng=np.random.default_rng(1), rows=len(exact.primary), required=made)
    found = [
        np.linalg.norm(getattr(pair, channel) - getattr(exact, channel)) / np.linalg.norm(getattr(exact, channel))
        for channel in ("primary", "secondary")
    ]
    seconds = median_of(lambda: simulate(scene, SONAR, rng=np.random.default_rng(1), required=made), 5)
    print(f"{name:>15}: relative error {found[0]:.1e} and {found[1]:.1e}, {seconds * 1e3:.1f} ms a row", flush=True)


def main() -> None:
    """Print all."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--rows", type=int, default=4000)
    parser.add_argument("--jobs", type=int, default=2)
    given = parser.parse_args()
    made = at_pixels()
    estimated = sum(decision.seconds for decision in plan(SCENE, SONAR, rows=given.rows, row_spacing=PIXEL).decisions)
    print(f"planned for {given.rows} rows: {estimated / given.jobs:.1f} s on {given.jobs} cores")
    at_size(given.rows // 10, made, given.jobs)
    at_size(given.rows, made, given.jobs)
    at_size(given.rows, at_pixels(delays="scatterers"), given.jobs)
    errors()


if __name__ == "__main__":
    main()
