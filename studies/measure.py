"""What the studies share when they measure an estimator: its time, its errors, and what theory expects of it."""

from collections.abc import Mapping
from functools import lru_cache
from time import perf_counter
from typing import NamedTuple

import numpy as np

from estimators import Estimator, bounds
from sim import EchoPair
from sim.band import Real
from studies.moments import of_errors
from studies.study import Measurement


class Attempt(NamedTuple):
    """What an estimator made of a pair: delays [s], NaN where it failed; what it said then; its time [s a pixel]."""

    delay: Real
    failure: str
    seconds_per_pixel: float


def attempt(estimator: Estimator, pair: EchoPair) -> Attempt:
    """Apply an estimator to a pair. Whatever it raises is kept, and no estimate of the pair counts."""
    start = perf_counter()
    try:
        delay, failure = estimator.estimate(pair).delay, ""
    except Exception as error:  # Whatever a user's estimator does must not stop the study.
        delay, failure = np.full(pair.shape, np.nan), f"{type(error).__name__}: {' '.join(str(error).split())}"
    return Attempt(delay, failure, (perf_counter() - start) / pair.primary.size)


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
        "ziv_zakai": _ziv_zakai(looks, coherence, centre_frequency, bandwidth),
    }


def measured(
    labels: Mapping[str, str], facts: Mapping[str, float], errors: Real, outlier: float, made: Attempt
) -> Measurement:
    """Sum up the errors of an attempt.

    Parameters
    ----------
    labels, facts
        As of `Measurement`; `facts["wrap"]` scales the errors.
    errors
        Delay errors [s], shape (cluster, trial); one that is not finite is a failure.
    outlier
        Error beyond which an estimate is an outlier [s].
    made
        What they come from.
    """
    failed = ~np.isfinite(errors)
    first = f"trial {int(np.argmax(failed.any(axis=1)))}: {made.failure or 'not a finite number'}"
    return Measurement(
        labels=labels,
        facts=facts,
        moments=of_errors(errors / facts["wrap"], np.abs(errors) > outlier),
        failures=int(failed.sum()),
        failure=first if failed.any() else "",
        seconds_per_pixel=made.seconds_per_pixel,
    )


@lru_cache
def _ziv_zakai(looks: float, coherence: float, centre_frequency: float, bandwidth: float) -> float:
    """The bound for a delay within `1 / B` of zero; the same for all methods of a point."""
    return float(bounds.ziv_zakai_delay_std(looks, coherence, centre_frequency, bandwidth, 2 / bandwidth))
