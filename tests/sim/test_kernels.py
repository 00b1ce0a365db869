"""Compiled loops against array operations, direct sums and multiple precision."""

from dataclasses import replace

import mpmath
import numpy as np
import pytest
import section_twin as twin
from hypothesis import given, settings
from hypothesis import strategies as st

from sim import (
    SEDIMENTS,
    SONARS,
    Box,
    HeightMap,
    Roughness,
    Scene,
    SedimentPatch,
    Slope,
    Step,
    TrawlMark,
    Wedge,
    plan,
    simulate,
)
from sim.geometry import Geometry, travel_times
from sim.levels import _beams, _strengths, level_of_sediment
from sim.passes import recorded, scale, turn
from sim.profile import SeabedPoints
from sim.survey import SURVEYED, survey
from sim.transforms import to_series, to_spectrum
from sim.warp import _spread

SONAR = SONARS["hisas-1032"]


@st.composite
def scenes(draw, **options):
    """Anything that stands on a floor from 40 to 100 m, in any order."""
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    start = rng.integers(41, 90, 8) * 1.0
    kinds = [
        Box(start[0], float(rng.integers(1, 9)), 1.0, (0.0, 1.0)),
        Box(start[1], 3.0, 0.5),
        Wedge(start[2], 4.0, 1.0),
        Step(start[3], 0.5),
        Slope(start[4], 5.0, -1.0),
        TrawlMark(rng.uniform(30, 110), rng.choice([0.0, 30.0, -70.0, 90.0])),
        HeightMap(rng.standard_normal((4, 30)), (0.0, 45.0), (1.0, 1.0)),
        Roughness(0.1, 1, period=6.4),
    ]
    return Scene((40.0, 100.0), draw(st.lists(st.sampled_from(kinds), max_size=6)), **options)


@settings(max_examples=200, deadline=None)
@given(scenes(), st.floats(-1.0, 3.0))
def test_a_section_is_that_of_array_operations(scene, along_track):
    found, expected = scene.profile(along_track), twin.profile(scene, along_track)
    np.testing.assert_array_equal(found.ground_range, expected.ground_range)
    np.testing.assert_array_equal(found.height, expected.height)


@settings(max_examples=100, deadline=None)
@given(scenes(), st.floats(-1.0, 3.0), st.floats(-10.0, 20.0))
def test_a_survey_is_that_of_array_operations(scene, along_track, snr):
    found = survey(scene, SONAR, [along_track], snr)
    noise = np.full(SURVEYED, 1 / (1 + 10 ** (snr / 10)))
    expected = twin.surveyed(scene.profile(along_track), SONAR, np.linspace(40.0, 100.0, SURVEYED), noise)
    assert found[1:3] == expected[:2]
    assert found[3:] == pytest.approx(expected[2:], rel=1e-9)


@settings(max_examples=60, deadline=None)
@given(scenes(sediment="sand", patches=(SedimentPatch((50.0, 70.0), "rock"), SedimentPatch((60.0, 80.0), "silt"))))
def test_levels_are_read_from_their_tables(scene):
    rng, profile = np.random.default_rng(1), scene.profile(0.5)
    segment = np.sort(rng.choice(np.flatnonzero(profile.lengths > 0), 500))
    points = SeabedPoints(segment, rng.uniform(0, 1, 500))
    ends = [(-np.inf, np.inf, "sand"), (50.0, 70.0, "rock"), (60.0, 80.0, "silt")]
    tables = [
        (near, far, _strengths(SEDIMENTS[name], SONAR.centre_frequency, SONAR.sound_speed, scene.scattering))
        for near, far, name in ends
    ]
    expected = 0.1 * SONAR.aperture.resolution * twin.power(profile, points, SONAR.altitude, tables, _beams(SONAR))
    found = level_of_sediment(scene, SONAR, profile, points, np.full(500, 0.1))
    np.testing.assert_allclose(found, expected, rtol=1e-9, atol=1e-12 * expected.max())


@settings(max_examples=200, deadline=None)
@given(st.floats(-1e9, 1e9))
def test_a_turn_is_that_of_multiple_precision(turns):
    series = np.ones(1, dtype=complex)
    turn(series, np.array([turns]), np.ones(1))
    with mpmath.workdps(50):
        exact = complex(mpmath.expjpi(2 * mpmath.mpf(turns)))
    assert abs(series[0] - exact) < 4e-16


