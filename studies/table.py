"""From sums over errors to the table of a study: one row for each design point and estimator."""

from collections.abc import Iterable
from typing import Any

import numpy as np
import pandas as pd

from studies import statistics
from studies.study import Measurement, Point


def row(point: Point, measurement: Measurement) -> dict[str, Any]:
    """Statistics of one estimator at one design point.

    A wrap error is an error of more than half the delay of a wrap; `in_wrap` statistics leave these out. Estimates
    that are not finite count as failures and in no other statistic; none is drawn again.
    """
    facts, moments, failures = measurement.facts, measurement.moments, measurement.failures
    wrap = facts["wrap"]
    wraps, outliers = statistics.rate(moments, "wrong"), statistics.rate(moments, "outlier")
    bias = statistics.ratio(moments, "right_error", "right")
    spread, rmse = statistics.std_in_wrap(moments), statistics.rmse(moments)
    crlb = facts["crlb"] / wrap if facts["crlb"] > 0 else np.nan
    return {
        **point,
        **measurement.labels,
        **{name: value for name, value in facts.items() if name != "wrap"},
        "trials": int(moments["tried"]) + failures,
        "failures": failures,
        "wrap_errors": int(moments["wrong"]),
        "wrap_rate": wraps.value,
        "wrap_rate_low": wraps.low,
        "wrap_rate_high": wraps.high,
        "outlier_rate": outliers.value,
        "outlier_rate_low": outliers.low,
        "outlier_rate_high": outliers.high,
        "delay_bias": bias.value * wrap,
        "delay_bias_se": bias.error * wrap,
        "delay_std_in_wrap": spread.value * wrap,
        "delay_std_in_wrap_se": spread.error * wrap,
        "std_over_crlb": spread.value / crlb,
        "std_over_crlb_se": spread.error / crlb,
        "rmse": rmse.value * wrap,
        "rmse_se": rmse.error * wrap,
        "seconds_per_pixel": measurement.seconds_per_pixel,
    }


def tabulate(results: Iterable[tuple[Point, Iterable[Iterable[Measurement]]]]) -> pd.DataFrame:
    """Table of a study from its points and, for each, the measurements of its blocks in order; keeps sums only."""
    rows = []
    for point, blocks in results:
        sums: dict[tuple[str, ...], Measurement] = {}
        for block in blocks:
            for measurement in block:
                labels = tuple(measurement.labels.values())
                sums[labels] = sums[labels] + measurement if labels in sums else measurement
        rows += [row(point, measurement) for measurement in sums.values()]
    return pd.DataFrame(rows)
