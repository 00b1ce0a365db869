import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from estimators import bounds


def test_debiasing_is_exact_at_both_ends():
    # E g^2 = 1/N without coherence; g = 1 with full coherence.
    assert bounds.debias_coherence(1 / 3, 9.0) == pytest.approx(0.0, abs=1e-8)
    assert bounds.debias_coherence(1.0, 9.0) == 1.0
    assert bounds.debias_coherence(0.1, 9.0) == 0.0


def test_a_single_look_says_nothing():
    np.testing.assert_array_equal(bounds.debias_coherence(np.ones(3), 1.0), 0.0)


@pytest.mark.parametrize(("looks", "coherence"), [(1.5, 0.7), (9, 0.3), (32.4, 0.187), (81, 0.6), (4, 0.99)])
def test_mean_square_equals_that_of_drawn_coherences(looks, coherence):
    # Exact sampler of theory.md section 4: k ~ NegBin(L, 1 - gamma^2), g^2 | k ~ Beta(k + 1, L - 1); 5 standard errors.
    rng, draws = np.random.default_rng(4), 400_000
    k = rng.negative_binomial(looks, 1 - coherence**2, size=draws)
    squared = rng.beta(k + 1, looks - 1)
    found = bounds.sample_coherence_mean_square(looks, coherence)
    assert found == pytest.approx(squared.mean(), abs=5 * squared.std() / np.sqrt(draws))


@given(st.floats(1.01, 1e6), st.floats(0.0, 1.0))
def test_debiasing_inverts_the_mean_square(looks, coherence):
    root = np.sqrt(bounds.sample_coherence_mean_square(looks, coherence))
    assert bounds.debias_coherence(root, looks) ** 2 == pytest.approx(coherence**2, abs=2e-5 + 1e-12 / (looks - 1))


def test_paper_b_reads_231_for_187():
    # theory.md section 6: 32.4 looks read .231 on average for a true coherence of .187. The mean square is above
    # that by the variance, .101^2 by the exact sampler.
    assert bounds.sample_coherence_mean_square(32.4, 0.187) == pytest.approx(0.231**2 + 0.101**2, abs=0.0005)
