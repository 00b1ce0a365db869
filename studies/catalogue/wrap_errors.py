"""How often the wrong wrap, and how far from the bound: homogeneous patches over SNR, looks and bandwidth."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import product
from types import MappingProxyType
from typing import ClassVar

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from estimators import CrossCorrelation, Estimator, FixedWindow, FullBandPhaseSlope, SplitSpectrum
from sim import checks, speckle_pair
from studies import figures
from studies.measure import attempt, expected, measured
from studies.study import Block, Point, Traces

METHODS: Mapping[str, Callable[[FixedWindow], Estimator]] = MappingProxyType(
    {
        "cross-correlation": CrossCorrelation,
        "split-spectrum": SplitSpectrum,
        "phase-slope": FullBandPhaseSlope,
    }
)


@dataclass(frozen=True)
class WrapErrors:
    """Wrap-error rate and spread of every estimator on homogeneous speckle.

    Each trial is a periodic record of as many independent samples as looks, of one delay drawn evenly within half a
    wrap, and the window is the whole record: the looks are exact.

    Parameters
    ----------
    centre_frequency
        `fc` [Hz]; only ratios to it matter.
    snr
        Signal-to-noise ratios of either receiver [dB].
    looks
        Independent looks in the window.
    relative_bandwidth
        `B / fc`.
    trials, block_trials
        Trials at each design point, and in one block.
    """

    name: ClassVar[str] = "wrap-errors"
    question: ClassVar[str] = (
        "How often does each estimator pick the wrong wrap, and how near the bound is it otherwise?"
    )
    axes: ClassVar[frozenset[str]] = frozenset({"snr", "looks", "relative_bandwidth", "trials"})

    centre_frequency: float = 100e3
    snr: tuple[float, ...] = tuple(float(x) for x in range(-6, 27, 2))
    looks: tuple[int, ...] = (9, 33, 81)
    relative_bandwidth: tuple[float, ...] = (0.1, 0.3, 0.6)
    trials: int = 20_000
    block_trials: int = 4_000

    def __post_init__(self) -> None:
        checks.positive("centre_frequency", self.centre_frequency, "Hz")
        checks.count("trials", self.trials)
        checks.count("block_trials", self.block_trials)
        for snr in self.snr:
            checks.finite("snr", snr, "dB")
        for looks in self.looks:
            checks.count("looks", looks, least=3)
        for width in self.relative_bandwidth:
            checks.within("relative_bandwidth", width, 1e-3, 1.9)

    def quick(self) -> "WrapErrors":
        """Seven SNRs, 2,000 trials."""
        return replace(self, snr=self.snr[1:-2:2], trials=2_000, block_trials=2_000)

    def points(self) -> Sequence[Point]:
        """Every SNR with every number of looks and relative bandwidth."""
        return [
            {"snr_db": float(snr), "looks": int(looks), "relative_bandwidth": float(width)}
            for width, looks, snr in product(self.relative_bandwidth, self.looks, self.snr)
        ]

    def methods(self) -> Mapping[str, Callable[[FixedWindow], Estimator]]:
        """Methods that resolve the wrap, each refined by its phase."""
        return METHODS

    def measure(self, point: Point, methods: Sequence[str], trials: int, rng: np.random.Generator) -> Block:
        """Estimate the delay of each record once."""
        looks, snr = point["looks"], 10 ** (point["snr_db"] / 10)
        coherence = snr / (1 + snr)
        bandwidth = point["relative_bandwidth"] * self.centre_frequency
        pair = speckle_pair(
            (trials, looks),
            coherence=coherence,
            delay=rng.uniform(-0.5, 0.5, trials) / self.centre_frequency,
            centre_frequency=self.centre_frequency,
            bandwidth=bandwidth,
            sample_rate=bandwidth,
            rng=rng,
        )
        assert pair.truth is not None
        window = FixedWindow(1, looks)
        measurements = []
        for name in methods:
            made = attempt(METHODS[name](window), pair)
            errors = made.delay[:, :1] - pair.truth.delay
            facts = expected(name, looks, coherence, self.centre_frequency, bandwidth)
            labels = {"estimator": name, "window": str(window)}
            measurements.append(measured(labels, facts, errors, 0.5 / bandwidth, made))
        return Block(measurements, {})

    def summary(self, table: pd.DataFrame) -> pd.DataFrame:
        """Wrap rate with its prediction, and STD over CRLB, at the middle bandwidth and a few SNRs."""
        width = self.relative_bandwidth[len(self.relative_bandwidth) // 2]
        rows = table[
            np.isclose(table.relative_bandwidth, width) & table.snr_db.isin(self.snr[:: max(len(self.snr) // 3, 1)])
        ]
        return pd.DataFrame(
            {
                "B/fc": rows.relative_bandwidth,
                "looks": rows.looks.astype(int),
                "SNR dB": rows.snr_db,
                "estimator": rows.estimator,
                "wrap rate": rows.wrap_rate,
                "from": rows.wrap_rate_low,
                "to": rows.wrap_rate_high,
                "predicted": rows.predicted_wrap_rate,
                "STD/CRLB": rows.std_over_crlb,
            }
        )

    def figures(self, table: pd.DataFrame, traces: Sequence[tuple[Point, Traces]]) -> Mapping[str, Figure]:
        """Wrap-error rate and STD over CRLB against SNR, a panel for each number of looks and bandwidth.

        Bars are 95 % intervals; lines in the wrap rates are predictions. Points on the floor saw no wrap error.
        """
        return {
            "wrap-rate": self._panels(
                table, "wrap-error rate", "lines: predicted; bars: 95 % intervals; on the floor: none seen", _wrap_rates
            ),
            "std-over-crlb": self._panels(
                table, "in-wrap STD / CRLB", "bars: 95 % intervals; black line: the bound", _spreads
            ),
        }

    def _panels(
        self, table: pd.DataFrame, quantity: str, legend: str, draw: Callable[[Axes, pd.DataFrame, int, str], None]
    ) -> Figure:
        figure, axes = figures.grid(len(self.looks), len(self.relative_bandwidth))
        for line, looks in zip(axes, self.looks, strict=True):
            for panel, width in zip(line, self.relative_bandwidth, strict=True):
                here = table[(table.looks == looks) & np.isclose(table.relative_bandwidth, width)]
                for number, (name, rows) in enumerate(here.groupby("estimator", sort=False)):
                    draw(panel, rows, number, str(name))
                panel.set_title(f"{looks} looks, B/fc = {width:g}", fontsize=10)
        for line in axes:
            line[0].set_ylabel(quantity)
        for panel in axes[-1]:
            panel.set_xlabel("SNR [dB]")
        handles, labels = axes[0][0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside lower center", ncols=len(handles), title=legend, fontsize=9)
        return figure


def _offset(number: int) -> float:
    """Shift of an estimator's points along the SNR [dB], to keep their intervals apart."""
    return 0.35 * (number - 1)


