import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.stats import beta

from estimators.bounds.quadrature import beta_nodes


@given(st.floats(0.05, 1e5), st.floats(0.05, 1e5))
def test_nodes_have_the_moments_of_the_distribution(first, second):
    nodes, weights = beta_nodes(first, second, 12)
    mean, variance, skew = (float(m) for m in beta.stats(first, second, moments="mvs"))
    assert weights.sum() == pytest.approx(1.0, abs=1e-12)
    assert weights @ nodes == pytest.approx(mean, rel=1e-9)
    assert weights @ (nodes - mean) ** 2 == pytest.approx(variance, rel=1e-6)
    assert weights @ (nodes - mean) ** 3 == pytest.approx(skew * variance**1.5, abs=1e-5 * variance**1.5)
    assert np.all((nodes > -1e-12) & (nodes < 1 + 1e-12))
