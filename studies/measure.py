"""What the studies share when they measure an estimator: its time, its errors, and what theory expects of it."""

from collections.abc import Mapping
from time import perf_counter

import numpy as np

from estimators import DelayEstimate, Estimator, bounds
from sim import EchoPair
from sim.band import Real
from studies.moments import of_errors
from studies.study import Measurement


def timed(estimator: Estimator, pair: EchoPair) -> tuple[DelayEstimate, float]:
    """Estimates of a pair, and the time that they took [s a pixel]."""
    start = perf_counter()
    estimate = estimator.estimate(pair)
    return estimate, (perf_counter() - start) / pair.primary.size


def expected(
    method: str, looks: float, coherence: float, centre_frequency: float, bandwidth: float
) -> Mapping[str, float]:
    """What theory says of a method, in columns of the table.

    `crlb` is the coherent wideband bound whatever the method, `ziv_zakai` the bound with wraps for a delay within
    `1 / B` of zero [s]; `predicted_wrap_rate` is that of the method's kind, and `wrap` the delay of one [s].
    """
    predict = (
        bounds.split_spectrum_wrap_error_probability if method == "split-spectrum" else bounds.wrap_error_probability
    )
    ratio = bandwidth / centre_frequency
    return {
        "looks": looks,
        "coherence": coherence,
        "relative_bandwidth": ratio,
        "wrap": 1 / centre_frequency,
        "predicted_wrap_rate": float(predict(looks, coherence, ratio)),
        "crlb": float(bounds.coherent_delay_crlb(looks, coherence, centre_frequency, bandwidth)),
        "ziv_zakai": float(bounds.ziv_zakai_delay_std(looks, coherence, centre_frequency, bandwidth, 2 / bandwidth)),
    }


def measured(
    labels: Mapping[str, str], facts: Mapping[str, float], errors: Real, outlier: float, seconds_per_pixel: float
) -> Measurement:
    """Sum up the errors of an estimator.

    Parameters
    ----------
    labels, facts
        As of `Measurement`; `facts["wrap"]` scales the errors.
    errors
        Delay errors [s], shape (cluster, trial); one that is not finite is a failure.
    outlier
        Error beyond which an estimate is an outlier [s].
    seconds_per_pixel
        Time of the estimates.
    """
    failed = ~np.isfinite(errors)
    first = f"trial {int(np.argmax(failed.any(axis=1)))}: not a finite number" if failed.any() else ""
    return Measurement(
        labels=labels,
        facts=facts,
        moments=of_errors(errors / facts["wrap"], np.abs(errors) > outlier),
        failures=int(failed.sum()),
        failure=first,
        seconds_per_pixel=seconds_per_pixel,
    )
