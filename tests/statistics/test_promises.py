"""What the project promises of its estimators, each in a number: spreads over bounds, and wrap-error rates.

Of 20,000 errors a standard deviation has a relative standard error of 0.5 %, of 60,000 one of 0.3 %: theory lies
four of these and more below what is promised. Rates are asked within three standard errors.
"""

import numpy as np
import pytest

from estimators import CrossCorrelation, FixedWindow, MaximumLikelihood, SplitSpectrum, bounds
from sim import speckle_pair

FC, B = 100e3, 30e3
TRIALS = 20_000


def errors(method, looks, coherence, most_delay=0.5, trials=TRIALS, **options):
    rng = np.random.default_rng([20261124, looks, round(1000 * coherence)])
    delay = rng.uniform(-most_delay, most_delay, trials) / FC
    pair = speckle_pair(
        (trials, looks), coherence=coherence, delay=delay, centre_frequency=FC, bandwidth=B, sample_rate=B, rng=rng
    )
    return method(FixedWindow(1, looks), **options).estimate(pair).delay[:, 0] - delay


@pytest.mark.long
@pytest.mark.parametrize("method", [CrossCorrelation, MaximumLikelihood])
def test_the_coherent_bound_is_reached(method):
    found = errors(method, 81, 0.9)
    assert np.abs(found).max() < 0.5 / FC
    ratio = found.std() / bounds.coherent_delay_crlb(81, 0.9, FC, B)
    assert ratio <= 1.03


@pytest.mark.long
@pytest.mark.parametrize("method", [CrossCorrelation, MaximumLikelihood])
@pytest.mark.parametrize(("looks", "coherence"), [(9, 0.9), (33, 0.5), (81, 0.5)])
def test_wraps_are_wrong_as_often_as_predicted(method, looks, coherence):
    rate = np.mean(np.abs(errors(method, looks, coherence, search=3 / FC)) > 0.5 / FC)
    expected = float(bounds.wrap_error_probability(looks, coherence, B / FC))
    error = np.sqrt(expected * (1 - expected) / TRIALS)
    assert rate == pytest.approx(expected, abs=3 * error)


@pytest.mark.long
def test_split_spectrum_has_1_06_times_the_bound_of_the_group_delay():
    # At zero delay; away from it sub-bands are off centre, and have 3.2 % more than this for delays up to half a wrap.
    found = errors(SplitSpectrum, 81, 0.9, most_delay=0.0, trials=60_000, refine=False)
    ratio = found.std() / bounds.group_delay_crlb(81, 0.9, B)
    assert ratio == pytest.approx(np.sqrt(9 / 8), rel=0.03)
