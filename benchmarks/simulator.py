"""What a scene costs to simulate: at full size, against its bare transforms, and what coarser settings lose.

`python benchmarks/simulator.py` simulates 80 million pixels, a few minutes on two cores; `--rows 200` a strip.
"""

import argparse
import resource
import statistics
from collections.abc import Callable
from dataclasses import replace
from time import perf_counter
from typing import NamedTuple

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
    return plan(SCENE, SONAR, rows=64, row_spacing=PIXEL, sample_spacing=PIXEL, **chosen)


class Bare(NamedTuple):
    """Seconds of one core for non-uniform FFTs of one row, planned beforehand: to a spectrum, and to a series."""

    to_spectrum: float
    to_series: float

    @property
    def full(self) -> float:
        """Of the full model, whatever is planned: scatterers at both receivers, the secondary and its noise."""
        return 2 * (self.to_spectrum + self.to_series)


def bare_transforms(made: Plan, repeats: int = 5) -> Bare:
    """Medians of the repeats, for all scatterers and all samples."""
    rng = np.random.default_rng(0)
    bins = int(SONAR.bandwidth * made.grid.period) | 1
    scatterers = int(400 / SONAR.range_resolution * made.scatterers_per_resolution)
    seconds = []
    for kind, points, finer in ((1, scatterers, 2.0), (2, made.grid.samples, 1.25)):
        transform = finufft.Plan(kind, (bins,), eps=made.accuracy, upsampfac=finer, nthreads=1)
        places = np.sort(rng.uniform(0, 2 * np.pi, points))
        values = rng.standard_normal(points if kind == 1 else bins) + 0j

        def step(transform=transform, places=places, values=values) -> None:
            transform.setpts(places)
            transform.execute(values)

        seconds.append(median_of(step, repeats))
    return Bare(*seconds)


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
    """Simulate rows in blocks; time, memory, and the ratio to the bare transforms before and after.

    Its own are, of a warp, one to a series, here of all samples though it moves those of the relief alone.
    """
    before = bare_transforms(made)
    start = perf_counter()
    pixels = 0
    for pair in echo_blocks(
        SCENE, SONAR, rng=np.random.default_rng(1), rows=rows, required=made, block=BLOCK, jobs=jobs
    ):
        pixels += pair.primary.size
    spent = perf_counter() - start
    after = bare_transforms(made)
    # Rows beyond the ends of blocks are transformed, too.
    executed = (rows + 2 * made.along_track.halo * -(-rows // BLOCK)) / jobs
    full = (before.full + after.full) / 2 * executed
    single = (before.to_series + after.to_series) / 2 * executed
    own = full if made.delays == "scatterers" else single
    print(
        f"{made.delays:<10} {pixels / 1e6:6.1f} Mpx  {jobs} threads  {spent:7.1f} s",
        f"{spent / pixels * 1e9:6.0f} ns a pixel  {spent / full:4.1f} times the bare transforms of the full model",
        f"{spent / own:4.1f} times its own  peak {peak_memory():.2f} GiB",
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
