"""From errors to the table of a study: one row for each design point and estimator."""

from collections.abc import Iterable
from dataclasses import replace
from typing import Any

import numpy as np
import pandas as pd

from studies import statistics
from studies.study import Measurement, Point


def merged(measurements: Iterable[Measurement]) -> Measurement:
    """One measurement from those of several blocks, in their order; times by their median."""
    parts = list(measurements)
    return replace(
        parts[0],
        errors=np.concatenate([part.errors for part in parts]),
        counts=np.concatenate([part.counts for part in parts]),
        outliers=np.concatenate([part.outliers for part in parts]),
        seconds_per_pixel=float(np.median([part.seconds_per_pixel for part in parts])),
    )


def row(point: Point, measurement: Measurement) -> dict[str, Any]:
    """Statistics of one estimator at one design point.

    A wrap error is an error of more than half the delay of a wrap; `in_wrap` statistics leave these out. Estimates
    that are not finite count as failures and in no other statistic; none is drawn again.
    """
    facts = measurement.facts
    finite = np.isfinite(measurement.errors)
    tried = measurement.counts & finite
    errors = np.where(finite, measurement.errors, 0.0)
    wrong = np.abs(errors) > facts["wrap"] / 2
    right = tried & ~wrong
    wraps, outliers = statistics.rate(wrong, tried), statistics.rate(measurement.outliers, tried)
    bias = statistics.mean(errors, right)
    spread = statistics.root_mean_square(errors, right, bias.value)
    rmse = statistics.root_mean_square(errors, tried)
    return {
        **point,
        **measurement.labels,
        **{name: value for name, value in facts.items() if name != "wrap"},
        "trials": int(measurement.counts.sum()),
        "failures": int((measurement.counts & ~finite).sum()),
        "wrap_errors": int((wrong & tried).sum()),
        "wrap_rate": wraps.value,
        "wrap_rate_low": wraps.low,
        "wrap_rate_high": wraps.high,
        "outlier_rate": outliers.value,
        "outlier_rate_low": outliers.low,
        "outlier_rate_high": outliers.high,
        "delay_bias": bias.value,
        "delay_bias_se": bias.error,
        "delay_std_in_wrap": spread.value,
        "delay_std_in_wrap_se": spread.error,
        "std_over_crlb": spread.value / facts["crlb"] if facts["crlb"] > 0 else np.nan,
        "std_over_crlb_se": spread.error / facts["crlb"] if facts["crlb"] > 0 else np.nan,
        "rmse": rmse.value,
        "rmse_se": rmse.error,
        "seconds_per_pixel": measurement.seconds_per_pixel,
    }


def tabulate(results: Iterable[tuple[Point, Iterable[Iterable[Measurement]]]]) -> pd.DataFrame:
    """Table of a study from its points and, for each, the measurements of its blocks in order."""
    rows = []
    for point, blocks in results:
        same: dict[tuple[str, ...], list[Measurement]] = {}
        for block in blocks:
            for measurement in block:
                same.setdefault(tuple(measurement.labels.values()), []).append(measurement)
        rows += [row(point, merged(parts)) for parts in same.values()]
    return pd.DataFrame(rows)
