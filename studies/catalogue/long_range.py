"""Paper B's figures 5 to 8 from simulated echoes, and what it leaves out: wrap errors, and the bias of coherence."""

from collections.abc import Iterator, Sequence

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from scipy.stats import binomtest

from estimators import Pixels, bounds
from estimators.window_sizes import side_of_constant_ratio
from sim.band import Real
from studies import figures
from studies.drawing import Examples

THRESHOLD = 0.5
"""Largest spread of a valid depth [m] (paper B)."""

OVER = 11
"""Bins over which a spread is averaged to find where it crosses the threshold."""

KAPPA, PIXEL, ALPHA = 2.0, 0.02, 0.4
"""Paper B's ratio of width and spread, size of a pixel [m] and looks in it."""

FIXED, ADAPTIVE = "9x9", f"AdaptiveWindow(kappa={KAPPA})"

SHORT = {FIXED: "fixed 9 x 9", ADAPTIVE: "adaptive", "Constant": "constant STD", "WrapSafe": "wrap-safe"}
"""What figures call the windows whose names begin so, in the order of their colours."""


def answer(table: pd.DataFrame) -> str:
    """Where either window crosses the threshold, predicted and measured, and the area gained."""
    said = []
    for name, rows in by_profile(table):
        phase = rows[rows.estimator == "phase"]
        fixed, adaptive = (phase[phase.window == window] for window in (FIXED, ADAPTIVE))
        reaches = [
            crossing(of_window.ground_range, spread)
            for of_window in (fixed, adaptive)
            for spread in (of_window.predicted_depth_std, error(of_window))
        ]
        near = fixed.ground_range.min()
        gained = (reaches[3] - near) / (reaches[1] - near) - 1
        at = adaptive[(adaptive.ground_range - 400).abs() < OVER / 2]
        measured = np.sqrt((error(at) ** 2).mean())
        said.append(
            f"{name}: 9 x 9 reaches {reaches[1]:.0f} m (predicted {reaches[0]:.0f}), adaptive {reaches[3]:.0f} m "
            f"(predicted {reaches[2]:.0f}), {gained:.0%} more; at 400 m {at.window_rows.mean():.1f} rows and "
            f"{100 * measured:.0f} cm (predicted {100 * at.predicted_depth_std.mean():.0f} cm)"
        )
    return f"With a depth STD of at most {100 * THRESHOLD:.0f} cm, {'; '.join(said)}."


def by_profile(table: pd.DataFrame) -> Iterator[tuple[str, pd.DataFrame]]:
    """The rows of either SNR profile, with its name."""
    modelled = table.sediment.notna()
    for name, chosen in (("modelled", modelled), ("paper", ~modelled)):
        if chosen.any():
            yield name, table[chosen]


def error(rows: pd.DataFrame) -> "pd.Series[float]":
    """Root mean square of the depth errors in the right wrap [m].

    It is the spread where there is no bias, and of few windows does not fall short, as their spread about their own
    mean does.
    """
    return (rows.depth_std_in_wrap**2 + (rows.delay_bias * rows.depth_per_delay) ** 2) ** 0.5


def crossing(ground_range: "pd.Series[float]", spread: "pd.Series[float]") -> float:
    """Ground range [m] up to which a spread is within the threshold, its median over some bins taken."""
    ordered = pd.Series(spread.to_numpy(), index=ground_range.to_numpy()).sort_index()
    within = (ordered.rolling(OVER, center=True, min_periods=1).median() <= THRESHOLD).to_numpy()
    if not within.any():
        return float(ordered.index[0])
    first = int(within.argmax())
    beyond = first + int(np.append(~within[first:], True).argmax())
    return float(ordered.index[min(beyond, len(ordered) - 1)])


def coherence(table: pd.DataFrame, examples: Examples) -> Figure:
    """Figure 5: coherence over range, as the window reads it, debiased, and true."""
    figure, axes = _over_range(table, "coherence")
    for (panel,), (_, rows) in zip(axes, by_profile(_phase(table)), strict=True):
        fixed = rows[rows.window == FIXED]
        lines = (
            ("sample_coherence", "9 x 9 sample"),
            ("debiased_coherence", "debiased"),
            ("coherence", "noise and baseline"),
        )
        for number, (column, label) in enumerate(lines):
            panel.plot(
                fixed.ground_range,
                fixed[column],
                color=figures.COLOURS[number],
                label=label,
                linewidth=1,
                linestyle="--" if column == "coherence" else "-",
            )
        panel.set_ylim(0, 1)
        panel.legend(fontsize=8)
    return figure


