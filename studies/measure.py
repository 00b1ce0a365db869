"""What the studies share when they measure an estimator: its time, and what theory expects of it."""

from collections.abc import Mapping
from time import perf_counter

from estimators import DelayEstimate, Estimator, bounds
from sim import EchoPair


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
