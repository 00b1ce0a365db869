"""Patches hold the looks that they state."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from estimators import FixedWindow
from sim import SONARS
from studies.patch import Patch

SONAR = SONARS["hisas-100khz"]


@given(st.integers(3, 400))
@settings(max_examples=40, deadline=None)
def test_the_window_that_is_the_record_has_as_many_looks(looks):
    patch = Patch(looks=looks, snr=3.0)
    pair = patch.simulate(SONAR, 1, np.random.default_rng(1))
    assert FixedWindow(*patch.record()).looks(pair) == pytest.approx(looks, rel=1e-9)
    assert pair.shape == patch.shape(SONAR, 1)


@pytest.mark.parametrize("looks", [4, 9, 16, 33])
def test_power_over_the_record_is_that_of_so_many_independent_looks(looks):
    # The mean power of a record of N looks has the variance 1 / N; of 20,000 records it is known to
    # sqrt(2 / 20,000) = 1 % and the kurtosis of a Gamma law, 3 + 6 / N. 5 standard errors: false alarm 6e-7.
    pair = Patch(looks=looks, coherence=0.5).simulate(SONAR, 20_000, np.random.default_rng(2))
    power = np.mean(np.abs(pair.primary) ** 2, axis=1)
    assert power.var() * looks == pytest.approx(1.0, abs=5 * np.sqrt((2 + 6 / looks) / 20_000))


def test_rare_trials_carry_a_ratio_of_mean_one():
    pair = Patch(looks=9, snr=20.0, sampling="rare").simulate(SONAR, 20_000, np.random.default_rng(3))
    weights = pair.likelihood_ratio
    assert weights.mean() == pytest.approx(1.0, abs=5 * weights.std() / np.sqrt(weights.size))
