"""What paper B's scene costs a pixel: simulation, both window filters with all that they predict, against a copy.

`python benchmarks/long_range.py` takes some blocks of the study `long-range`, `--blocks 20` its full size.
"""

import argparse
import resource
from collections.abc import Callable
from time import perf_counter, process_time
from typing import Any

from estimators import Interferogram
from studies import catalogue
from studies.design import methods, points, task
from studies.measure import echoes
from studies.parallel import one_thread


def timed(work: Callable[[], Any]) -> tuple[Any, float]:
    """What it gives, and the processor seconds that it takes."""
    start = process_time()
    return work(), process_time() - start


def main() -> None:
    """Print time a pixel and ratios to a copy of both images, for each SNR profile, and the peak of memory."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--blocks", type=int, default=2)
    blocks = parser.parse_args().blocks
    study = catalogue.study("long-range")
    filters = ["9x9", "AdaptiveWindow(kappa=2.0)"]
    with one_thread():
        for point in points(study):
            spent = dict.fromkeys(["copy", "simulation", *filters], 0.0)
            chosen = {m.labels[1]: m.window for m in methods(study, point) if m.labels[0] == "phase"}
            pixels, start = 0, 0.0
            # One block more, of which compiled code and tables are made.
            for block in range(blocks + 1):
                if block == 1:
                    spent, pixels, start = dict.fromkeys(spent, 0.0), 0, perf_counter()
                work = task(study, point, block)
                pair, seconds = timed(lambda work=work: echoes(work, study.trials.block, 2026))
                spent["simulation"] += seconds
                spent["copy"] += timed(lambda pair=pair: (pair.primary.copy(), pair.secondary.copy()))[1]
                for name in filters:
                    estimator = Interferogram(chosen[name])
                    spent[name] += timed(lambda pair=pair, estimator=estimator: estimator.estimate(pair))[1]
                pixels += pair.primary.size
            named = dict(point.varied)
            print(f"{'modelled' if 'scene.sediment' in named else 'paper'} SNR, {pixels / 1e6:.1f} Mpx with overlap:")
            for name, seconds in spent.items():
                print(f"  {name:26s} {1e9 * seconds / pixels:8.1f} ns a pixel {seconds / spent['copy']:8.1f} copies")
            both = sum(spent[name] for name in filters)
            print(f"  both filters / simulation  {both / spent['simulation']:8.2f}             at most 1")
            peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 2**20
            print(f"  wall time {perf_counter() - start:.1f} s, peak {peak:.2f} GiB")


if __name__ == "__main__":
    main()
