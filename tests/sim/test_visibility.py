import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sim import SONARS, Box, Geometry, Scene, Wedge
from sim.geometry import travel_times
from sim.profile import SeabedPoints
from sim.truth import truth
from sim.visibility import sees

SONAR = SONARS["hisas-100khz"]


def truth_of(scene, slant):
    return truth(scene.profile(), Geometry(SONAR, 0.0), 2 * np.asarray(slant) / SONAR.sound_speed)


@given(st.floats(1.0, 60.0), st.floats(1.0, 300.0))
def test_a_flat_floor_has_neither_shadow_nor_layover(near, width):
    scene = Scene((near, near + width), ())
    ground_range = np.linspace(near, near + width, 50)[1:-1]
    found = truth_of(scene, np.hypot(ground_range, SONAR.altitude))
    assert not found.shadow.any()
    assert not found.layover.any()
    np.testing.assert_allclose(found.delay, 0.0, atol=1e-14)
    np.testing.assert_allclose(found.height, 0.0, atol=1e-9)


def test_shadow_and_layover_of_a_box_end_where_triangles_say():
    scene = Scene((10.0, 100.0), (Box(40.0, 5.0, 2.0),))
    altitude = SONAR.altitude
    shadow_end = 45.0 * altitude / (altitude - 2.0)
    top_near, foot = np.hypot(40.0, altitude - 2.0), np.hypot(40.0, altitude)
    top_far = np.hypot(45.0, altitude - 2.0)
    # The upper receiver hears the top sooner by up to 1e-5 s, 0.75 cm of slant range.
    found = truth_of(scene, [top_near - 0.01, top_near + 0.01, foot - 0.01])
    np.testing.assert_array_equal(found.layover, [False, True, True])
    assert truth_of(scene, [foot + 0.4]).height == pytest.approx([2.0])
    middle = (top_far + np.hypot(shadow_end, altitude)) / 2
    found = truth_of(scene, [top_far - 0.01, middle, np.hypot(shadow_end, altitude) + 0.01])
    np.testing.assert_array_equal(found.shadow, [False, True, False])


def test_three_parts_are_heard_at_once_before_a_wall():
    scene = Scene((10.0, 100.0), (Box(40.0, 5.0, 2.0),))
    slant = (np.hypot(40.0, 13.0) + np.hypot(40.0, 15.0)) / 2
    branches = truth_of(scene, [slant]).branches[:, 0]
    ground_range = np.array([np.sqrt(slant**2 - 15.0**2), 40.0, np.sqrt(slant**2 - 13.0**2)])
    height = np.array([0.0, 15.0 - np.sqrt(slant**2 - 40.0**2), 2.0])
    expected = Geometry(SONAR, 0.0).registered_delay(*travel_times(SONAR, ground_range, height))
    np.testing.assert_allclose(np.sort(branches[np.isfinite(branches)]), np.sort(expected), atol=1e-14)


@st.composite
def scenes(draw):
    features, start = [], 15.0
    for _ in range(draw(st.integers(1, 4))):
        start += draw(st.floats(1.0, 20.0))
        width, height = draw(st.floats(0.5, 20.0)), draw(st.floats(0.1, 10.0))
        features.append(draw(st.sampled_from([Box, Wedge]))(start, width, height))
        start += width
    return Scene((10.0, start + 30.0), tuple(features))


@settings(max_examples=40, deadline=None)
@given(scenes(), st.integers(0, 2**32 - 1))
def test_visibility_agrees_with_marching_along_rays(scene, seed):
    rng = np.random.default_rng(seed)
    profile = scene.profile()
    corners = np.stack([profile.ground_range, profile.height], axis=1)
    points = SeabedPoints(rng.integers(0, len(corners) - 1, 40), rng.random(40))
    ground_range, height = profile.position(points)
    # The floor and everything on it as a height over ground range, walls standing at the near side of their corner.
    along = np.linspace(0.0, 1.0, 4001)[1:-1]
    ray_range = ground_range[:, None] * along
    ray_height = SONAR.altitude + (height[:, None] - SONAR.altitude) * along
    ground = np.interp(ray_range, corners[:, 0], corners[:, 1], left=0.0)
    clearance = np.where(ray_range >= corners[0, 0], ray_height - ground, np.inf).min(axis=1)
    seen = sees(profile, points, SONAR.altitude)
    step = 0.01
    assert not np.any(seen & (clearance < -step))
    facing = np.diff((corners[:, 1] - SONAR.altitude) / corners[:, 0])[points.segment] > 0
    assert not np.any(~seen & facing & (clearance > step))


@settings(max_examples=40, deadline=None)
@given(scenes(), st.integers(0, 2**32 - 1))
def test_every_visible_point_is_found_again_at_its_time(scene, seed):
    rng = np.random.default_rng(seed)
    profile = scene.profile()
    points = SeabedPoints(rng.integers(0, len(profile.along), 30), 0.001 + 0.998 * rng.random(30))
    times = travel_times(SONAR, *profile.position(points))
    order = np.argsort(times[0])
    points, times = points.chosen(order), tuple(time[order] for time in times)
    seen = sees(profile, points, SONAR.altitude) & sees(profile, points, SONAR.altitude + SONAR.baseline)
    geometry = Geometry(SONAR, 0.0)
    delays = geometry.registered_delay(*times)[seen]
    found = truth(profile, geometry, times[0])
    distance = np.abs(found.branches[:, seen] - delays)
    np.testing.assert_allclose(np.nanmin(distance, axis=0, initial=1.0), 0.0, atol=1e-12)


def test_features_that_touch_have_a_segment_of_no_length_between_them():
    touching = Scene((20.0, 60.0), (Box(33.0, 2.0, 1.0), Box(35.0, 2.0, 1.0)))
    one = Scene((20.0, 60.0), (Box(33.0, 4.0, 1.0),))
    slant = np.linspace(25.0, 60.0, 400)
    with np.errstate(all="raise"):
        found, expected = truth_of(touching, slant), truth_of(one, slant)
    np.testing.assert_array_equal(found.shadow, expected.shadow)
    np.testing.assert_array_equal(found.layover, expected.layover)