def _wrap_rates(panel: Axes, rows: pd.DataFrame, number: int, name: str) -> None:
    colour, floor = figures.COLOURS[number], 0.2 / rows.trials.max()
    panel.plot(rows.snr_db, rows.predicted_wrap_rate, color=colour, linewidth=1, linestyle=figures.LINES[number])
    snr = rows.snr_db + _offset(number)
    # Without a wrap error only the upper end of the interval is known.
    rate = rows.wrap_rate.where(rows.wrap_errors > 0, floor)
    panel.vlines(snr, rows.wrap_rate_low.clip(lower=floor), rows.wrap_rate_high, color=colour, linewidth=1)
    panel.plot(snr, rate, figures.MARKERS[number], color=colour, markersize=4, label=name)
    panel.set_yscale("log")
    panel.set_ylim(floor, 1.2)


def _spreads(panel: Axes, rows: pd.DataFrame, number: int, name: str) -> None:
    panel.errorbar(
        rows.snr_db + _offset(number),
        rows.std_over_crlb,
        1.96 * rows.std_over_crlb_se,
        color=figures.COLOURS[number],
        marker=figures.MARKERS[number],
        markersize=4,
        linewidth=1,
        capsize=2,
        label=name,
    )
    panel.axhline(1.0, color="black", linewidth=0.8)
    panel.set_ylim(0.6, 1.6)
