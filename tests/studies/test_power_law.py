"""Fitted exponents against costs whose law is known."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from studies.power_law import power_law


@settings(deadline=None, max_examples=30)
@given(st.floats(-1.0, 2.5), st.floats(1e-9, 1e6), st.floats(0.0, 3.0))
def test_a_law_without_noise_is_found(exponent, scale, part):
    """A fixed cost is looked for where it can be told: beside a cost that grows."""
    size = 4.0 ** np.arange(7)
    fixed = part * scale if exponent > 0.5 else 0.0
    found = power_law(size, fixed + scale * size**exponent, fixed=exponent > 0.5)
    assert found.exponent == pytest.approx(exponent, abs=1e-4)
    np.testing.assert_allclose(found.at(size), fixed + scale * size**exponent, rtol=1e-3)


@pytest.mark.parametrize(("exponent", "part", "fixed"), [(1.0, 1.0, True), (1.1, 0.2, True), (0.0, 0.0, False)])
def test_exponents_scatter_as_their_standard_errors_say(exponent, part, fixed):
    """300 fits to costs that err by 2 %: unbiased, and errors over standard errors as Student's t."""
    rng, size, count = np.random.default_rng(5), 4.0 ** np.arange(7), 300
    noise = 0.02 * rng.normal(size=(count, size.size))
    found = [power_law(size, (part + size**exponent) * np.exp(line), fixed=fixed) for line in noise]
    errors = np.array([law.exponent for law in found]) - exponent
    # Exact for a straight line; that of the curved fit to first order, from its Jacobian in exponent, scale and fixed.
    cost = part + size**exponent
    columns = [size**exponent * np.log(size) / cost, size**exponent / cost, *([1 / cost] if fixed else [])]
    jacobian = np.stack(columns, axis=1)
    spread = 0.02 * np.sqrt(np.linalg.inv(jacobian.T @ jacobian)[0, 0])
    # Five standard errors each, 6e-7; the spread is within a tenth more for what is of second order.
    assert abs(errors.mean()) < 5 * spread / np.sqrt(count) + 0.02 * spread
    assert abs(errors.std() / spread - 1) < 5 / np.sqrt(2 * count) + 0.1
    claimed = np.array([law.exponent_se for law in found])
    # Their mean square estimates the variance, of 4 or 5 degrees of freedom each.
    assert abs(np.mean(claimed**2) / spread**2 - 1) < 5 * np.sqrt(2 / 4 / count) + 0.1


def test_a_fixed_cost_that_is_ignored_hides_the_exponent():
    size = 4.0 ** np.arange(7)
    cost = 100 + size
    assert power_law(size, cost, fixed=False).exponent < 0.7
    assert power_law(size, cost, fixed=True).fixed == pytest.approx(100, rel=1e-3)


def test_as_many_sizes_as_unknowns_leave_no_standard_error():
    found = power_law([1, 2], [4.0, 2.0], fixed=False)
    assert found.exponent == pytest.approx(-1.0)
    assert np.isnan(found.exponent_se)


@pytest.mark.parametrize(
    ("size", "cost", "said"),
    [([1, 2], [1.0, 0.0], "all above 0"), ([1, 2], [1.0], "must be one"), ([1, 1, 2], [1.0, 1, 2], "3 unknowns")],
)
def test_what_cannot_be_fitted_is_said(size, cost, said):
    with pytest.raises(ValueError, match=said):
        power_law(size, cost, fixed=True)
