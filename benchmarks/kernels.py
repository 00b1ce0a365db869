"""What the estimators' kernels cost, against what they replace: all ratios are of one run.

Run it alone on a quiet machine: `.venv/bin/python benchmarks/kernels.py`. Everything runs on one thread, but where
two are named. Times are the least of several, taken in turns, so that a busy moment strikes all alike. Memory that is
freed stays with the process, as in every run of a study (`studies.allocation`).
"""

import time
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
import scipy.fft
from numpy.typing import NDArray
from scipy.ndimage import uniform_filter
from skimage.registration import phase_cross_correlation

from estimators import CrossCorrelation, FixedWindow, FullBandPhaseSlope
from estimators.interference import interferogram
from estimators.lag_product import LagStack, lag_series, power
from estimators.moving_sum import product_sum, window_sum
from estimators.peak import Peak
from estimators.peak_kernels import strongest
from estimators.search import over_times
from sim import EchoPair
from studies.allocation import keep_freed_memory
from studies.parallel import one_thread

REPEATS = 15
IMAGE = 1000, 2000
SAMPLES, WINDOW, LAGS = 100_000, 64, 8
SLOPE_SAMPLES = 512

Numbers = NDArray[Any]
Case = Callable[[], object]


def seconds(cases: Mapping[str, Case], repeats: int = REPEATS) -> dict[str, float]:
    """Least time of each case."""
    least = dict.fromkeys(cases, np.inf)
    for case in cases.values():
        case()
    for _ in range(repeats):
        for name, case in cases.items():
            start = time.perf_counter()
            case()
            least[name] = min(least[name], time.perf_counter() - start)
    return least


def line(what: str, ratio: float, bound: str) -> None:
    """One figure with what is asked of it."""
    print(f"  {what:76s} {ratio:12,.2f}   {bound}")


def images(rng: np.random.Generator) -> tuple[Numbers, Numbers]:
    """Speckle of coherence 0.9, complex64."""
    first, other = rng.normal(size=(2, *IMAGE)) + 1j * rng.normal(size=(2, *IMAGE))
    return first.astype(np.complex64), (0.9 * first + np.sqrt(1 - 0.81) * other).astype(np.complex64)


def interferograms(rng: np.random.Generator) -> None:
    """Moving windows over an image."""
    primary, secondary = images(rng)
    product = primary.conj() * secondary
    planes = [product.real, product.imag, np.abs(primary) ** 2, np.abs(secondary) ** 2]
    single, double = ([np.ascontiguousarray(plane, dtype=kind) for plane in planes] for kind in (np.float32, float))
    rows, samples = 1 + np.arange(IMAGE[1]) * 38 // IMAGE[1], 39 - np.arange(IMAGE[1]) * 38 // IMAGE[1]

    def varying() -> None:
        product_sum(primary, secondary, rows, samples, circular=False)
        window_sum(power(primary) + 1j * power(secondary), rows, samples, circular=False)

    took = seconds(
        {
            "copy": lambda: (primary.copy(), secondary.copy()),
            "9 x 9": lambda: interferogram(primary, secondary, 9, 9, circular=False),
            "39 x 39": lambda: interferogram(primary, secondary, 39, 39, circular=False),
            "two threads": lambda: interferogram(primary, secondary, 9, 9, circular=False, threads=2),
            "single": lambda: [uniform_filter(plane, 9) for plane in single],
            "double": lambda: [uniform_filter(plane, 9) for plane in double],
            "varying": varying,
        }
    )
    nine, pixels = took["9 x 9"], IMAGE[0] * IMAGE[1]
    print(f"interferogram with coherence, {IMAGE[0]} x {IMAGE[1]} complex64: {1e9 * nine / pixels:.2f} ns at 9 x 9")
    line("four uniform filters of single precision / 9 x 9", took["single"] / nine, "at least 5")
    line("four uniform filters of double precision / 9 x 9", took["double"] / nine, "")
    line("9 x 9 / copy of both images", nine / took["copy"], "at most 5")
    line("39 x 39 / 9 x 9", took["39 x 39"] / nine, "at most 1.2")
    line("one thread / two", nine / took["two threads"], "")
    line("window varying with range from 1 x 39 to 38 x 2 / copy", took["varying"] / took["copy"], "")
    line("window varying with range, ns a pixel", 1e9 * took["varying"] / pixels, "")
    line("phase error beside a pixel 80 dB brighter [rad / 1e-6]", bright_error(rng) / 1e-6, "at most 1")


def bright_error(rng: np.random.Generator) -> float:
    """Largest phase error of a 9 x 9 interferogram in double precision around a pixel 80 dB brighter [rad]."""
    pair = rng.normal(size=(2, 200, 400)) + 1j * rng.normal(size=(2, 200, 400))
    pair[1] += 2 * pair[0]
    pair[:, 100, 200] *= 1e4
    found, _ = interferogram(*pair, 9, 9, circular=False)
    tiles = np.lib.stride_tricks.sliding_window_view(pair[0].conj() * pair[1], (9, 9))
    exact = tiles.astype(np.clongdouble).sum(axis=(-2, -1))
    return float(np.abs(np.angle(found[4:-4, 4:-4] * exact.conj())).max())


