"""Predicted wrap errors of the two searches over delay against simulated ones, from common to one in a million.

Rates are asked to agree within five of their standard errors, a false-alarm rate of 6e-7 each, and the 5 % for which
the prediction is made; `2 E[P_env]`, which has the nearest wrap alone and its peak exactly there, is up to 1.5 times
too low at these bandwidths. Seeds are fixed.
"""

import numpy as np
import pytest
from scipy.optimize import brentq

from estimators import CrossCorrelation, FixedWindow, MaximumLikelihood, bounds
from sim import rare_speckle_pair

FC = 100e3
ROWS = 20_000


@pytest.mark.parametrize(
    ("looks", "relative_bandwidth", "rate"),
    [(15, 0.6, 0.5), (9, 0.3, 0.5), (81, 0.6, 0.2), (33, 0.6, 1e-2), (81, 0.6, 1e-4), (33, 0.1, 1e-4), (81, 0.6, 1e-6)],
)
def test_searches_err_as_predicted(looks, relative_bandwidth, rate):
    def predicted(odds):
        return max(float(bounds.wrap_error_probability(looks, 1 / (1 + np.exp(-odds)), relative_bandwidth)), 1e-300)

    odds = brentq(lambda z: np.log(predicted(z) / rate), -4, 9)
    coherence = 1 / (1 + np.exp(-odds))
    rng = np.random.default_rng([20261124, looks, round(10 * relative_bandwidth), round(-np.log(rate))])
    delay = rng.uniform(-0.5, 0.5, ROWS) / FC
    band = relative_bandwidth * FC
    pair = rare_speckle_pair(
        (ROWS, looks),
        coherence=coherence,
        delay=delay,
        centre_frequency=FC,
        bandwidth=band,
        sample_rate=band,
        rng=rng,
    )
    for estimator, predict in (
        (CrossCorrelation, bounds.cross_correlation_wrap_error_probability),
        (MaximumLikelihood, bounds.likelihood_wrap_error_probability),
    ):
        found = estimator(FixedWindow(1, looks)).estimate(pair).delay[:, 0]
        wrong = pair.likelihood_ratio * (np.abs(found - delay) > 0.5 / FC)
        expected = float(predict(looks, coherence, relative_bandwidth))
        error = wrong.std() / np.sqrt(ROWS)
        assert error < 0.05 * expected
        assert wrong.mean() == pytest.approx(expected, abs=5 * error + 0.05 * expected)
        if relative_bandwidth == 0.6 and rate <= 1e-4:
            # The pair one wrap apart is refuted.
            assert wrong.mean() > rate + 5 * error
