import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from estimators import bounds

LOOKS = st.floats(1.0, 1e6)
COHERENCE = st.floats(1e-6, 1 - 1e-12)


@given(LOOKS, st.floats(-60.0, 110.0))
def test_phase_bound_equals_its_form_in_the_snr(looks, snr_db):
    # K = (1/N)(1/rho + 1/(2 rho^2)); the coherence of a large SNR loses digits to rounding, 2e-16 rho of them.
    snr = 10 ** (snr_db / 10)
    coherence = snr / (1 + snr)
    expected = np.sqrt((1 / snr + 1 / (2 * snr**2)) / looks)
    assert bounds.phase_crlb(looks, coherence) == pytest.approx(expected, rel=1e-12 + 4e-16 * (1 + snr))


def test_depth_spread_of_paper_b():
    # Paper B: 39 cm at 400 m with 39 x 39 pixels of 0.4 looks; theory.md derives coherence .187 at c = 1480 m/s.
    slant = np.hypot(400.0, 42.0)
    spread = slant * 1480.0 / 0.3 / (2 * np.pi * 122e3) * bounds.phase_crlb(0.4 * 39**2, 0.187)
    assert spread == pytest.approx(0.39, abs=0.005)


@given(LOOKS, COHERENCE, st.floats(1e3, 1e6), st.floats(1e-4, 1.9))
def test_bounds_are_ordered_and_fall(looks, coherence, centre_frequency, ratio):
    bandwidth = ratio * centre_frequency
    coherent = bounds.coherent_delay_crlb(looks, coherence, centre_frequency, bandwidth)
    group = bounds.group_delay_crlb(looks, coherence, bandwidth)
    assert 0 < coherent <= group
    assert bounds.phase_crlb(2 * looks, coherence) < bounds.phase_crlb(looks, coherence)
    assert bounds.group_delay_crlb(looks, coherence, 2 * bandwidth) < group
    assert bounds.phase_crlb(looks, coherence**0.5) <= bounds.phase_crlb(looks, coherence)


@given(LOOKS, COHERENCE, st.floats(0.01, 0.5))
def test_thirds_are_the_best_sub_bands(looks, coherence, share):
    group = bounds.group_delay_crlb(looks, coherence, 1.0)
    thirds = bounds.split_spectrum_crlb(looks, coherence, 1.0, 1 / 3)
    assert thirds == pytest.approx(np.sqrt(9 / 8) * group, rel=1e-12)
    assert bounds.split_spectrum_crlb(looks, coherence, 1.0, share) >= thirds * (1 - 1e-12)


def test_outside_the_limits_there_is_no_bound():
    assert np.isnan(bounds.phase_crlb(0.0, 0.5))
    assert np.isnan(bounds.phase_crlb(9.0, 1.5))
    assert np.isnan(bounds.split_spectrum_crlb(9.0, 0.5, 1.0, 0.6))
    assert bounds.phase_crlb(9.0, 0.0) == np.inf
    assert bounds.phase_crlb(9.0, 1.0) == 0.0
