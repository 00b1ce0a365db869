"""Whether estimates know how good they are: claimed against found wrap errors, and the coverage of their intervals."""

from collections.abc import Callable, Iterator, Mapping
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from estimators import (
    CrossCorrelation,
    Estimator,
    FixedWindow,
    FullBandPhaseSlope,
    MaximumLikelihood,
    MultiChromatic,
    SplitSpectrum,
)
from estimators.posterior import NORMAL_95
from sim import Sonar, speckle_pair
from studies import figures
from studies.drawing import Examples

LOOKS = (5, 9, 15, 33, 81)
COHERENCES = (0.098, 0.29, 0.471, 0.634, 0.773, 0.882, 0.957, 0.995)
"""Even in the angle whose sine they are, the prior with which estimates doubt their wraps: claims hold over all
of these together."""
EDGES = np.array([0.0, 1e-3, 3e-3, 0.01, 0.03, 0.1, 0.2, 0.35, 0.5, 0.7, 0.9, 1.0])
"""Of the bins of claimed probability."""

METHODS: Mapping[str, Callable[[FixedWindow], Estimator]] = {
    "cross-correlation": CrossCorrelation,
    "cross-correlation-group": lambda window: CrossCorrelation(window, refine=False),
    "maximum-likelihood": MaximumLikelihood,
    "phase-slope": FullBandPhaseSlope,
    "split-spectrum": SplitSpectrum,
    "multi-chromatic": lambda window: MultiChromatic(window, bands=3),
}


def measure(sonar: Sonar, rows: int, rng: np.random.Generator) -> pd.DataFrame:
    """Counts in bins of the claimed probability, for each estimator, looks and coherence.

    The delay of each record is even within half a wrap of zero. Only bins that hold an estimate have a row; what
    belongs to all bins of a point, its `wrap_rate`, mean `claimed` probability and `coverage`, stands in each of them.
    """
    found: list[dict[str, Any]] = []
    for looks in LOOKS:
        for coherence in COHERENCES:
            delay = rng.uniform(-0.5, 0.5, rows) * sonar.wrap
            pair = speckle_pair(
                (rows, looks),
                coherence=coherence,
                delay=delay,
                centre_frequency=sonar.centre_frequency,
                bandwidth=sonar.bandwidth,
                sample_rate=sonar.bandwidth,
                rng=rng,
            )
            for name, method in METHODS.items():
                estimate = method(FixedWindow(1, looks)).estimate(pair)
                error = np.abs(estimate.delay[:, 0] - delay)
                covered = error <= NORMAL_95 * estimate.delay_std[:, 0]
                point = {"estimator": name, "looks": looks, "coherence": coherence}
                wrong = error > 0.5 * sonar.wrap
                found += [{**point, **row} for row in _bins(estimate.wrap_error_probability[:, 0], wrong, covered)]
    return pd.DataFrame(found)


def _bins(claimed: Any, wrong: Any, covered: Any) -> Iterator[dict[str, Any]]:
    right = ~wrong
    whole = {
        "wrap_rate": float(wrong.mean()),
        "claimed": float(claimed.mean()),
        "coverage": float(covered[right].mean()) if right.any() else np.nan,
        "right": int(right.sum()),
    }
    place = np.clip(np.searchsorted(EDGES, claimed, side="right") - 1, 0, len(EDGES) - 2)
    for number, chosen in enumerate(np.unique(place)):
        here = place == chosen
        yield {
            **whole,
            "bin": number,
            "low": EDGES[chosen],
            "high": EDGES[chosen + 1],
            "estimates": int(here.sum()),
            "claimed_in_bin": float(claimed[here].mean()),
            "wrong_in_bin": int(wrong[here].sum()),
        }


def pooled(table: pd.DataFrame) -> pd.DataFrame:
    """All looks and coherences together: claimed and found rate in each bin of each estimator, with its error."""
    weighted = table.assign(claimed=table.claimed_in_bin * table.estimates)
    sums = (
        weighted.groupby(["estimator", "low"], sort=False)[["estimates", "claimed", "wrong_in_bin"]].sum().reset_index()
    )
    rate = sums.wrong_in_bin / sums.estimates
    claimed = sums.claimed / sums.estimates
    error = np.sqrt(np.maximum(rate * (1 - rate), claimed * (1 - claimed)) / sums.estimates)
    return sums.assign(claimed=claimed, rate=rate, error=error).sort_values(["estimator", "low"])


