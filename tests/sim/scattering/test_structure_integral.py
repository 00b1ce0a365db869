import contextlib

import numpy as np
import pytest
import small_slope_twin as twin
from hypothesis import given, settings
from hypothesis import strategies as st

from sim.scattering.roughness import HIGHEST, LOWEST, log_structure_integral, structure_integral

# alpha of the exponents 2.4 to 3.9.
ALPHAS = [0.2, 0.27, 0.375, 0.5, 0.625, 0.75, 0.95]


def reference(alpha):
    """`ln p`, and the logarithm of the integral wherever a series gives it."""
    for x in np.concatenate([[LOWEST, HIGHEST, -40.0, 40.0, 90.0], np.linspace(-12, 12, 17)]):
        with contextlib.suppress(ArithmeticError):
            yield float(x), float(twin.mp.log(twin.integral(twin.mp.exp(x), alpha)))


@pytest.mark.parametrize("alpha", ALPHAS)
def test_quadrature_and_table_against_series(alpha):
    logs, expected = np.array(list(reference(alpha))).T
    assert len(logs) >= 15
    inside = (logs >= LOWEST) & (logs <= HIGHEST)
    np.testing.assert_allclose(structure_integral(logs[inside], alpha), expected[inside], atol=1e-12, rtol=0)
    np.testing.assert_allclose(log_structure_integral(logs, alpha), expected, atol=1e-8, rtol=0)


@settings(max_examples=40, deadline=None)
@given(alpha=st.floats(0.2, 0.95), x=st.floats(LOWEST, HIGHEST))
def test_table_equals_quadrature(alpha, x):
    np.testing.assert_allclose(
        log_structure_integral(np.array([x]), alpha), structure_integral(np.array([x]), alpha), atol=2e-8, rtol=0
    )
