"""Rates of rare delay errors by importance sampling against exact probabilities, predictions and plain sampling.

Rates are asked to agree within five of their standard errors, a false-alarm rate of 6e-7 each, and what is known of the
accuracy of the reference. Seeds are fixed.
"""

import numpy as np
import pytest
from scipy.optimize import brentq

from estimators import (
    CrossCorrelation,
    FixedWindow,
    FullBandPhaseSlope,
    Interferogram,
    MaximumLikelihood,
    SplitSpectrum,
    bounds,
)
from sim import DelayErrors, PhaseErrors, SubBandErrors, rare_speckle_pair, speckle_pair

FC = 100e3
ROWS = 20_000
SEED = 20261124
DELAY_ESTIMATORS = {
    "cross-correlation": CrossCorrelation,
    "cross-correlation-group": lambda window: CrossCorrelation(window, refine=False),
    "maximum-likelihood": MaximumLikelihood,
    "phase-slope": lambda window: FullBandPhaseSlope(window, lags_per_resolution=8),
    "split-spectrum": SplitSpectrum,
    "split-spectrum-group": lambda window: SplitSpectrum(window, refine=False),
}


def coherence_of(rate, predict):
    """Coherence at which a probability that falls with it is `rate`."""
    odds = brentq(lambda z: np.log(max(float(predict(1 / (1 + np.exp(-z)))), 1e-300) / rate), -4, 22)
    return 1 / (1 + np.exp(-odds))


def rare(looks, coherence, relative_bandwidth, *, draw=rare_speckle_pair, rows=ROWS, **options):
    rng = np.random.default_rng([SEED, looks, round(10 * relative_bandwidth)])
    options = {"delay": 0.0, "sample_rate": relative_bandwidth * FC, **options}
    return draw(
        (rows, looks),
        coherence=coherence,
        centre_frequency=FC,
        bandwidth=relative_bandwidth * FC,
        rng=rng,
        **options,
    )


def rate_of(pair, wrong):
    """Rate of what is wrong, and its standard error."""
    weighted = wrong if pair.likelihood_ratio is None else pair.likelihood_ratio * wrong
    return weighted.mean(), weighted.std() / np.sqrt(weighted.size)


def off_by_half_a_wrap(estimator, pair):
    error = estimator(FixedWindow(1, pair.shape[1])).estimate(pair).delay[:, 0] - pair.truth.delay[:, 0]
    return np.abs(error) > 0.5 / FC


@pytest.mark.parametrize("rate", [1e-2, 1e-6, 1e-10])
@pytest.mark.parametrize("relative_bandwidth", [0.1, 0.3, 0.6])
@pytest.mark.parametrize("looks", [3, 9, 33, 81])
def test_one_wrong_wrap_against_the_true_one(looks, relative_bandwidth, rate):
    # Decisions between two delays, whose probability is known: by envelope within 1e-3, coherent to all digits.
    coherence = coherence_of(rate, lambda g: bounds.wrap_error_probability(looks, g, relative_bandwidth))
    pair = rare(looks, coherence, relative_bandwidth, delay=2e-6, errors=(DelayErrors(),))
    frequencies = np.fft.fftfreq(looks, 1 / pair.sample_rate)
    cross = np.fft.fft(pair.primary).conj() * np.fft.fft(pair.secondary)
    cross *= np.exp(2j * np.pi * (FC + frequencies) * 2e-6)
    here, there = cross.sum(axis=1), (cross * np.exp(-2j * np.pi * frequencies / FC)).sum(axis=1)
    for wrong, expected, accuracy in (
        (there.real > here.real, bounds.coherent_pair_probability, 1e-9),
        (np.abs(there) > np.abs(here), bounds.envelope_pair_probability, 1e-3),
    ):
        found, error = rate_of(pair, wrong)
        expected = float(expected(looks, coherence, relative_bandwidth))
        assert found == pytest.approx(expected, abs=5 * error + accuracy * expected)
        assert error < 0.1 * expected