def std_and_bound(table: pd.DataFrame, examples: Examples) -> Figure:
    """Figure 6: measured STD of the fixed window, and the bound at the coherence that it reads."""
    figure, axes = _over_range(table, "depth STD [m]")
    for (panel,), (_, rows) in zip(axes, by_profile(_phase(table)), strict=True):
        fixed = rows[rows.window == FIXED]
        _measured(panel, fixed, 0, "measured, 9 x 9")
        panel.plot(fixed.ground_range, fixed.depth_crlb_sample, color=figures.COLOURS[1], linewidth=1, label="CRLB")
        panel.plot(
            fixed.ground_range,
            fixed.depth_crlb_debiased,
            ":",
            color=figures.COLOURS[1],
            label="CRLB, debiased coherence",
        )
        panel.set_ylim(0, 1.5)
        title = f"points: every metre, 95 % intervals\nsolid: median over {OVER} m"
        panel.legend(fontsize=8, loc="upper left", title=title, title_fontsize=8)
    return figure


def window_size(table: pd.DataFrame, examples: Examples) -> Figure:
    """Figure 7: rows that equation 7 asks for, and the odd ones that were used."""
    figure, axes = _over_range(table, "window M [pixels]")
    for (panel,), (_, rows) in zip(axes, by_profile(_phase(table)), strict=True):
        fixed = rows[rows.window == FIXED]
        for number, (column, label) in enumerate(
            (("debiased_coherence", "M"), ("sample_coherence", "M, coherence biased"))
        ):
            panel.plot(
                fixed.ground_range,
                side(fixed, fixed[column]),
                color="red",
                linewidth=1,
                label=label,
                linestyle="-:"[number],
            )
        for number, window, used in _windows(rows):
            if window != FIXED:
                label = f"{short(window)}, odd, as used"
                colour = figures.COLOURS[number]
                panel.step(used.ground_range, used.window_rows, where="mid", linewidth=1, label=label, color=colour)
        panel.axhline(9, color=figures.COLOURS[0], label="fixed 9")
        panel.set_ylim(0, 65)
        panel.legend(fontsize=8, loc="upper left")
    return figure


def side(rows: pd.DataFrame, gamma: "pd.Series[float]") -> Real:
    """Real-valued rows that equation 7 asks for at a coherence, with paper B's pixels laid on slant range."""
    per_radian = (rows.depth_per_delay * rows.wrap / (2 * np.pi)).to_numpy(dtype=float)
    # Slant range is depth_per_delay D / c; its ratio to ground range that of the pixel on the ground to its own size.
    ground = PIXEL / np.cos(np.arctan2(42.0, rows.ground_range.to_numpy(dtype=float)))
    return side_of_constant_ratio(per_radian * bounds.phase_crlb(1.0, gamma), KAPPA, Pixels(PIXEL, ground, ALPHA))


def std_fixed_and_adaptive(table: pd.DataFrame, examples: Examples) -> Figure:
    """Figure 8: measured STD of all windows, with that predicted from the true coherence."""
    figure, axes = _over_range(table, "depth STD [m]")
    for (panel,), (_, rows) in zip(axes, by_profile(_phase(table)), strict=True):
        for number, window, of_window in _windows(rows):
            _measured(panel, of_window, number, short(window))
            panel.plot(
                of_window.ground_range, of_window.predicted_depth_std, "--", color=figures.COLOURS[number], linewidth=1
            )
        panel.axhline(THRESHOLD, color="black", linewidth=0.8)
        panel.set_ylim(0, 1.5)
        title = f"points: every metre, 95 % intervals\nsolid: median over {OVER} m; dashed: predicted"
        panel.legend(fontsize=8, loc="upper left", title=title, title_fontsize=8)
    return figure


