import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from estimators import bounds
from estimators.bounds.ziv_zakai import coherent_pair_error


def test_reference_values(oracle):
    table = oracle("ziv_zakai")
    found = bounds.ziv_zakai_delay_std(table.looks, table.coherence, 1.0, 0.3, 6.0)
    np.testing.assert_allclose(found, table.std_in_wraps, rtol=0.02)


def test_pair_error_at_one_wrap_is_the_reference(oracle):
    # Lugannani-Rice is within 1 % at 9 looks; the reference has two digits there.
    for row in oracle("wrap_rates").itertuples():
        found = 2 * coherent_pair_error(row.looks, row.coherence, np.array([1.0]), row.relative_bandwidth)[0]
        assert found == pytest.approx(row.twice_coherent_pair, rel=0.012)


def test_pair_error_equals_drawn_pairs():
    # 5 standard errors and the 1 % of the saddle point.
    looks, coherence, ratio, cycles = 9, 0.6, 0.3, np.array([0.2, 0.5, 1.0])
    rng, draws = np.random.default_rng(3), 400_000
    normal = rng.normal(size=(4, draws, looks))
    primary = normal[0] + 1j * normal[1]
    secondary = coherence * primary + np.sqrt(1 - coherence**2) * (normal[2] + 1j * normal[3])
    frequency = 1 + ratio * (np.arange(looks) - (looks - 1) / 2) / looks
    right = (primary.conj() * secondary).real.sum(axis=1)
    for each, found in zip(cycles, coherent_pair_error(looks, coherence, cycles, ratio), strict=True):
        wrong = (primary.conj() * secondary * np.exp(2j * np.pi * each * frequency)).real.sum(axis=1) > right
        error = np.sqrt(wrong.mean() * (1 - wrong.mean()) / draws)
        assert found == pytest.approx(wrong.mean(), rel=0.01, abs=5 * error)


@settings(max_examples=25, deadline=None)
@given(st.floats(3.0, 300.0), st.floats(1e-6, 1 - 1e-9), st.floats(0.01, 1.9), st.floats(1.0, 20.0))
def test_it_lies_between_the_bound_without_wraps_and_the_prior(looks, coherence, ratio, prior):
    found = bounds.ziv_zakai_delay_std(looks, coherence, 1.0, ratio, prior)
    crlb = bounds.coherent_delay_crlb(looks, coherence, 1.0, ratio)
    assert found <= prior / np.sqrt(12) * (1 + 1e-12)
    assert found >= 0.97 * min(crlb, prior / np.sqrt(12) / 3) or crlb > prior / 20


def test_limits():
    assert bounds.ziv_zakai_delay_std(9, 0.0, 1.0, 0.3, 6.0) == pytest.approx(6 / np.sqrt(12))
    assert bounds.ziv_zakai_delay_std(9, 1.0, 1.0, 0.3, 6.0) == 0.0
    assert np.isnan(bounds.ziv_zakai_delay_std(9, 0.5, 1.0, 0.3, -6.0))
    assert bounds.ziv_zakai_delay_std(81, 1e-6, 1.0, 0.3, 6.0) == pytest.approx(6 / np.sqrt(12), rel=0.01)
