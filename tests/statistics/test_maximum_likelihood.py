"""Spread, bias and wrap errors of the coherent maximum likelihood against the reference simulations.

Agreement as in `test_cross_correlation`: three standard errors of the difference, a false-alarm rate of 0.27 % a
number.
"""

import numpy as np
import pytest

from estimators import FixedWindow, MaximumLikelihood, bounds
from sim import speckle_pair

FC, B = 100e3, 30e3
TRIALS, BATCHES, REFERENCE_TRIALS = 40_000, 40, 20_000
SEED = 20261124
# The reference search: three wraps to either side.
SEARCH = 3 / FC


def errors(looks, coherence, delay=None, trials=TRIALS):
    rng = np.random.default_rng([SEED, looks, round(1000 * coherence)])
    delay = rng.uniform(-0.5, 0.5, trials) / FC if delay is None else delay
    pair = speckle_pair(
        (trials, looks), coherence=coherence, delay=delay, centre_frequency=FC, bandwidth=B, sample_rate=B, rng=rng
    )
    return MaximumLikelihood(FixedWindow(1, looks), search=SEARCH).estimate(pair).delay[:, 0] - delay


def half_width(values):
    low, high = np.percentile(values, [100 * 0.158655, 100 * 0.841345])
    return (high - low) / 2


def rows_of(oracle, name, column):
    table = oracle(name)
    return list(zip(table.looks, table.coherence, table[column], strict=True))


@pytest.mark.long
def test_spread_in_the_right_wrap(oracle):
    # The reference of nine looks is the half-width: given the primary, no delay has a standard deviation below the
    # bound of its own power, on average sqrt(N / (N - 1)) times the bound, 1.06.
    for looks, coherence, expected in rows_of(oracle, "efficiency", "coherent"):
        found = errors(looks, coherence, trials=TRIALS if looks < 600 else TRIALS // 4)
        right = found[np.abs(found) < 0.5 / FC] / bounds.coherent_delay_crlb(looks, coherence, FC, B)
        statistic = half_width if looks < 10 else np.std
        batches = [statistic(part) for part in np.array_split(right, BATCHES)]
        error = np.std(batches, ddof=1) * np.sqrt(1 / BATCHES + len(right) / REFERENCE_TRIALS / BATCHES)
        assert statistic(right) == pytest.approx(expected, abs=3 * error + 0.0005), (looks, coherence)


def test_many_looks_of_high_coherence_reach_the_bound():
    # 40,000 Gaussian errors: a standard error of 0.0035, so that 1.004 exceeds 1.03 by chance less than once in 1e12.
    assert np.std(errors(81, 0.9)) / bounds.coherent_delay_crlb(81, 0.9, FC, B) <= 1.03


@pytest.mark.long
def test_wrap_rate(oracle):
    rates = rows_of(oracle, "wrap_rates", "wrap_rate_ml")
    for (looks, coherence, expected), reference_error in zip(rates, oracle("wrap_rates").wrap_rate_ml_se, strict=True):
        rate = np.mean(np.abs(errors(looks, coherence)) > 0.5 / FC)
        error = np.hypot(np.sqrt(expected * (1 - expected) / TRIALS), reference_error)
        assert rate == pytest.approx(expected, abs=3 * error + 0.00005), (looks, coherence)


@pytest.mark.parametrize("fraction", [0.0, 0.1, 0.25, 0.37, 0.5])
def test_bias_against_fractional_delay(fraction):
    # The errors of one seed at a delay of a whole number of lags, which the stack holds, leave the method's own bias.
    lag = 1 / (4 * B)
    moved = errors(81, 0.9, delay=fraction * lag, trials=2000)
    bias = np.mean(moved - errors(81, 0.9, delay=0.0, trials=2000))
    assert abs(bias) < 0.01 * bounds.coherent_delay_crlb(81, 0.9, FC, B)


def test_the_passband_correlation_has_no_higher_value():
    # A plain scan of the definition, a thousand delays a wrap, 300 records of few looks and little coherence.
    rng = np.random.default_rng(SEED)
    pair = speckle_pair((300, 9), coherence=0.5, delay=0.0, centre_frequency=FC, bandwidth=B, sample_rate=B, rng=rng)
    found = MaximumLikelihood(FixedWindow(1, 9), search=SEARCH).estimate(pair)
    frequencies = FC + np.fft.fftfreq(9, 1 / B)
    cross = np.fft.fft(pair.primary).conj() * np.fft.fft(pair.secondary)

    def correlation(delays):
        return np.real(np.sum(cross[:, None] * np.exp(2j * np.pi * frequencies * delays[..., None]), axis=-1))

    # The method looks a wrap beyond its search range to tell what is not valid.
    delays = np.linspace(-4, 4, 8001) / FC
    scan = correlation(delays[None])
    within = np.abs(delays[scan.argmax(axis=1)]) < SEARCH
    share = correlation(found.delay[:, :1])[:, 0] / scan.max(axis=1)
    assert np.all(share[within] > 1 - 6e-5)
    assert np.mean(found.valid[:, 0] == within) > 0.99


@pytest.mark.parametrize(("lags_per_resolution", "accuracy"), [(4, 1e-5), (8, 3e-8), (32, 1e-12)])
@pytest.mark.parametrize("relative_bandwidth", [0.1, 0.6])
def test_the_delay_is_where_the_definition_is_stationary(relative_bandwidth, lags_per_resolution, accuracy):
    # The step in wraps that Newton's method on the exact correlation would still take.
    rng = np.random.default_rng(SEED)
    bandwidth = relative_bandwidth * FC
    pair = speckle_pair(
        (500, 9), coherence=0.7, delay=1e-6, centre_frequency=FC, bandwidth=bandwidth, sample_rate=bandwidth, rng=rng
    )
    found = MaximumLikelihood(FixedWindow(1, 9), lags_per_resolution=lags_per_resolution).estimate(pair)
    cycles = 1 + np.fft.fftfreq(9, 1 / relative_bandwidth)
    cross = np.fft.fft(pair.primary).conj() * np.fft.fft(pair.secondary)
    cross = (cross * np.exp(2j * np.pi * cycles * FC * found.delay[:, :1]))[found.valid[:, 0]]
    step = np.sum(cycles * cross.imag, axis=1) / np.sum(2 * np.pi * cycles**2 * cross.real, axis=1)
    assert np.abs(step).max() < accuracy
