import numpy as np
import pandas as pd
import pytest
from scipy.special import gamma

from sim import SEDIMENTS, scattering_strength
from sim.scattering import apl_uw
from sim.scattering.roughness import structure_constant

HANDBOOK_SPEED = 1528.0


def test_every_cell_of_the_handbook_is_met_to_a_tenth_of_a_decibel(oracle):
    table = oracle("tr9407")
    table = table[table.note.isna()]
    assert len(table) == 74
    for (name, khz, override), cells in table.groupby(
        ["sediment", "frequency_khz", "volume_parameter_override"], dropna=False
    ):
        sediment = SEDIMENTS[name]
        if not pd.isna(override):
            sediment = sediment.adjusted(volume_parameter=override)
        strength = scattering_strength(
            sediment, cells.grazing_deg, khz * 1e3, model="apl-uw", sound_speed=HANDBOOK_SPEED
        )
        np.testing.assert_allclose(strength, cells.strength_db, atol=0.1, rtol=0)


def test_the_doubtful_cell_stays_doubtful():
    # The file marks rock at 40 degrees, -10.0 dB, as a doubtful reading: its neighbours at 20 and 60 degrees are met.
    strength = scattering_strength("rock", 40.0, 30e3, sound_speed=HANDBOOK_SPEED)
    assert strength == pytest.approx(-10.59, abs=0.01)


@pytest.mark.parametrize("angle", [60.0, 75.0, 85.0, 89.0])
def test_kirchhoff_follows_its_integral(angle):
    """At `alpha = 1/2` the integral is closed: `int J0(u) exp(-p u) u du = p / (1 + p^2)^(3/2)`.

    The Kirchhoff cross section is `|R|^2 / (8 pi cos^2 th sin^2 th)` times it with `p = Ch2 q3^2 / (2 q)`.
    """
    bed = SEDIMENTS["medium sand"].adjusted(spectral_exponent=3.0, spectral_strength_cm4=0.01).fluid
    th, k = np.radians(angle), 2 * np.pi * 30e3 / 1500
    constant = structure_constant(bed.spectral_strength_si, 3.0)
    p = constant * (2 * k * np.sin(th)) ** 2 / 2 / (2 * k * np.cos(th))
    nadir = abs(apl_uw.reflection(bed, np.asarray(np.pi / 2))) ** 2
    exact = nadir / (8 * np.pi * np.cos(th) ** 2 * np.sin(th) ** 2) * p / (1 + p**2) ** 1.5
    found, _ = apl_uw._kirchhoff(bed, np.asarray(th), np.asarray(k))
    # The two differ by the powers of sin th that the handbook leaves out near the vertical.
    assert 10 * np.log10(found / exact) == pytest.approx(0.0, abs=0.01)


def test_structure_constant_of_a_known_spectrum():
    # gamma = 3 (alpha = 1/2): the structure function 2 int (1 - cos K.x) w K^-3 d2K = 4 pi w x.
    assert structure_constant(1.0, 3.0) == pytest.approx(4 * np.pi, rel=1e-12)
    # Any exponent: int_0^inf (1 - J0(u)) u^(-1 - 2 alpha) du = Γ(1 - alpha) / (2^(2 alpha + 1) alpha Γ(1 + alpha)).
    for exponent in (2.4, 2.75, 3.25, 3.9):
        a = exponent / 2 - 1
        expected = 4 * np.pi * gamma(1 - a) / (2 ** (2 * a + 1) * a * gamma(1 + a))
        assert structure_constant(1.0, exponent) == pytest.approx(expected, rel=1e-12)
