"""Columns of tables that weigh speed against accuracy."""

import numpy as np

from estimators import bounds
from sim import Sonar
from sim.band import Real
from studies import statistics
from studies.moments import of_errors
from studies.timing import Price


def costs(price: Price) -> dict[str, float]:
    """Seconds and copies a pixel, with quartiles."""
    seconds, copies = price
    return {
        "seconds_per_pixel": seconds.median,
        "seconds_low": seconds.low,
        "seconds_high": seconds.high,
        "copies": copies.median,
        "copies_low": copies.low,
        "copies_high": copies.high,
    }


def errors_of(errors: Real, sonar: Sonar, looks: float, coherence: float) -> dict[str, float]:
    """Statistics of delay errors [s], shape (cluster, trial), against the coherent bound.

    Intervals are those of 95 %, Wilson's for the wrap rate; the `_se` are Monte Carlo standard errors.
    """
    wraps = errors / sonar.wrap
    moments, _ = of_errors(wraps, np.abs(wraps) > 0.5 / sonar.relative_bandwidth)
    crlb = float(bounds.coherent_delay_crlb(looks, coherence, sonar.centre_frequency, sonar.bandwidth))
    rate = statistics.wilson(moments, "wrong")
    columns: dict[str, float] = {"trials": moments.trials, "wrap_errors": moments.wrap_errors, "crlb": crlb}
    columns |= {"wrap_rate": rate.value, "wrap_rate_low": rate.low, "wrap_rate_high": rate.high}
    for name, (value, error) in (
        ("delay_bias", statistics.ratio(moments, "right_error", "right")),
        ("delay_std_in_wrap", statistics.std_in_wrap(moments)),
        ("rmse", statistics.rmse(moments)),
    ):
        columns |= {name: value * sonar.wrap, f"{name}_se": error * sonar.wrap}
    for name, of in (("std_over_crlb", "delay_std_in_wrap"), ("rmse_over_crlb", "rmse")):
        columns |= {name: columns[of] / crlb, f"{name}_se": columns[f"{of}_se"] / crlb}
    return columns