@pytest.mark.parametrize("delay", [0.1, -0.3, 0.4])
@pytest.mark.parametrize("looks", [9, 81])
def test_interferogram_over_the_edge(looks, delay):
    # In a narrow band the rate is the tail of the exact multilook phase: the centre of the spectrum, B / sqrt(12 N) off
    # in standard deviation, moves the edge by 1e-3 rad at most, and by symmetry the rate by less than one percent.
    edge = np.pi * (1 - 2 * abs(delay))
    coherence = coherence_of(1e-6, lambda g: bounds.multilook_phase_cdf(-edge, looks, g))
    pair = rare(looks, coherence, 0.001, delay=delay / FC, errors=(PhaseErrors(delay / FC),))
    found, error = rate_of(pair, off_by_half_a_wrap(Interferogram, pair))
    assert found == pytest.approx(1e-6, abs=5 * error + 1e-8)
    assert error < 0.1 * found


@pytest.mark.parametrize(("looks", "rate"), [(9, 1e-4), (33, 1e-6), (81, 1e-9)])
def test_split_spectrum_without_refinement(looks, rate):
    # Its prediction is exact where sub-bands are whole bins, but for its own accuracy of 2e-4.
    coherence = coherence_of(rate, lambda g: bounds.split_spectrum_wrap_error_probability(looks, g, 0.3))
    pair = rare(looks, coherence, 0.3, errors=(SubBandErrors(),))
    found, error = rate_of(pair, off_by_half_a_wrap(DELAY_ESTIMATORS["split-spectrum-group"], pair))
    assert found == pytest.approx(rate, abs=5 * error + 2e-4 * rate)
    assert error < 0.05 * rate


@pytest.mark.parametrize("relative_bandwidth", [0.1, 0.3, 0.6])
@pytest.mark.parametrize("looks", [9, 33])
def test_every_search_reaches_one_in_a_million(looks, relative_bandwidth):
    # With a fifth of the 100,000 rows that are allowed for a standard error of 10 %. `2 E[P_env]` holds for the delay
    # of the envelope's peak; the wraps beyond the nearest, and for few looks their overlap, leave 10 %.
    coherence = coherence_of(1e-6, lambda g: bounds.wrap_error_probability(looks, g, relative_bandwidth))
    delay = np.random.default_rng(SEED).uniform(-0.5, 0.5, ROWS) / FC
    pair = rare(looks, coherence, relative_bandwidth, delay=delay)
    for name, estimator in DELAY_ESTIMATORS.items():
        found, error = rate_of(pair, off_by_half_a_wrap(estimator, pair))
        assert error < 0.1 * found, name
        if name == "cross-correlation-group":
            assert found == pytest.approx(1e-6, abs=5 * error + 1e-7)


@pytest.mark.long
@pytest.mark.parametrize("rate", [0.005, 0.2])
@pytest.mark.parametrize("looks", [9, 33])
def test_common_errors_are_as_in_plain_speckle(looks, rate):
    coherence = coherence_of(rate, lambda g: bounds.wrap_error_probability(looks, g, 0.3))
    delay = np.random.default_rng(SEED).uniform(-0.5, 0.5, ROWS) / FC
    tilted = rare(looks, coherence, 0.3, delay=delay)
    plain = rare(looks, coherence, 0.3, delay=delay, draw=speckle_pair)
    for name, estimator in DELAY_ESTIMATORS.items():
        found, error = rate_of(tilted, off_by_half_a_wrap(estimator, tilted))
        expected, plain_error = rate_of(plain, off_by_half_a_wrap(estimator, plain))
        assert found == pytest.approx(expected, abs=5 * np.hypot(error, plain_error)), name
        # Not even where errors are common does the tilt cost anything.
        assert error < plain_error, name


def test_short_windows_are_unbiased():
    # Rows of 66 bins, estimates from 16 of their samples: little is gained, and nothing lost.
    options = {"sample_rate": 1.5 * 0.3 * FC, "delay": 1e-6, "rows": 4000}
    tilted, plain = (rare(99, 0.8, 0.3, draw=draw, **options) for draw in (rare_speckle_pair, speckle_pair))
    rates = []
    for pair in (tilted, plain):
        delay = CrossCorrelation(FixedWindow(1, 24)).estimate(pair).delay[:, ::33]
        rates.append(rate_of(pair, (np.abs(delay - 1e-6) > 0.5 / FC).mean(axis=1)))
    (found, error), (expected, plain_error) = rates
    assert found == pytest.approx(expected, abs=5 * np.hypot(error, plain_error))