def answer(table: pd.DataFrame) -> str:
    """Where intervals cover 93 to 97 %, and how far pooled rates are from what was claimed."""
    points, bins, said = table[table.bin == 0], pooled(table), []
    for name in pd.unique(table.estimator):
        rows = points[points.estimator == name]
        held = rows[rows.wrap_rate < 0.8]
        good = held.coverage.between(0.93, 0.97)
        of_bins = bins[(bins.estimator == name) & (bins.claimed > 1e-3) & (bins.estimates > 100)]
        ratio = of_bins.rate / of_bins.claimed
        said.append(
            f"{name}: 95 % intervals cover {rows.coverage.min():.3f} to {rows.coverage.max():.3f} of in-wrap errors, "
            f"{held.coverage.min():.3f} to {held.coverage.max():.3f} where fewer than .8 of the wraps are wrong (93 to "
            f"97 % at {good.mean():.0%} of these {len(held)} points); wraps are wrong {ratio.min():.2f} to "
            f"{ratio.max():.2f} times as often as claimed"
        )
    return ". ".join(said) + "."


def reliability(table: pd.DataFrame, examples: Examples) -> Figure:
    """Found against claimed wrap-error rate over all looks and coherences, a panel for each estimator."""
    bins, names = pooled(table), list(pd.unique(table.estimator))
    figure, axes = figures.grid(2, 3, width=3.6, height=3.2)
    for panel, name in zip([panel for line in axes for panel in line], names, strict=True):
        rows = bins[(bins.estimator == name) & (bins.claimed > 1e-4)]
        panel.plot([1e-4, 1], [1e-4, 1], color="black", linewidth=0.8)
        low = np.maximum(rows.rate - 1.96 * rows.error, 1e-5)
        panel.vlines(rows.claimed, low, rows.rate + 1.96 * rows.error, color=figures.COLOURS[0])
        panel.plot(rows.claimed, np.maximum(rows.rate, 1e-5), "o", color=figures.COLOURS[0], markersize=4)
        panel.set_xscale("log")
        panel.set_yscale("log")
        panel.set_xlim(1e-4, 1.3)
        panel.set_ylim(1e-4, 1.3)
        panel.set_title(name, fontsize=10)
    for line in axes:
        line[0].set_ylabel("found wrap-error rate")
    for panel in axes[-1]:
        panel.set_xlabel("claimed probability")
    figure.suptitle("All looks and coherences; bars: 95 % intervals", fontsize=10)
    return figure


def coverage(table: pd.DataFrame, examples: Examples) -> Figure:
    """Coverage of the 95 % intervals against the coherence, a line for each number of looks."""
    points, names = table[table.bin == 0], list(pd.unique(table.estimator))
    figure, axes = figures.grid(2, 3, width=3.6, height=3.0)
    for panel, name in zip([panel for line in axes for panel in line], names, strict=True):
        panel.axhspan(0.93, 0.97, color="0.9", zorder=0)
        panel.axhline(0.95, color="black", linewidth=0.8)
        for number, looks in enumerate(LOOKS):
            rows = points[(points.estimator == name) & (points.looks == looks)]
            error = 1.96 * np.sqrt(rows.coverage * (1 - rows.coverage) / rows.right)
            colour, marker = figures.COLOURS[number], figures.MARKERS[number]
            panel.errorbar(
                rows.coherence + 0.006 * (number - 2),
                rows.coverage,
                error,
                fmt=f"{marker}-",
                color=colour,
                markersize=3.5,
                linewidth=1,
                label=f"{looks} looks",
            )
        panel.set_ylim(0.85, 1.0)
        panel.set_title(name, fontsize=10)
    for line in axes:
        line[0].set_ylabel("coverage in the right wrap")
    for panel in axes[-1]:
        panel.set_xlabel("coherence")
    handles, labels = axes[0][0].get_legend_handles_labels()
    title = "grey: 93 to 97 %; bars: 95 % intervals"
    figure.legend(handles, labels, loc="outside lower center", ncols=5, title=title, fontsize=9)
    return figure
