from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sim import (
    SEDIMENTS,
    SONARS,
    GaussianBeam,
    Noise,
    Receiver,
    SincBeam,
    Sonar,
    SyntheticAperture,
    Transmitter,
    Water,
    scattering_strength,
    snr,
    sonar_equation,
)

HISAS = SONARS["hisas-1032"]

PLAIN = Sonar(
    centre_frequency=100e3,
    bandwidth=30e3,
    baseline=0.3,
    altitude=30.0,
    transmitter=Transmitter(source_level=205.0, pulse_length=8e-3, beam=GaussianBeam(width=20.0, depression=30.0)),
    receiver=Receiver(beam=SincBeam(height=0.015, depression=0.0), directivity_index=15.0),
    aperture=SyntheticAperture(resolution=0.05, phase_centre_spacing=0.02),
    noise=Noise(wind_speed=0.0, excess=3.0),
    water=Water(temperature=8.0, depth=200.0),
)


def test_preset_of_paper_b_is_tuned_to_its_data():
    # rho = gamma / (1 - gamma) with gamma = .187, which its windows imply at 400 m (theory, section 6).
    assert snr(HISAS, "coarse sand", 400.0) == pytest.approx(-6.4, abs=0.001)


def test_snr_varies_by_more_than_40_db_over_the_swath():
    # Paper B: "more than 40 dB over the desired ground range interval for some of the seabed types".
    ground_range = np.linspace(42.0, 400.0, 300)
    for name in ("silt", "medium sand", "coarse sand", "rock"):
        for model in ("apl-uw", "small-slope"):
            levels = snr(HISAS, name, ground_range, model=model)
            assert 40 < np.ptp(levels) < 80


def test_snr_rises_at_near_range_and_falls_at_far_range():
    # As paper B sees it: first the beam of the transmitter, then losses and grazing angle.
    levels = snr(HISAS, "coarse sand", [42.0, 50.0, 200.0, 300.0, 400.0])
    assert levels[1] > levels[0]
    assert np.all(np.diff(levels[2:]) < -5)


def test_terms_by_hand():
    """45 degrees at 30 m altitude: every term from its formula, with pencil and paper."""
    terms = sonar_equation(PLAIN, "sand", 30.0)
    assert terms.slant_range == pytest.approx(42.4264, abs=1e-4)
    assert terms.grazing_angle == pytest.approx(45.0)
    assert terms.transmit_beam == pytest.approx(-3.0103 * (15 / 10) ** 2, abs=1e-3)
    # sinc(0.70711) = sin(2.22144) / 2.22144 = 0.35818
    assert terms.receive_beam == pytest.approx(20 * np.log10(0.35818), abs=1e-3)
    assert terms.spreading == pytest.approx(65.1054, abs=1e-3)
    # 30.877 dB/km in the oracle.
    assert terms.absorption == pytest.approx(2 * 0.0424264 * 30.877, abs=1e-3)
    # 5 cm by 2.5 cm / cos 45 degrees.
    assert terms.area == pytest.approx(10 * np.log10(0.05 * 0.035355), abs=1e-3)
    # Thermal 25, calm sea 50 + 40 - 80.07; 10 log 30000 = 44.771.
    spectral = 10 * np.log10(10**2.5 + 10**0.9931) + 3
    assert terms.noise_level == pytest.approx(spectral + 44.771 - 15, abs=1e-2)
    assert terms.pulse_gain == pytest.approx(10 * np.log10(240), abs=1e-9)
    # 1.5 cm 42.43 m / (2 5 cm) = 6.364 m of aperture, at 2 cm.
    assert terms.aperture_gain == pytest.approx(10 * np.log10(318.2), abs=1e-3)
    by_hand = (
        205.0
        + terms.transmit_beam
        + terms.receive_beam
        - terms.spreading
        - terms.absorption
        + terms.scattering_strength
        + terms.area
        - terms.noise_level
        + terms.pulse_gain
        + terms.aperture_gain
    )
    assert terms.snr == pytest.approx(by_hand, abs=1e-9)
    assert terms.scattering_strength == scattering_strength("sand", 45.0, 100e3, model="small-slope")


