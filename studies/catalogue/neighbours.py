"""How independent neighbouring estimates are, how sharp a step in height is, and what they gain when combined."""

from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.figure import Figure
from matplotlib.ticker import FixedLocator, NullLocator
from numpy.typing import NDArray

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
    bounds,
)
from sim import EchoPair, Sonar, speckle_pair
from sim.band import Real
from studies import figures
from studies.drawing import Examples

SNR = 15.0
"""Of paper A's noisy figure [dB]."""

SAMPLES, LAGS, STEP = 256, 48, 0.3
"""Samples of a row, largest lag of the autocorrelation, and the height of the step [wraps]."""

REQUESTED = (0.05, 0.03, 0.02, 0.01, 0.007, 0.005, 0.003)
"""Standard deviations that combined neighbours are to have [wraps]."""

PIXEL, NINE, MANY = FixedWindow(1, 1), FixedWindow(1, 9), FixedWindow(1, 33)

METHODS: Mapping[str, Estimator] = {
    "interferogram": Interferogram(PIXEL),
    "phase-slope": FullBandPhaseSlope(refine=False),
    "phase-slope-refined": FullBandPhaseSlope(),
    "two-window": TwoWindow(CrossCorrelation(MANY), PIXEL),
    "cross-correlation 9": CrossCorrelation(NINE),
    "cross-correlation": CrossCorrelation(MANY),
    "cross-correlation-group": CrossCorrelation(MANY, refine=False),
    "maximum-likelihood": MaximumLikelihood(MANY),
    "split-spectrum": SplitSpectrum(MANY),
    "multi-chromatic": MultiChromatic(MANY),
}
"""Single pixels, then windows of 9 and 33 samples."""

TO_COMBINE = ("phase-slope-refined", "cross-correlation 9")