def test_turns_and_factors_multiply():
    rng = np.random.default_rng(2)
    echo, noise, carrier = rng.standard_normal((3, 2, 50)).swapaxes(1, 2).copy().view(complex)[..., 0]
    factor, turns = rng.uniform(0, 2, (2, 50))
    turned, scaled, single = echo.copy(), echo.copy(), np.empty(50, dtype=np.complex64)
    turn(turned, turns, factor)
    np.testing.assert_allclose(turned, echo * factor * np.exp(2j * np.pi * turns), rtol=1e-13)
    scale(scaled, factor)
    np.testing.assert_array_equal(scaled, echo * factor)
    recorded(echo, factor, noise, carrier, single)
    np.testing.assert_allclose(single, (factor * echo + noise) * carrier, rtol=1e-6)


@pytest.mark.parametrize("accuracy", [1e-13, 1e-6])
def test_transforms_are_their_sums_whatever_came_before(accuracy):
    rng = np.random.default_rng(3)
    places, few = rng.uniform(-np.pi, 3 * np.pi, 300), rng.uniform(0, np.pi, 7)
    bins = np.arange(-40, 41)
    spectrum = rng.standard_normal((2, 81)) + 1j * rng.standard_normal((2, 81))
    waves = np.exp(1j * np.outer(bins, places))
    found = to_series(places, spectrum, accuracy)
    np.testing.assert_allclose(found, spectrum @ waves, atol=10 * accuracy * np.linalg.norm(spectrum))
    to_series(few, spectrum, accuracy)
    np.testing.assert_array_equal(to_series(places, spectrum, accuracy), found)
    np.testing.assert_array_equal(to_series(places, spectrum[1:], accuracy), found[1:])
    reordered = to_series(places, np.fft.ifftshift(spectrum, axes=1), accuracy, fft_order=True)
    np.testing.assert_allclose(reordered, found, atol=10 * accuracy * np.linalg.norm(spectrum))
    strengths = found.copy()
    most = 10 * accuracy * np.linalg.norm(strengths, axis=1).max()
    np.testing.assert_allclose(to_spectrum(places, strengths, 81, accuracy), strengths @ waves.conj().T, atol=most)


@settings(max_examples=60, deadline=None)
@given(st.integers(0, 2**32 - 1), st.integers(1, 60))
def test_delays_between_parts_are_straight(seed, parts):
    rng = np.random.default_rng(seed)
    times = np.arange(80) * 0.1
    sample = np.sort(rng.choice(80, parts, replace=False))
    left = rng.uniform(-0.03, 0.03, parts)
    delay = np.zeros(80)
    _spread(times, sample, left, delay)
    np.testing.assert_allclose(delay, np.interp(times, times[sample] + left, left), atol=1e-15)


def test_delays_left_are_those_of_travel_times():
    rng = np.random.default_rng(4)
    y, z = rng.uniform(20, 400, 100), rng.uniform(-1, 1, 100)
    geometry = Geometry(SONAR, 0.0)
    np.testing.assert_array_equal(geometry.left_delay(y, z), geometry.registered_delay(*travel_times(SONAR, y, z)))


@pytest.mark.parametrize("baseline", [True, False])
@pytest.mark.parametrize("odd", [0, 1])
def test_what_stands_on_the_floor_need_not_be_moved(baseline, odd):
    """At an accuracy of 1e-14 every sample is moved by its own delay, of rounding on the floor."""
    scene = Scene((60.0, 90.0), (TrawlMark(70.0, 30.0, 0.2), TrawlMark(80.0, -60.0)), sediment="coarse sand")
    made = plan(scene, SONAR, rows=6, delays="warp", baseline=baseline)
    grid = replace(made.grid, samples=made.grid.samples // 2 * 2 + odd)
    few, all_of_them = (
        simulate(
            scene, SONAR, rng=np.random.default_rng(5), rows=6, required=replace(made, accuracy=accuracy, grid=grid)
        )
        for accuracy in (2e-7, 1e-14)
    )
    np.testing.assert_array_equal(few.primary, all_of_them.primary)
    off = np.linalg.norm(few.secondary - all_of_them.secondary) / np.linalg.norm(few.secondary)
    assert off < 2e-7
