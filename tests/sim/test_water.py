import numpy as np
import pytest

from sim import SONARS, Water, absorption


@pytest.mark.parametrize("model", ["francois-garrison", "ainslie-mccolm"])
def test_absorption(oracle, model):
    table = oracle("absorption")
    for row in table.itertuples():
        water = {"temperature": row.temperature_c, "salinity": row.salinity, "depth": row.depth_m, "ph": row.ph}
        expected = getattr(row, f"{model.replace('-', '_')}_db_per_km")
        assert absorption(row.frequency_khz * 1e3, **water, model=model) * 1e3 == pytest.approx(expected, abs=0.001)


def test_sound_speed():
    # Mackenzie (1981) gives this value to check programs against.
    assert Water(temperature=25.0, salinity=35.0, depth=1000.0).sound_speed == pytest.approx(1550.744, abs=5e-4)


def test_warm_water_follows_its_own_polynomial():
    # The two polynomials of pure water meet at 20 deg C to 1 %; at 1 MHz it is most of the absorption.
    below, above = (absorption(1e6, temperature=t, salinity=0.0) for t in (20.0, 20.001))
    assert above == pytest.approx(below, rel=0.01)
    # Fresh water at 30 deg C and 1 MHz: 19.1e-15 s^2 / m (Pinkerton 1949), that is 166 dB / km.
    assert absorption(1e6, temperature=30.0, salinity=0.0) * 1e3 == pytest.approx(166, rel=0.05)


def test_absorption_broadcasts_from_rest():
    levels = absorption(np.array([[0.0, 1e3], [1e4, 1e5]]), salinity=0.0)
    assert levels.shape == (2, 2)
    assert levels[0, 0] == 0.0
    assert np.all(np.diff(levels.ravel()) > 0)


def test_a_sonar_moves_to_other_water():
    warm = Water(temperature=25.0, salinity=35.0, depth=1000.0)
    moved = SONARS["hisas-1032"].in_water(warm)
    assert moved.sound_speed == pytest.approx(1550.744, abs=5e-4)
    assert moved.water is warm


def test_the_water_of_paper_b_has_its_sound_speed():
    assert SONARS["hisas-1032"].water.sound_speed == pytest.approx(SONARS["hisas-1032"].sound_speed, abs=0.5)


@pytest.mark.parametrize(
    ("build", "message"),
    [
        (lambda: Water(temperature=50.0), "temperature is 50 deg C; it must lie between -4 and 40 deg C"),
        (lambda: Water(ph=1.0), "ph is 1; it must lie between 7 and 9"),
        (lambda: absorption(-1.0), "frequency is -1 Hz; it must be finite and not below 0 Hz"),
        (lambda: absorption(1e5, model="thorp"), "model is 'thorp'; it must be francois-garrison or ainslie-mccolm"),
    ],
)
def test_bad_input(build, message):
    with pytest.raises(ValueError, match=f"^{message}$"):
        build()


def test_absorption_broadcasts_over_all_that_it_depends_on():
    frequency, temperature = np.array([[60e3], [100e3], [120e3]]), np.array([4.0, 10.0, 25.0])
    depth = np.array([0.0, 200.0, 1000.0])
    found = absorption(frequency, temperature=temperature, depth=depth)
    for i, j in np.ndindex(3, 3):
        alone = absorption(frequency[i, 0], temperature=temperature[j], depth=depth[j])
        assert found[i, j] == pytest.approx(float(alone), rel=1e-14)
    with pytest.raises(ValueError, match=r"^temperature is 99 deg C; it must lie between -4 and 40 deg C$"):
        absorption(1e5, temperature=[4.0, 99.0])
    with pytest.raises(ValueError, match=r"^frequency is inf Hz; it must be finite and not below 0 Hz$"):
        absorption([1e5, np.inf])
