import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sim import SONARS, Geometry, Sonar
from sim.geometry import plane_delay, travel_times

SONAR = st.builds(
    Sonar,
    centre_frequency=st.just(100e3),
    bandwidth=st.just(30e3),
    baseline=st.floats(0.01, 2.0),
    altitude=st.floats(3.0, 200.0),
    sound_speed=st.floats(1400.0, 1600.0),
)


def by_pythagoras(sonar, ground_range, height):
    slant = np.sqrt(ground_range**2 + (sonar.altitude - height) ** 2)
    slant_secondary = np.sqrt(ground_range**2 + (sonar.altitude + sonar.baseline - height) ** 2)
    return 2 * slant / sonar.sound_speed, (slant + slant_secondary) / sonar.sound_speed


@given(SONAR, st.floats(1.0, 1000.0))
def test_registration_leaves_no_delay_of_the_plane(sonar, ground_range):
    primary, secondary = by_pythagoras(sonar, ground_range, 0.0)
    assert plane_delay(sonar, primary) == pytest.approx(secondary - primary, abs=1e-15)
    assert Geometry(sonar, 0.0).registered_delay(primary, secondary) == pytest.approx(0.0, abs=1e-15)


@given(SONAR, st.floats(1.0, 5.0), st.floats(-0.5, 0.5))
def test_height_comes_back_from_the_registered_delay(sonar, range_over_altitude, height_over_altitude):
    height = height_over_altitude * sonar.altitude
    times = travel_times(sonar, range_over_altitude * sonar.altitude, height)
    geometry = Geometry(sonar, 0.0)
    delay = geometry.registered_delay(*times)
    # A rounding of the times is carried by r c / D into the height.
    rounding = 1e-15 * times[0] * sonar.sound_speed**2 * times[0] / sonar.baseline
    assert geometry.height(times[0], delay) == pytest.approx(height, abs=rounding + 1e-12)


def test_a_higher_seabed_is_heard_sooner_above_by_the_first_order_rule():
    sonar = SONARS["hisas-100khz"]
    slant, height = 60.0, 1e-3
    depression = sonar.altitude - height
    primary, secondary = by_pythagoras(sonar, np.sqrt(slant**2 - depression**2), height)
    delay = Geometry(sonar, 0.0).registered_delay(primary, secondary)
    assert delay == pytest.approx(-sonar.baseline * height / (sonar.sound_speed * slant), rel=0.01)


def test_plane_delay_is_baseline_times_altitude_over_slant_range():
    sonar = SONARS["hisas-1032"]
    slant = 400.0
    delay = plane_delay(sonar, 2 * slant / sonar.sound_speed)
    assert delay == pytest.approx(sonar.baseline * sonar.altitude / (sonar.sound_speed * slant), rel=0.01)
