"""Scenes with a sediment: levels from the sonar equation."""

from dataclasses import replace

import numpy as np
import pytest

from sim import SEDIMENTS, SONARS, Box, Scene, Wedge, scattering_strength, simulate, snr
from sim.levels import level_of_sediment, range_gain
from sim.profile import SeabedPoints

SONAR = SONARS["hisas-1032"]


def ground_range(pair):
    slant = pair.grid.times * SONAR.sound_speed / 2
    return np.sqrt(np.maximum(slant**2 - SONAR.altitude**2, 0.0))


@pytest.mark.parametrize("name", ["silt", "coarse sand"])
def test_power_over_the_swath_is_that_of_the_sonar_equation(name):
    """Mean power `1 + snr` in stretches of 4 m; 60 rows.

    A mean of N exponential powers has a spread of `1 / sqrt(N)`; 85 stretches at 5.5 standard errors are 3e-6 in all.
    """
    pair = simulate(Scene((35.0, 420.0), sediment=name), SONAR, rng=np.random.default_rng(20), rows=60)
    y = ground_range(pair)
    for near in np.arange(45.0, 396.0, 4.0):
        inside = (y >= near) & (y < near + 4)
        looks = 60 * inside.sum() * pair.bandwidth / pair.sample_rate
        expected = 1 + np.mean(10 ** (snr(SONAR, name, y[inside]) / 10))
        for series in (pair.primary, pair.secondary):
            assert np.mean(np.abs(series[:, inside]) ** 2) == pytest.approx(expected, rel=5.5 / np.sqrt(looks))


def test_noise_has_unit_power_in_both_receivers():
    scene = Scene((350.0, 420.0), sediment=SEDIMENTS["clay"].adjusted(level_offset=-100.0))
    pair = simulate(scene, SONAR, rng=np.random.default_rng(21), rows=100)
    looks = 100 * pair.shape[1] * pair.bandwidth / pair.sample_rate
    for series in (pair.primary, pair.secondary):
        assert np.mean(np.abs(series) ** 2) == pytest.approx(1.0, abs=5 / np.sqrt(looks))


def test_level_follows_the_local_grazing_angle():
    """The near slope of a wedge, its far slope and the floor behind, with angles by hand."""
    scene = Scene((50.0, 200.0), (Wedge(100.0, 20.0, 10.0),), sediment="sand")
    # Segments 1, 2 and 3, half-way along.
    points = SeabedPoints(np.array([1, 2, 3]), np.full(3, 0.5))
    power = level_of_sediment(scene, SONAR, scene.profile(), points, np.ones(3))
    level = 10 * np.log10(power[[0, 2]])
    # At (105, 5) from 42 m: the ray falls by atan(37 / 105) = 19.41 degrees, the slope rises by 45.
    beams = [
        sum(
            part.beam.level(np.degrees(np.arctan2(h, y)), SONAR.wavelength)
            for part in (SONAR.transmitter, SONAR.receiver)
        )
        for h, y in ((37.0, 105.0), (42.0, 160.0))
    ]
    strengths = scattering_strength(
        "sand", [45 + 19.412, np.degrees(np.arctan2(42, 160))], 122e3, model="small-slope", sound_speed=1480.0
    )
    assert level[0] - level[1] == pytest.approx(strengths[0] - strengths[1] + beams[0] - beams[1], abs=1e-3)
    # The far slope falls by 45 degrees, the ray by 17.8: it is not lit.
    assert power[1] == 0


def test_a_wall_is_brighter_than_the_floor():
    scene = Scene((80.0, 140.0), (Box(110.0, 3.0, 4.0),), sediment="silt")
    pair = simulate(scene, SONAR, rng=np.random.default_rng(22), rows=40)
    y = ground_range(pair)
    power = np.mean(np.abs(pair.primary) ** 2, axis=0)
    # Its edge at (110, 4) is as far as the floor at 108.5 m, and as bright as seen at 69 degrees; the far edge of the
    # top, (113, 4), as far as 111.6 m, and its shadow reaches 113 42 / 38 = 124.9 m.
    wall, floor, shadow = (power[(y > a) & (y < b)].mean() for a, b in ((108.7, 109.8), (90.0, 98.0), (114, 123)))
    assert wall > 3 * floor
    # What is left are side lobes of the flat band, not noise: 1 / (pi B t)^2 of each resolution cell around.
    assert 1.0 < shadow < 1e-3 * floor


def test_range_gain_is_the_loss_between_two_ranges():
    times = 2 * np.array([100.0, 200.0]) / SONAR.sound_speed
    gain = 20 * np.log10(range_gain(SONAR, times))
    alpha = SONAR.water.absorption(122e3)
    # 12.04 dB of spreading, 3.01 dB of aperture, 100 m there and back.
    assert gain[0] - gain[1] == pytest.approx(12.0412 - 3.0103 + 200 * alpha, abs=1e-3)


def test_scattering_model_matters():
    scene = Scene((90.0, 110.0), sediment="rock")
    pairs = [
        simulate(
            replace(scene, scattering=model),
            replace(SONAR, centre_frequency=100e3),
            rng=np.random.default_rng(3),
            rows=20,
        )
        for model in ("apl-uw", "small-slope")
    ]
    powers = [10 * np.log10(np.mean(np.abs(pair.primary) ** 2)) for pair in pairs]
    angle = np.degrees(np.arctan2(42, 100))
    strengths = [
        scattering_strength("rock", angle, 100e3, model=model, sound_speed=1480.0)
        for model in ("apl-uw", "small-slope")
    ]
    assert powers[0] - powers[1] == pytest.approx(strengths[0] - strengths[1], abs=0.5)


def test_same_seed_same_bits():
    scene = Scene((60.0, 90.0), (Box(70.0, 5.0, 1.0),), sediment="sand")
    first, second = (simulate(scene, SONAR, rng=np.random.default_rng(9), rows=2) for _ in range(2))
    assert first.primary.tobytes() == second.primary.tobytes()
    assert first.secondary.tobytes() == second.secondary.tobytes()


@pytest.mark.parametrize(
    ("build", "message"),
    [
        (
            lambda: simulate(Scene((20.0, 30.0), sediment="sand"), SONAR, rng=np.random.default_rng(0), snr=3.0),
            "snr is 3 dB; it must be left out for a scene whose sediment gives the levels",
        ),
        (lambda: Scene((20.0, 30.0), sediment="snad"), "sediment is 'snad'; the closest names are sand"),
        (lambda: Scene((20.0, 30.0), scattering="x"), "scattering is 'x'; it must be apl-uw or small-slope"),
    ],
)
def test_bad_input(build, message):
    with pytest.raises(ValueError, match=f"^{message}$"):
        build()
