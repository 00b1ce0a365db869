"""From sums over errors to the tables of a study: a row for each design point and estimator."""

from typing import Any

import numpy as np
import pandas as pd

from estimators import bounds
from studies import statistics
from studies.design import Point
from studies.measure import FACTS
from studies.measurement import Measurement
from studies.moments import Moments, of_errors
from studies.world import RANGED

FEW = 10.0
"""Effective number of weighted trials, or of weighted wrap errors, below which a row is marked as resting on a few."""


def row(point: Point, measurement: Measurement) -> dict[str, Any]:
    """Statistics of one estimator at one design point.

    A wrap error is an error of more than half the delay of a wrap; `in_wrap` statistics leave these out, `total` ones
    do not. Estimates that are not finite count as failures and in no other statistic; none is drawn again.
    """
    facts, moments, failures = measurement.facts, measurement.moments, measurement.failures
    wrap, trials = facts["wrap"], moments.trials + failures
    wilson, exact = (interval(moments, "wrong") for interval in (statistics.wilson, statistics.clopper_pearson))
    outliers = statistics.wilson(moments, "outlier")
    coverage = statistics.wilson(moments, "covered", "right")
    spread = statistics.std_in_wrap(moments)
    crlb = facts["crlb"] / wrap if facts["crlb"] > 0 else np.nan
    predicted = facts["predicted_delay_std"] / wrap if facts["predicted_delay_std"] > 0 else np.nan
    parts = statistics.parts_of_mse(moments)
    return {
        **point.columns,
        "estimator": measurement.estimator,
        "window": measurement.window,
        "region": measurement.region,
        **facts,
        "trials": trials,
        "failures": failures,
        "failure_rate": failures / trials if trials else np.nan,
        "flagged_rate": measurement.flagged / trials if trials else np.nan,
        "wrap_errors": moments.wrap_errors,
        "wrap_rate": wilson.value,
        "wrap_rate_se": statistics.ratio(moments, "wrong", "tried").error,
        "wrap_rate_low": wilson.low,
        "wrap_rate_high": wilson.high,
        "wrap_rate_exact_low": exact.low,
        "wrap_rate_exact_high": exact.high,
        "claimed_wrap_rate": statistics.ratio(moments, "claimed", "tried").value,
        "outlier_rate": outliers.value,
        "outlier_rate_low": outliers.low,
        "outlier_rate_high": outliers.high,
        **_with_error("delay_bias", statistics.ratio(moments, "right_error", "right"), wrap),
        **_with_error("delay_std_in_wrap", spread, wrap),
        **_with_error("std_over_crlb", spread, 1 / crlb),
        **_with_error("std_over_predicted", spread, 1 / predicted),
        "coverage": coverage.value,
        "coverage_low": coverage.low,
        "coverage_high": coverage.high,
        **_with_error("delay_bias_total", statistics.ratio(moments, "error", "tried"), wrap),
        **_with_error("delay_std_total", statistics.std(moments), wrap),
        **_with_error("rmse", statistics.rmse(moments), wrap),
        "mse_share_bias": parts.bias,
        "mse_share_spread": parts.spread,
        "mse_share_wraps": parts.wraps,
        "effective_trials": statistics.effective_trials(moments),
        "effective_wrap_errors": statistics.effective_hits(moments, "wrong"),
        "few_dominate": _few_dominate(moments),
        "seconds_per_pixel": measurement.seconds_per_pixel,
    }


def with_depths(table: pd.DataFrame) -> pd.DataFrame:
    """A table with the spread of the depth in rows of one range each; itself, where it has none.

    `depth_std_in_wrap` and `depth_std_total`, with wrong wraps, are those of the delay times `r c / D`;
    `predicted_depth_std` is that of the exact multilook phase and `depth_crlb` the Cramér-Rao bound (paper B, equation
    3), both at the true coherence. `depth_crlb_sample` is the bound at the mean sample coherence, as paper B takes it,
    and `depth_crlb_debiased` that at the coherence which this stands for.
    """
    if "depth_per_delay" not in table:
        return table
    per_delay, looks = table.depth_per_delay, table.looks.to_numpy(dtype=float)
    per_radian = (per_delay * table.wrap / (2 * np.pi)).to_numpy(dtype=float)
    sample = table.sample_coherence.to_numpy(dtype=float)
    debiased = np.nan_to_num(bounds.debias_coherence(sample, looks))
    coherences = {
        "depth_crlb": table.coherence.to_numpy(dtype=float),
        "depth_crlb_sample": sample,
        "depth_crlb_debiased": debiased,
    }
    spreads = ("delay_std_in_wrap", "delay_std_in_wrap_se", "delay_std_total", "delay_std_total_se")
    return table.assign(
        **{name.replace("delay", "depth"): table[name] * per_delay for name in spreads},
        debiased_coherence=debiased,
        predicted_depth_std=table.predicted_delay_std * per_delay,
        **{name: per_radian * bounds.phase_crlb(looks, gamma) for name, gamma in coherences.items()},
    )


def columns_at(point: Point) -> list[str]:
    """Columns of the table at a design point."""
    moments, batches = of_errors(np.zeros((2, 1)), np.zeros((2, 1), dtype=np.bool_))
    facts = dict.fromkeys((*FACTS, *RANGED) if point.world.ranged else FACTS, 1.0)
    only = row(point, Measurement("", "", "", 1, facts, moments, batches, 0, [], 0, 0.0))
    return list(with_depths(pd.DataFrame([only])).columns)


def _with_error(name: str, statistic: statistics.Statistic, scale: float) -> dict[str, float]:
    return {name: statistic.value * scale, f"{name}_se": statistic.error * scale}


def _few_dominate(moments: Moments) -> bool:
    if not moments.weighted:
        return False
    hits = statistics.effective_hits(moments, "wrong")
    return statistics.effective_trials(moments) < FEW or (moments.wrap_errors > 0 and hits < FEW)