def measure(sonar: Sonar, rows: int, rng: np.random.Generator) -> pd.DataFrame:
    """Autocorrelation of in-wrap errors, mean response to a step, and neighbours combined, in rows of `what`.

    Parameters
    ----------
    sonar
        Centre frequency, bandwidth and sound speed.
    rows
        Independent rows of speckle.
    rng
        The only source of chance.
    """
    level = _speckle(sonar, rows, rng)
    # Half a step below zero delay in the middle of the record, half a step above it to either side.
    before, after = (_delayed(level, sign * STEP / 2 * sonar.wrap) for sign in (1, -1))
    inner = np.abs(np.arange(SAMPLES) - SAMPLES // 2) < SAMPLES // 4
    stepped = replace(level, secondary=np.where(inner, after.secondary, before.secondary), truth=None)
    found = []
    for name, estimator in METHODS.items():
        labels = {"estimator": name.split()[0], "window": str(getattr(estimator, "window", PIXEL))}
        found += [{**labels, **row} for row in _autocorrelation(estimator, level, sonar)]
        found += [{**labels, **row} for row in _response(estimator, stepped, sonar)]
        if name in TO_COMBINE:
            found += [{**labels, **row} for row in _combined(estimator, level, sonar)]
    return pd.DataFrame(found)


def answer(table: pd.DataFrame) -> str:
    """Samples an independent estimate and the width of a step for each method; what combined neighbours reach."""
    said = []
    for (name, window), rows in table.groupby(["estimator", "window"], sort=False):
        spacing, width = rows.samples_per_estimate.max(), rows.step_width.max()
        said.append(f"{name} {window} {spacing:.1f} and {width:.1f}")
    combined = table[(table.what == "combined") & (table.estimator == "phase-slope-refined")]
    hundredth = combined[combined.x == 0.01].iloc[0]
    single = table[(table.what == "autocorrelation") & (table.estimator == "phase-slope-refined")].iloc[0]
    return (
        f"Samples an independent estimate, and samples in which a step rises from 10 to 90 %: {'; '.join(said)}. "
        f"Single pixels of the refined phase slope, {1 - single.wrap_rate:.0%} in the right wrap, are combined to a "
        f"spread of {hundredth['std']:.4f} wraps where 0.01 is asked for, {1 - hundredth.wrap_rate:.3%} in the right "
        f"wrap; that is reached at {hundredth.value:.1%} of pixels."
    )


def figure(table: pd.DataFrame, examples: Examples) -> Figure:
    """Autocorrelation, step response, and the spread reached against that asked for."""
    drawn, axes = figures.grid(1, 3, width=5.0, height=4.2, share_x=False, share_y=False)
    kinds = table[["estimator", "window"]].drop_duplicates()
    for number, (name, window) in enumerate(kinds.itertuples(index=False)):
        rows = table[(table.estimator == name) & (table.window == window)]
        style: dict[str, Any] = {
            "color": figures.COLOURS[number % len(figures.COLOURS)],
            # Some lie upon each other.
            "linestyle": ("-", "--", ":")[number % 3],
            "linewidth": 1.2,
            "label": f"{name} {window}",
        }
        for panel, what in zip(axes[0], ("autocorrelation", "step"), strict=False):
            line = rows[rows.what == what]
            panel.plot(line.x, line.value, **style)
            half = 1.96 * line.value_se
            panel.fill_between(
                line.x, line.value - half, line.value + half, color=style["color"], alpha=0.2, linewidth=0
            )
        combined = rows[rows.what == "combined"]
        if len(combined):
            axes[0][2].plot(combined.x, combined["std"], "o", color=style["color"], markersize=5, label=style["label"])
            axes[0][2].plot(combined.x, combined.claimed_std, color=style["color"], linewidth=1)
    _label(axes[0])
    handles, labels = axes[0][0].get_legend_handles_labels()
    drawn.legend(handles, labels, loc="outside lower center", ncols=4, fontsize=9)
    return drawn


def _label(axes: Any) -> None:
    words = (
        ("lag [samples]", "autocorrelation of in-wrap errors"),
        ("distance from the step [samples]", "mean delay over the step"),
        ("STD asked for [wraps]", "STD of combined neighbours [wraps]"),
    )
    for panel, (x, y) in zip(axes, words, strict=True):
        panel.set_xlabel(x)
        panel.set_ylabel(y)
    axes[0].set_title("bands: 95 % intervals", fontsize=10)
    axes[0].set_xlim(0, LAGS)
    axes[1].set_xlim(-LAGS, LAGS)
    ends = np.array([min(REQUESTED), max(REQUESTED)])
    axes[2].plot(ends, ends, color="black", linewidth=0.8)
    axes[2].set_xscale("log")
    axes[2].set_yscale("log")
    for axis in (axes[2].xaxis, axes[2].yaxis):
        axis.set_major_locator(FixedLocator([0.002, 0.005, 0.01, 0.02, 0.05]))
        axis.set_major_formatter("{x:g}")
        axis.set_minor_locator(NullLocator())
    axes[2].set_title("points: found; lines: claimed; black: as asked", fontsize=10)


def _speckle(sonar: Sonar, rows: int, rng: np.random.Generator) -> EchoPair:
    return speckle_pair(
        (rows, SAMPLES),
        coherence=float(bounds.coherence_from_snr(10 ** (SNR / 10))),
        delay=0.0,
        centre_frequency=sonar.centre_frequency,
        bandwidth=sonar.bandwidth,
        sample_rate=4 / 3 * sonar.bandwidth,
        rng=rng,
    )


def _delayed(pair: EchoPair, delay: float) -> EchoPair:
    frequencies = pair.centre_frequency + np.fft.fftfreq(pair.shape[1], 1 / pair.sample_rate)
    spectrum = np.fft.fft(pair.secondary) * np.exp(-2j * np.pi * frequencies * delay)
    return replace(pair, secondary=np.fft.ifft(spectrum))


def _autocorrelation(estimator: Estimator, pair: EchoPair, sonar: Sonar) -> Iterator[dict[str, Any]]:
    """Of the errors of pairs that are both in the right wrap, about zero, over the lag."""
    error = estimator.estimate(pair).delay / sonar.wrap
    right = np.abs(error) < 0.5
    held = np.where(right, error, 0.0)
    curve, ends = _curve(held, right, slice(None)), []
    for part in np.array_split(np.arange(len(held)), 10):
        ends.append(_curve(held, right, part))
    spread = np.std(ends, axis=0, ddof=1) / np.sqrt(len(ends))
    # Up to the first lag without correlation; beyond it there is only noise to add up.
    last = int(np.argmax(curve <= 0)) or len(curve)
    facts = {
        "wrap_rate": 1 - right.mean(),
        "std": float(error[right].std()),
        "samples_per_estimate": float(1 + 2 * curve[1:last].sum()),
    }
    for lag, (value, se) in enumerate(zip(curve, spread, strict=True)):
        yield {"what": "autocorrelation", "x": float(lag), "value": value, "value_se": se, **facts}


def _curve(held: Real, right: NDArray[np.bool_], rows: Any) -> Real:
    held, right = held[rows], right[rows]
    lags = [np.roll(held, -lag, axis=1) * held for lag in range(LAGS + 1)]
    both = [np.roll(right, -lag, axis=1) & right for lag in range(LAGS + 1)]
    means = np.array([product.sum() / max(pairs.sum(), 1) for product, pairs in zip(lags, both, strict=True)])
    curve: Real = means / means[0]
    return curve


def _response(estimator: Estimator, pair: EchoPair, sonar: Sonar) -> Iterator[dict[str, Any]]:
    """Mean over rows of the delays in the right wrap of the step, from 0 to 1 across it."""
    delay = estimator.estimate(pair).delay / sonar.wrap
    right = np.abs(delay) < 0.5
    mean = np.where(right, delay, 0.0).sum(axis=0) / np.maximum(right.sum(axis=0), 1)
    # Both flanks of the part in the middle, one turned round.
    half = np.arange(-LAGS, LAGS + 1)
    first = mean[SAMPLES // 4 + 1 + half]
    second = mean[3 * SAMPLES // 4 - 1 - half]
    response = -(first + second) / 2
    # Far from the step, where a single pixel's errors, cut at half a wrap, may make less than the whole of it.
    start, end = (response[part].mean() for part in (slice(0, LAGS // 2), slice(-LAGS // 2, None)))
    share = (response - start) / (end - start)
    width = _width(share, half)
    facts = {"wrap_rate": 1 - right.mean(), "step_width": width}
    for distance, value in zip(half, share, strict=True):
        yield {"what": "step", "x": float(distance), "value": value, **facts}


def _width(share: Real, places: NDArray[np.intp]) -> float:
    """From where a rising curve is below .1 for the last time to where it is then above .9 for the first [samples]."""
    low = int(np.flatnonzero(share < 0.1)[-1])
    high = low + int(np.argmax(share[low:] > 0.9))
    ends = [np.interp(level, share[[i, i + 1]], places[[i, i + 1]]) for level, i in ((0.1, low), (0.9, high - 1))]
    return float(ends[1] - ends[0])


def _combined(estimator: Estimator, pair: EchoPair, sonar: Sonar) -> Iterator[dict[str, Any]]:
    for requested in REQUESTED:
        combined = CombinedNeighbours(estimator, requested * sonar.wrap).estimate(pair)
        error, valid = combined.delay / sonar.wrap, combined.valid
        right = valid & (np.abs(error) < 0.5)
        claimed = combined.delay_std[right] / sonar.wrap
        yield {
            "what": "combined",
            "x": requested,
            "value": float(valid.mean()),
            "wrap_rate": 1 - right.sum() / max(valid.sum(), 1),
            "std": float(error[right].std()) if right.any() else np.nan,
            "claimed_std": float(np.sqrt(np.mean(claimed**2))) if right.any() else np.nan,
        }