def test_nadir_is_finite_and_its_cell_a_disc():
    terms = sonar_equation(PLAIN, "sand", [0.0, 1e-6])
    # Within c / (4 B) = 1.25 cm of 30 m: sqrt(30.0125^2 - 30^2) = 0.8661 m.
    np.testing.assert_allclose(terms.area, 10 * np.log10(0.05 * 0.8661), atol=1e-3)
    assert np.isfinite(terms.scattering_strength).all()


def test_cell_length_keeps_its_digits_at_long_range():
    far = replace(PLAIN, altitude=1.0)
    assert sonar_equation(far, "sand", 1e5).area == pytest.approx(10 * np.log10(0.05 * 0.025), abs=1e-9)


@given(y=st.floats(1.0, 1e3), gain=st.floats(-30, 30))
def test_level_offset_source_level_and_noise_shift_the_ratio(y, gain):
    louder = replace(HISAS, transmitter=replace(HISAS.transmitter, source_level=HISAS.transmitter.source_level + gain))
    noisier = replace(HISAS, noise=replace(HISAS.noise, excess=gain))
    brighter = SEDIMENTS["sand"].adjusted(level_offset=gain)
    before = snr(HISAS, "sand", y)
    assert snr(louder, "sand", y) == pytest.approx(before + gain)
    assert snr(HISAS, brighter, y) == pytest.approx(before + gain)
    assert snr(noisier, "sand", y) == pytest.approx(before - gain)


def test_phase_centres_grow_with_range():
    aperture = SyntheticAperture(resolution=0.05, phase_centre_spacing=0.02)
    centres = aperture.phase_centres(np.array([0.01, 100.0, 200.0]), 0.015)
    np.testing.assert_allclose(centres, [1.0, 750.0, 1500.0])


def test_noise_of_a_calm_sea_is_thermal_at_high_frequency():
    # Mellen: -15 + 20 log f_kHz.
    assert Noise(wind_speed=0.0).spectral_level(500e3) == pytest.approx(-15 + 20 * np.log10(500), abs=0.1)
    # Wenz's rule of fives gives 21 dB at 122 kHz in 10 knots, and thermal noise is 26.7 dB there.
    assert Noise(wind_speed=5.0).spectral_level(122e3) == pytest.approx(10 * np.log10(10**2.1 + 10**2.67), abs=2)


def test_beams():
    sinc = SincBeam(height=0.03, depression=20.0)
    angle = np.array([20.0, 20 + np.degrees(np.arcsin(0.5)), 20 + np.degrees(np.arcsin(0.4429 / 2))])
    levels = sinc.level(angle, 0.015)
    assert levels[0] == 0.0
    # The first null is finite in rounding only; -3.01 dB where sinc^2 is one half, at 0.4429.
    assert levels[1] < -200
    assert levels[2] == pytest.approx(-3.01, abs=0.005)
    gaussian = GaussianBeam(width=40.0, depression=10.0)
    np.testing.assert_allclose(gaussian.level(np.array([10.0, 30.0, -10.0]), 0.015), [0, -3.0103, -3.0103], atol=1e-3)


def test_presets_say_what_is_assumed():
    for sonar in SONARS.values():
        assert "source level, pulse length, vertical beams" in sonar.assumed
    assert "tuned" in HISAS.assumed


@pytest.mark.parametrize(
    ("build", "message"),
    [
        (lambda: snr(HISAS, "sand", -1.0), "ground_range is -1 m at the least; all must be finite and not below 0 m"),
        (lambda: snr(HISAS, "snad", 10.0), "sediment is 'snad'; the closest names are sand"),
        (lambda: snr(HISAS, "sand", 10.0, model="x"), "model is 'x'; it must be apl-uw or small-slope"),
        (lambda: SincBeam(height=0.0, depression=0.0), "height is 0 m; it must be above 0 m"),
        (
            lambda: GaussianBeam(width=9.0, depression=100.0),
            "depression is 100 degrees; it must lie between -90 and 90 .*",
        ),
        (lambda: Transmitter(pulse_length=0.0), "pulse_length is 0 s; it must be above 0 s"),
        (lambda: SyntheticAperture(resolution=-1.0), "resolution is -1 m; it must be above 0 m"),
        (lambda: Noise(wind_speed=-1.0), "wind_speed is -1 m/s; it must lie between 0 and 60 m/s"),
        (lambda: Receiver(directivity_index=np.inf), "directivity_index is inf; it must be finite"),
    ],
)
def test_bad_input(build, message):
    with pytest.raises(ValueError, match=f"^{message}$"):
        build()
