from dataclasses import replace

import numpy as np
import pytest

from sim import SONARS, Box, Scene, coherence_terms, expected_coherence, simulate, snr
from sim.coherence import baseline_coherence, footprint_coherence, noise_coherence

NEAR, FAR = SONARS["hisas-100khz"], SONARS["hisas-1032"]


def test_channel_noise():
    # Paper B, equation 4: rho = mu / (1 - mu).
    assert noise_coherence(10 * np.log10(0.187 / 0.813)) == pytest.approx(0.187)
    np.testing.assert_allclose(noise_coherence([-np.inf, 0.0, np.inf, 4000.0]), [0.0, 0.5, 1.0, 1.0])


@pytest.mark.parametrize(
    ("altitude", "slant", "loss", "digit"),
    # Theory, section 7, at 100 kHz; half of its last digit, and 0.01 of the loss for D / (4 H), which it leaves out.
    [
        (15, 15.5, 0.031, 8e-4),
        (15, 30, 0.0083, 1.3e-4),
        (15, 100, 7.5e-4, 1.3e-5),
        (42, 60, 0.0058, 1e-4),
        (42, 400, 1.3e-4, 6e-6),
    ],
)
def test_baseline(altitude, slant, loss, digit):
    assert 1 - baseline_coherence(replace(NEAR, altitude=altitude), slant) == pytest.approx(loss, abs=digit)


def test_baseline_loss_is_the_derivative_of_the_delay():
    slant, step = 20.0, 1e-3
    excess = NEAR.baseline * (NEAR.baseline + 2 * NEAR.altitude)
    delay = [(np.sqrt(r**2 + excess) - r) / NEAR.sound_speed for r in (slant - step, slant + step)]
    stretch = (delay[0] - delay[1]) / (4 * step / NEAR.sound_speed)
    expected = 1 - NEAR.centre_frequency * stretch / NEAR.bandwidth
    assert baseline_coherence(NEAR, slant) == pytest.approx(expected, abs=1e-8)


def test_baseline_loss_ends_at_nothing():
    assert baseline_coherence(NEAR, 0.1) == 0.0


def test_footprint():
    # sinc(1/2) where B D dz / (c r) = 1/2; nothing left at the first null.
    half = 0.5 * NEAR.sound_speed * 50.0 / (NEAR.bandwidth * NEAR.baseline)
    assert footprint_coherence(NEAR, 50.0, half) == pytest.approx(2 / np.pi)
    assert footprint_coherence(NEAR, 50.0, 2 * half) == pytest.approx(0.0, abs=1e-12)
    assert footprint_coherence(NEAR, 50.0, -half) == pytest.approx(2 / np.pi)


def test_footprint_shift_of_simulated_echoes():
    """Coherence at zero lag on a plateau 1 m above the plane of registration.

    The spread of a sample coherence g of N looks is (1 - g^2) / sqrt(2 N); 5 standard errors, 6e-7.
    """
    pair = simulate(Scene((28.0, 60.0), (Box(30.0, 25.0, 1.0),)), NEAR, rng=np.random.default_rng(8), rows=400)
    slant = pair.grid.times * NEAR.sound_speed / 2
    on_top = np.abs(slant - 45.0) < 0.3
    primary, secondary = pair.primary[:, on_top], pair.secondary[:, on_top]
    energy = np.sqrt(np.sum(np.abs(primary) ** 2) * np.sum(np.abs(secondary) ** 2))
    carried = np.exp(2j * np.pi * NEAR.centre_frequency * pair.truth.delay[on_top])
    found = np.abs(np.sum(primary.conj() * secondary * carried)) / energy
    footprint = footprint_coherence(NEAR, slant[on_top], 1.0).mean()
    assert footprint == pytest.approx(np.sinc(NEAR.bandwidth * pair.truth.delay[on_top].mean()), abs=1e-3)
    expected = footprint * baseline_coherence(NEAR, 45.0)
    looks = 400 * on_top.sum() * pair.bandwidth / pair.sample_rate
    assert found == pytest.approx(expected, abs=5 * (1 - expected**2) / np.sqrt(2 * looks) + 1e-3)


def test_product():
    ground_range = np.array([45.0, 100.0, 400.0])
    terms = coherence_terms(FAR, "coarse sand", ground_range, height=0.5)
    np.testing.assert_allclose(terms.product, terms.noise * terms.baseline * terms.footprint)
    np.testing.assert_array_equal(terms.product, expected_coherence(FAR, "coarse sand", ground_range, height=0.5))
    np.testing.assert_allclose(terms.noise, noise_coherence(snr(FAR, "coarse sand", ground_range)))
    # -6.4 dB.
    assert expected_coherence(FAR, "coarse sand", 400.0) == pytest.approx(0.1863, abs=5e-4)