def wrap_errors(table: pd.DataFrame, examples: Examples) -> Figure:
    """Wrap-error rates of each window where the wrap is found by cross-correlation of the same window."""
    figure, axes = _over_range(table, "wrap-error rate")
    for (panel,), (_, rows) in zip(axes, by_profile(table[table.estimator == "correlation"]), strict=True):
        for number, window, of_window in _windows(rows):
            colour = figures.COLOURS[number]
            rate = of_window.groupby(np.floor(of_window.ground_range / OVER)).agg(
                ground_range=("ground_range", "mean"), wrong=("wrap_errors", "sum"), trials=("trials", "sum")
            )
            panel.plot(
                rate.ground_range,
                np.maximum(rate.wrong / rate.trials, 1e-4),
                figures.MARKERS[number],
                markersize=3.5,
                color=colour,
                label=f"{short(window)}, over {OVER} m",
            )
            ends = [_interval(int(wrong), int(trials)) for wrong, trials in zip(rate.wrong, rate.trials, strict=True)]
            panel.vlines(rate.ground_range, *np.maximum(np.transpose(ends), 1e-4), color=colour, linewidth=1)
            panel.plot(of_window.ground_range, of_window.predicted_wrap_rate, "--", color=colour, linewidth=1)
        panel.axhline(0.01, color="black", linewidth=0.8)
        panel.set(yscale="log", ylim=(1e-4, 1.2))
        panel.legend(
            fontsize=8,
            loc="upper left",
            title="dashed: predicted; bars: 95 % intervals; on the floor: none seen",
            title_fontsize=8,
        )
    return figure


def _interval(wrong: int, trials: int) -> tuple[float, float]:
    """Wilson's 95 % interval."""
    interval = binomtest(wrong, trials).proportion_ci(method="wilson")
    return float(interval.low), float(interval.high)


def coherence_bias(table: pd.DataFrame, examples: Examples) -> Figure:
    """What the bias of the sample coherence makes of the predicted STD, over that of the true coherence."""
    figure, axes = _over_range(table, "CRLB / that of the true coherence")
    for (panel,), (_, rows) in zip(axes, by_profile(_phase(table)), strict=True):
        for number, window in enumerate((FIXED, ADAPTIVE)):
            of_window = rows[rows.window == window]
            for column, style, label in (
                ("depth_crlb_sample", "-", "as read"),
                ("depth_crlb_debiased", ":", "debiased"),
            ):
                panel.plot(
                    of_window.ground_range,
                    of_window[column] / of_window.depth_crlb,
                    style,
                    color=figures.COLOURS[number],
                    linewidth=1,
                    label=f"{short(window)}, {label}",
                )
        panel.axhline(1, color="black", linewidth=0.8)
        panel.set_ylim(0, 1.6)
        panel.legend(fontsize=8, loc="lower left", ncols=2)
    return figure


def short(window: str) -> str:
    """What figures call a window."""
    return next(name for key, name in SHORT.items() if window.startswith(key))


def _windows(rows: pd.DataFrame) -> Iterator[tuple[int, str, pd.DataFrame]]:
    """The rows of each window, with the number of its colour."""
    for number, key in enumerate(SHORT):
        for window, of_window in rows.groupby("window"):
            if str(window).startswith(key):
                yield number, str(window), of_window.sort_values("ground_range")


def _phase(table: pd.DataFrame) -> pd.DataFrame:
    return table[table.estimator == "phase"].sort_values("ground_range")


def _over_range(table: pd.DataFrame, label: str) -> tuple[Figure, Sequence[Sequence[Axes]]]:
    names = [name for name, _ in by_profile(table)]
    figure, axes = figures.grid(len(names), 1, width=6.4, height=3.0)
    for (panel,), name in zip(axes, names, strict=True):
        panel.set_title(f"{name} SNR", fontsize=10)
        panel.set_ylabel(label)
    axes[-1][0].set_xlabel("ground range [m]")
    return figure, axes


def _measured(panel: Axes, rows: pd.DataFrame, number: int, label: str) -> None:
    """The measured spread of every metre in faint points, and its median over some of them."""
    colour, spread = figures.COLOURS[number], error(rows)
    panel.plot(rows.ground_range, spread, ".", color=colour, markersize=1.5, alpha=0.35)
    half = 1.96 * rows.depth_std_in_wrap_se
    panel.vlines(rows.ground_range, spread - half, spread + half, color=colour, linewidth=0.6, alpha=0.15)
    over = spread.rolling(OVER, center=True, min_periods=1).median()
    panel.plot(rows.ground_range, over, color=colour, linewidth=1.2, label=label)
