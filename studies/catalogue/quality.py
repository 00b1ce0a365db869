"""Which metric tells estimates in the right wrap from outliers, on paper A's scene and on a homogeneous patch."""

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from estimators import CrossCorrelation, FixedWindow, FullBandPhaseSlope, bounds
from estimators.quality import METRICS, roc_area
from sim import Box, EchoPair, Scene, Sonar, Wedge, simulate, speckle_pair
from studies import figures
from studies.drawing import Examples
from studies.scene_readings import clear

SNR = 15.0
"""Of paper A's noisy figure [dB]."""

SCENE = Scene((15.0, 215.0), (Box(35, 5, 2), Box(70, 8, 2.5), Box(110, 10, 3), Wedge(165, 20, 2)))
"""That of the study `box-scene`."""

ESTIMATORS: Mapping[str, FullBandPhaseSlope | CrossCorrelation] = {
    "phase-slope 1x1": FullBandPhaseSlope(),
    "cross-correlation 1x5": CrossCorrelation(FixedWindow(1, 5)),
}
"""What is judged: paper A's single pixels, half of them wrong, and a small window, of which one in twenty is."""

WINDOWS = tuple(FixedWindow(1, samples) for samples in (1, 5, 9, 17))
"""From which the metrics judge, if they hold the estimator's own."""


def measure(sonar: Sonar, rows: int, rng: np.random.Generator) -> pd.DataFrame:
    """Area under the ROC of each metric, for each scene, estimator and window; standard errors between rows."""
    patch = speckle_pair(
        (rows, 2048),
        coherence=float(bounds.coherence_from_snr(10 ** (SNR / 10))),
        delay=0.3 / sonar.bandwidth,
        centre_frequency=sonar.centre_frequency,
        bandwidth=sonar.bandwidth,
        sample_rate=4 / 3 * sonar.bandwidth,
        rng=rng,
    )
    boxes = simulate(SCENE, sonar, rng=rng, snr=SNR, rows=rows)
    pairs = {"patch": patch, "boxes, outside layover": boxes}
    return pd.DataFrame(
        [
            {"scene": scene, "estimator": name, **row}
            for scene, pair in pairs.items()
            for name in ESTIMATORS
            for row in _areas(pair, ESTIMATORS[name])
        ]
    )


def _areas(pair: EchoPair, estimator: FullBandPhaseSlope | CrossCorrelation) -> Iterator[dict[str, Any]]:
    assert pair.truth is not None
    estimate = estimator.estimate(pair)
    seen = slice(None) if pair.truth.branches is None else clear(pair, WINDOWS[-1])
    right = (np.abs(estimate.delay - pair.truth.delay) < 0.5 / pair.centre_frequency)[:, seen]
    own = estimator.window
    assert isinstance(own, FixedWindow)
    for window in (w for w in WINDOWS if w.samples >= own.samples):
        for name, metric in METRICS.items():
            yield {"metric": name, "window": str(window), **_area(metric(pair, estimate, window)[:, seen], right)}
    yield {"metric": "quality of the estimate", "window": "", **_area(estimate.quality[:, seen], right)}


def _area(metric: Any, right: Any) -> dict[str, float]:
    area, single = roc_area(metric, right)
    # Neighbouring pixels depend on each other, rows do not.
    parts = [roc_area(m, r)[0] for m, r in zip(np.array_split(metric, 5), np.array_split(right, 5), strict=True)]
    return {
        "right": float(right.mean()),
        "pixels": right.size,
        "area": area,
        "area_se": max(float(np.nanstd(parts, ddof=1) / np.sqrt(len(parts))), single),
    }


def answer(table: pd.DataFrame) -> str:
    """The best metric of a pixel alone and with its neighbours, and that of the estimate itself."""
    said = []
    for (scene, name), rows in table.groupby(["scene", "estimator"], sort=False):
        judged = rows[rows.window != ""].sort_values("area", ascending=False).drop_duplicates("window")[::-1]
        best = judged.itertuples()
        each = ", ".join(f"{row.metric} {row.area:.4f} ± {row.area_se:.4f} from {row.window}" for row in best)
        own = rows[rows.window == ""].iloc[0]
        said.append(f"{scene}, {name} ({own.right:.1%} right): {each}; the estimate's own quality {own.area:.4f}")
    return f"Area under the ROC of the best metric: {'. '.join(said)}."


def figure(table: pd.DataFrame, examples: Examples) -> Figure:
    """A bar for each metric and window, a panel for each scene and estimator."""
    scenes, names = list(pd.unique(table.scene)), list(pd.unique(table.estimator))
    drawn, axes = figures.grid(len(scenes), len(names), width=5.4, height=3.4)
    metrics = list(METRICS)
    for line, scene in zip(axes, scenes, strict=True):
        for panel, name in zip(line, names, strict=True):
            rows = table[(table.scene == scene) & (table.estimator == name)]
            for number, window in enumerate(str(w) for w in WINDOWS):
                of_window = rows[rows.window == window].set_index("metric")
                if of_window.empty:
                    continue
                place = np.arange(len(metrics)) + 0.2 * (number - 1.5)
                area = of_window.area.reindex(metrics)
                panel.bar(place, area, 0.19, color=figures.COLOURS[number], label=f"from {window}")
                panel.errorbar(place, area, 1.96 * of_window.area_se.reindex(metrics), fmt="none", ecolor="black")
            panel.axhline(0.5, color="black", linewidth=0.8)
            own = rows[rows.window == ""].area.iloc[0]
            panel.axhline(own, color="black", linewidth=1.2, linestyle=":", label="quality of the estimate")
            panel.set_title(f"{scene}; {name}", fontsize=10)
            panel.set_xticks(np.arange(len(metrics)), [metric.replace("_", " ") for metric in metrics], rotation=25)
            panel.set_ylim(0.4, 1.02)
        line[0].set_ylabel("area under the ROC")
    handles, labels = axes[0][0].get_legend_handles_labels()
    drawn.legend(
        handles, labels, loc="outside lower center", ncols=5, title="black lines on bars: 95 % intervals", fontsize=9
    )
    return drawn