def batched_fft(primary: Numbers, secondary: Numbers) -> Numbers:
    """Lag of the highest correlation of each window of the primary with that of the secondary."""
    first, second = (
        scipy.fft.fft(np.lib.stride_tricks.sliding_window_view(series, WINDOW), 2 * WINDOW, axis=-1)
        for series in (primary, secondary)
    )
    correlation = scipy.fft.ifft(first.conj() * second, axis=-1, overwrite_x=True)
    near = np.concatenate([correlation[:, -LAGS:], correlation[:, : LAGS + 1]], axis=1)
    return (near.real**2 + near.imag**2).argmax(axis=1) - LAGS


def search(primary: Numbers, secondary: Numbers) -> Numbers:
    """The same by lag products and moving sums, the lag split evenly between both series."""
    series = lag_series(primary[None], secondary[None], FixedWindow(1, WINDOW), 2, LAGS, 1.0)

    def find(stack: LagStack) -> Peak:
        lag = strongest(stack.products)
        return Peak(lag - LAGS, *(np.broadcast_to(0, lag.shape) for _ in range(4)))

    return over_times(series, find).delay[0]


def searches(rng: np.random.Generator) -> None:
    """Sliding windows over a series."""
    noise = rng.normal(size=(2, SAMPLES + WINDOW - 1)) + 1j * rng.normal(size=(2, SAMPLES + WINDOW - 1))
    # A quarter of the band that the sample rate holds, so that a lag is a sample.
    spectrum = scipy.fft.fft(noise, axis=-1) * (np.abs(scipy.fft.fftfreq(noise.shape[1])) < 1 / 8)
    first, other = scipy.fft.ifft(spectrum, axis=-1)
    second = 0.9 * np.roll(first, 3) + np.sqrt(1 - 0.81) * other
    pair = EchoPair(first[:SAMPLES], second[:SAMPLES], 4.0, 10 / 3, 1.0, circular=True)
    estimator = CrossCorrelation(FixedWindow(1, WINDOW), search=LAGS / 4.0)
    windows = [(first[i : i + WINDOW], second[i : i + WINDOW]) for i in range(0, 100 * WINDOW, WINDOW)]
    single = first.astype(np.complex64), second.astype(np.complex64)
    took = seconds(
        {
            "FFT": lambda: batched_fft(first, second),
            "FFT, single": lambda: batched_fft(*single),
            "search": lambda: search(first[:SAMPLES], second[:SAMPLES]),
            "estimate": lambda: estimator.estimate(pair),
            "skimage": lambda: [phase_cross_correlation(*both, upsample_factor=100) for both in windows],
        },
        repeats=7,
    )
    peer = took["skimage"] / len(windows)
    print(f"sliding search, {WINDOW} samples, {LAGS} lags either way, {SAMPLES:,} windows: the whole estimate takes")
    print(f"{1e9 * took['estimate'] / SAMPLES:.0f} ns a window, the search {1e9 * took['search'] / SAMPLES:.0f} ns")
    for kind in ("FFT", "FFT, single"):
        line(f"batched {kind} / search", took[kind] / took["search"], "at least 8")
        line(f"batched {kind} / whole estimate", took[kind] / took["estimate"], "at least 3")
    line("scikit-image / whole estimate, per window", peer / (took["estimate"] / SAMPLES), "at least 500")


def matrix_definition(primary: Numbers, secondary: Numbers, pixel: int, lags: int) -> Numbers:
    """Magnitude at each lag of one pixel's frequential cross-correlation matrix, summed against its phase slope."""
    frequencies = scipy.fft.fftfreq(SLOPE_SAMPLES)
    turn = np.exp(2j * np.pi * frequencies * pixel)
    matrix = np.outer((scipy.fft.fft(primary) * turn).conj(), scipy.fft.fft(secondary) * turn)
    both = frequencies[:, None] + frequencies[None]
    delays = np.linspace(-2, 2, lags)
    return np.abs([np.sum(matrix * np.exp(1j * np.pi * both * delay)) for delay in delays])


def slopes(rng: np.random.Generator) -> None:
    """Full-band phase slope, against the matrix at one pixel times the number of pixels."""
    primary, secondary = rng.normal(size=(2, SLOPE_SAMPLES)) + 1j * rng.normal(size=(2, SLOPE_SAMPLES))
    pair = EchoPair(primary, secondary, 1.0, 10 / 3, 1.0, circular=True)
    estimator, lags = FullBandPhaseSlope(), 2 * 2 * 32 + 1
    took = seconds({"estimate": lambda: estimator.estimate(pair)})["estimate"]
    matrix = seconds({"pixel": lambda: matrix_definition(primary, secondary, 100, lags)}, repeats=2)["pixel"]
    print(f"full-band phase slope, {SLOPE_SAMPLES} samples, {lags} lags: the whole estimate takes {1e3 * took:.1f} ms")
    line("matrix definition / whole estimate", matrix * SLOPE_SAMPLES / took, "at least 1,000")


def main() -> None:
    """Print the ratios."""
    keep_freed_memory()
    with one_thread():
        for part in (interferograms, searches, slopes):
            part(np.random.default_rng(1))


if __name__ == "__main__":
    main()
