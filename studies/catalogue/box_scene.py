"""Paper A's figure 2: delays of a floor with three boxes and a triangular one, pixel by pixel and windowed."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import Any, ClassVar

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from estimators import (
    CrossCorrelation,
    Estimator,
    FixedWindow,
    FullBandPhaseSlope,
    Interferogram,
    SplitSpectrum,
)
from estimators.moving_sum import circular_sum
from sim import Box, EchoPair, Scene, Sonar, Wedge, checks, simulate
from sim.band import Real
from sim.simulate import time_grid
from studies import figures
from studies.measure import Attempt, attempt, expected, measured
from studies.study import Block, Measurement, Point, Traces

Method = Callable[[FixedWindow], Estimator]


def _phase_slope(**options: Any) -> Method:
    return lambda window: FullBandPhaseSlope(window, **options)


METHODS: Mapping[str, Method] = MappingProxyType(
    {
        "interferogram": Interferogram,
        "phase-slope": _phase_slope(refine=False),
        "phase-slope-refined": _phase_slope(),
        "phase-slope-strongest": _phase_slope(peak="strongest"),
        "cross-correlation": CrossCorrelation,
        "split-spectrum": SplitSpectrum,
    }
)

LIMIT = 4.0
"""Largest delay in the figures [wraps]."""

SINGLE_PIXEL = ("interferogram", "phase-slope", "phase-slope-refined", "phase-slope-strongest")

FEATURES = (Box(35.0, 5.0, 2.0), Box(70.0, 8.0, 2.5), Box(110.0, 10.0, 3.0), Wedge(165.0, 20.0, 2.0))


@dataclass(frozen=True)
class BoxScene:
    """The box scene of paper A, without noise and with.

    The paper gives the sonar, the altitude, the 200 m swath and the kinds of boxes; sizes and places of the boxes are
    assumed here.

    Parameters
    ----------
    centre_frequency, bandwidth
        `fc` and `B` [Hz].
    baseline, altitude
        `D` and `H` [m].
    near, far
        Ground range of the swath [m].
    snr
        Signal-to-noise ratio of the noisy case [dB].
    windows
        Lengths of the windows of the windowed methods [samples].
    trials, block_trials
        Rows of independent speckle, and rows in one block.
    """

    name: ClassVar[str] = "box-scene"
    question: ClassVar[str] = (
        "How good are single-pixel phase-slope delays of a seabed with boxes, and what do windows gain?"
    )
    axes: ClassVar[frozenset[str]] = frozenset({"snr", "trials"})

    centre_frequency: float = 100e3
    bandwidth: float = 30e3
    baseline: float = 0.3
    altitude: float = 15.0
    near: float = 15.0
    far: float = 215.0
    snr: float = 15.0
    windows: tuple[int, ...] = (9, 33, 81)
    trials: int = 200
    block_trials: int = 4

    def __post_init__(self) -> None:
        checks.count("trials", self.trials)
        checks.count("block_trials", self.block_trials)
        checks.finite("snr", self.snr, "dB")
        for window in self.windows:
            FixedWindow(1, window)
        if self.sonar.altitude <= self.scene.highest:
            raise ValueError(f"altitude is {self.altitude:g} m; it must be above the scene, {self.scene.highest:g} m")
        samples = time_grid(self.scene, self.sonar).samples
        for window in self.windows:
            if window > samples:
                raise ValueError(f"windows holds {window} samples; it must not exceed the series, {samples} samples")

    @property
    def sonar(self) -> Sonar:
        """The sonar of the study."""
        return Sonar(
            centre_frequency=self.centre_frequency,
            bandwidth=self.bandwidth,
            baseline=self.baseline,
            altitude=self.altitude,
        )

    @property
    def scene(self) -> Scene:
        """The scene of the study."""
        return Scene((self.near, self.far), FEATURES)

    def quick(self) -> "BoxScene":
        """16 rows."""
        return replace(self, trials=16, block_trials=2)

    def points(self) -> Sequence[Point]:
        """Without noise, and with."""
        return [{"snr_db": None}, {"snr_db": float(self.snr)}]

    def methods(self) -> Mapping[str, Method]:
        """All methods; those of a single pixel and those of a window."""
        return METHODS

    def measure(self, point: Point, methods: Sequence[str], trials: int, rng: np.random.Generator) -> Block:
        """Estimate all pixels of some rows."""
        pair = simulate(self.scene, self.sonar, rng=rng, snr=point["snr_db"], rows=trials)
        measurements, traces = [], _truth_traces(pair)
        for name in methods:
            for samples in (1,) if name in SINGLE_PIXEL else self.windows:
                window = FixedWindow(1, samples)
                made = attempt(METHODS[name](window), pair)
                traces[f"{name} {window}"] = made.delay[0]
                measurements += self._errors(point, pair, name, window, made)
        return Block(measurements, traces)

    def _errors(self, point: Point, pair: EchoPair, name: str, window: FixedWindow, made: Attempt) -> list[Measurement]:
        """Errors outside layover and in it; there, against the nearest of the parts that are heard at once."""
        truth = pair.truth
        assert truth is not None
        assert truth.branches is not None
        assert truth.layover is not None
        outside = made.delay - truth.delay
        deviations = made.delay[None] - truth.branches[:, None, :]
        nearest = np.nanargmin(np.where(np.isnan(deviations), np.inf, np.abs(deviations)), axis=0)
        inside = np.take_along_axis(deviations, nearest[None], axis=0)[0]
        snr = 10 ** (point["snr_db"] / 10) if point["snr_db"] is not None else np.inf
        coherence = 1 / (1 + 1 / snr)
        facts = {
            **expected(name, window.looks(pair), coherence, self.centre_frequency, self.bandwidth),
            "snr_db": 10 * np.log10(snr),
        }
        regions = {
            "outside": outside[:, clear(pair, window)],
            "layover": inside[:, truth.layover & np.isfinite(truth.branches).any(axis=0)],
        }
        labels = {"estimator": name, "window": str(window)}
        return [
            measured({**labels, "region": region}, facts, errors, 0.5 / self.bandwidth, made)
            for region, errors in regions.items()
        ]

    def summary(self, table: pd.DataFrame) -> pd.DataFrame:
        """Share in the right wrap, outliers, and spread within the wrap [wraps]."""
        short = pd.DataFrame(
            {
                "SNR dB": table.snr_db,
                "region": table.region,
                "estimator": table.estimator,
                "window": table.window,
                "right wrap": 1 - table.wrap_rate,
                "outliers": table.outlier_rate,
                "STD in wrap [wraps]": table.delay_std_in_wrap * self.centre_frequency,
            }
        )
        return short.sort_values(["SNR dB", "region"], ascending=False, kind="stable")

    def figures(self, table: pd.DataFrame, traces: Sequence[tuple[Point, Traces]]) -> Mapping[str, Figure]:
        """Paper A's four panels, and the same scene by windowed cross-correlation; one row of the along-track."""
        slopes = ("phase-slope 1x1", "phase-slope-refined 1x1")
        windowed = tuple(f"cross-correlation {FixedWindow(1, samples)}" for samples in self.windows)
        return {
            name: self._panels(traces, estimates)
            for name, estimates in (("phase-slope", slopes), ("cross-correlation", windowed))
            if all(estimate in found for _, found in traces for estimate in estimates)
        }

    def _panels(self, traces: Sequence[tuple[Point, Traces]], estimates: Sequence[str]) -> Figure:
        figure, axes = figures.grid(len(traces), len(estimates), width=5.2, height=3.0)
        for line, (point, found) in zip(axes, traces, strict=True):
            noise = "no noise" if point["snr_db"] is None else f"{point['snr_db']:g} dB SNR"
            for panel, estimate in zip(line, estimates, strict=True):
                self._panel(panel, found, estimate)
                panel.set_title(f"{noise}, {estimate}", fontsize=10)
            line[0].set_ylabel("delay x centre frequency [wraps]")
        for panel in axes[-1]:
            panel.set_xlabel("slant range [m]")
        handles, labels = axes[0][0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside lower center", ncols=4, markerscale=6, fontsize=9)
        return figure

    def _panel(self, panel: Axes, found: Traces, estimate: str) -> None:
        slant, cycles = found["slant range"], self.centre_frequency
        shown = {"interferogram": ("interferogram 1x1", "#2f6fff"), "estimate": (estimate, "black")}
        for number, branch in enumerate(found["truth"]):
            panel.plot(slant, branch * cycles, color="red", linewidth=2.5, label=None if number else "truth")
        for label, (key, colour) in shown.items():
            if key in found:
                panel.plot(
                    slant, found[key] * cycles, ".", color=colour, markersize=1.4, markeredgewidth=0, label=label
                )
        unseen = np.isnan(found["truth"]).all(axis=0)
        panel.fill_between(slant, -LIMIT, LIMIT, where=unseen, color="0.9", linewidth=0, zorder=0, label="shadow")
        panel.set_ylim(-LIMIT, LIMIT)


def clear(pair: EchoPair, window: FixedWindow) -> NDArray[np.bool_]:
    """Samples whose window, and a resolution cell to either side of it, holds neither shadow nor layover."""
    truth = pair.truth
    assert truth is not None
    reach = window.samples + 2 * int(np.ceil(pair.sample_rate / pair.bandwidth))
    seen: NDArray[np.bool_] = circular_sum(np.isnan(truth.delay).astype(float), reach) == 0
    return seen


def _truth_traces(pair: EchoPair) -> dict[str, Real]:
    truth, geometry = pair.truth, pair.geometry
    assert truth is not None
    assert truth.branches is not None
    assert geometry is not None
    return {"slant range": pair.grid.times * geometry.sonar.sound_speed / 2, "truth": truth.branches}
