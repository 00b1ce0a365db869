import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.special import ive
from scipy.stats import ncx2

from estimators import bounds

CASES = [(9, 0.9, 0.3), (33, 0.5, 0.3), (81, 0.3, 0.3), (4, 0.9, 0.6), (3, 0.9, 0.3), (9, 0.5, 1.2), (9, 0.98, 0.1)]


def by_drawn_spectra(looks, coherence, ratio, rng, draws=100_000):
    """theory.md section 3 as it stands: P_env through Marcum's function, averaged over drawn speckle spectra."""
    powers = rng.exponential(size=(draws, looks))
    turns = np.exp(2j * np.pi * ratio * (np.arange(looks) - (looks - 1) / 2) / looks)
    total = powers.sum(axis=1)
    r = np.abs(powers @ turns) / total
    kappa = coherence**2 * total / (1 - coherence**2)
    x = np.sqrt(np.maximum(1 - r**2, 0.0))
    a, b = np.sqrt(kappa / 2 * (1 - x)), np.sqrt(kappa / 2 * (1 + x))
    pair = ncx2.sf(b**2, 2, a**2) - 0.5 * np.exp(-((a - b) ** 2) / 2) * ive(0, a * b)
    return 2 * pair.mean(), 2 * pair.std() / np.sqrt(draws)


@pytest.mark.parametrize("case", CASES)
def test_closed_form_equals_the_average_over_drawn_spectra(case):
    # 0.6 % stated accuracy and 5 standard errors: a false-alarm rate of 6e-7 each.
    drawn, error = by_drawn_spectra(*case, np.random.default_rng(1))
    assert bounds.wrap_error_probability(*case) == pytest.approx(min(drawn, 1.0), rel=0.006, abs=5 * error)


def test_reference_wrap_rates(oracle):
    # The reference gives 0.054 for 9 looks to two digits, which leaves 1 %; averages over drawn spectra give 0.0533.
    table = oracle("wrap_rates")
    predicted = bounds.wrap_error_probability(table.looks, table.coherence, table.relative_bandwidth)
    np.testing.assert_allclose(predicted, table.twice_envelope_pair, rtol=0.01, atol=0.0005)


@pytest.mark.parametrize("case", [(9, 0.9, 0.3), (3, 0.7, 0.6), (81, 0.5, 0.3), (4, 0.9, 1.2), (9, 0.95, 0.1)])
def test_split_spectrum_equals_drawn_phases(case):
    # Two multilook phases by their exact sampler; 5 standard errors.
    looks, coherence, ratio = case
    rng, draws = np.random.default_rng(2), 400_000
    gain = coherence / np.sqrt(1 - coherence**2)
    vectors = [
        gain * np.sqrt(rng.gamma(looks / 3, size=draws))
        + (rng.normal(size=draws) + 1j * rng.normal(size=draws)) / np.sqrt(2)
        for _ in range(2)
    ]
    wrong = np.abs(np.angle(vectors[0] * vectors[1].conj())) > np.pi * ratio * 2 / 3
    error = np.sqrt(wrong.mean() * (1 - wrong.mean()) / draws)
    assert bounds.split_spectrum_wrap_error_probability(*case) == pytest.approx(wrong.mean(), abs=5 * error)


@pytest.mark.parametrize("predict", [bounds.wrap_error_probability, bounds.split_spectrum_wrap_error_probability])
@settings(max_examples=40, deadline=None)
@given(st.floats(1.0, 1e6), st.floats(1e-4, 1.9), st.floats(0.0, 1.0), st.floats(0.0, 1.0))
def test_probabilities_fall_with_coherence(predict, looks, ratio, first, second):
    found = predict(looks, np.sort([0.0, first, second, 1 - 1e-12, 1.0]), ratio)
    assert np.all((found >= 0) & (found <= 1))
    assert np.all(np.diff(found) <= 1e-9)


def test_without_coherence_either_wrap_is_as_likely():
    assert bounds.wrap_error_probability(9, 0.0, 0.3) == pytest.approx(1.0)
    # A phase difference evenly spread over a turn: the share beyond the threshold.
    assert bounds.split_spectrum_wrap_error_probability(9, 0.0, 0.3) == pytest.approx(1 - 0.3 * 2 / 3, abs=1e-6)


def test_outside_the_limits_there_is_no_probability():
    assert np.isnan(bounds.wrap_error_probability(0.5, 0.5, 0.3))
    assert np.isnan(bounds.wrap_error_probability(9, 1.1, 0.3))
    assert np.isnan(bounds.split_spectrum_wrap_error_probability(9, 0.5, 2.5))
