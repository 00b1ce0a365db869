"""What is heard when, against array operations and against theorems."""

import numpy as np
import pytest
from heard_twin import heard_at as twin
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from sim import SONARS, Geometry, Roughness, Scene, TrawlMark, plan
from sim.geometry import travel_times
from sim.heard import heard_at
from sim.profile import Profile
from sim.survey import survey
from sim.truth import truth, truth_in_order

SONAR = SONARS["hisas-100khz"]


@st.composite
def profiles(draw):
    """Any outline below the sonar, walls and segments of no length among them."""
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    corners = draw(st.integers(2, 40))
    steps = rng.uniform(0.0, 3.0, corners) * rng.choice([0.0, 1.0], corners, p=[0.3, 0.7])
    heights = draw(st.sampled_from([0.0, 0.01, 1.0, 10.0])) * rng.uniform(-1.0, 1.0, corners)
    return Profile(draw(st.floats(0.5, 40.0)) + np.cumsum(steps), heights)


@settings(max_examples=150, deadline=None)
@given(profiles(), st.sampled_from([0.0, 0.3, 2.0]), st.booleans())
def test_the_compiled_march_finds_what_array_operations_find(profile, above, shadow):
    times = np.linspace(0.0, 2 * 150.0 / SONAR.sound_speed, 700)
    found = heard_at(profile, SONAR, times, SONAR.altitude + above, shadow=shadow)
    expected = twin(profile, SONAR, times, SONAR.altitude + above, shadow=shadow)
    np.testing.assert_array_equal(found.points.segment, expected.points.segment)
    np.testing.assert_array_equal(found.sample, expected.sample)
    np.testing.assert_array_equal(found.stretch, expected.stretch)
    np.testing.assert_allclose(found.points.share, expected.points.share, atol=1e-9)


@settings(max_examples=100, deadline=None)
@given(profiles(), st.sampled_from([0.0, 0.3, 2.0]))
def test_what_is_heard_has_that_travel_time(profile, above):
    times = np.linspace(0.0, 2 * 150.0 / SONAR.sound_speed, 700)
    heard = heard_at(profile, SONAR, times, SONAR.altitude + above, shadow=False)
    y, z = profile.position(heard.points)
    path = np.hypot(y, z - SONAR.altitude) + np.hypot(y, z - SONAR.altitude - above)
    # A share of a segment is exact to some 1e-9 where the path is level along it, and the path to far better.
    np.testing.assert_allclose(path, SONAR.sound_speed * times[heard.sample], atol=1e-9)


@settings(max_examples=60, deadline=None)
@given(profiles())
def test_without_hiding_an_outline_is_heard_an_odd_number_of_times(profile):
    """From its near to its far end the path starts and ends on one side each of any time between theirs."""
    start, end = (2 * np.hypot(profile.ground_range[i], 15.0 - profile.height[i]) / SONAR.sound_speed for i in (0, -1))
    times = np.linspace(0.0, 0.2, 1500)
    heard = heard_at(profile, SONAR, times, SONAR.altitude, shadow=False)
    between = (times > min(start, end) + 1e-9) & (times < max(start, end) - 1e-9)
    parts = np.bincount(heard.sample, minlength=len(times))
    assert (parts[between] % 2 == 1).all()
    assert (parts[~between & (np.abs(times - start) > 1e-9) & (np.abs(times - end) > 1e-9)] % 2 == 0).all()


def test_branches_of_a_rough_seabed_take_few_rows_and_hold_every_part():
    scene = Scene((5.0, 60.0), (Roughness(0.5, 7, exponent=2.2, period=25.6, spacing=0.2), TrawlMark(40.0, 20.0)))
    times = np.linspace(0.005, 0.1, 3000)
    profile = scene.profile(3.0)
    found = truth(profile, Geometry(SONAR, 0.0), times)
    assert found.layover.any()
    assert found.shadow.any()
    heard = twin(profile, SONAR, times, SONAR.altitude)
    delays = Geometry(SONAR, 0.0).registered_delay(*travel_times(SONAR, *profile.position(heard.points)))
    parts = np.bincount(heard.sample, minlength=len(times))
    assert len(found.branches) <= parts.max() + 2
    for sample in np.flatnonzero(parts > 2)[::7]:
        held = found.branches[:, sample]
        # All that the primary hears and the secondary sees.
        assert np.isin(np.round(held[np.isfinite(held)] * 1e12), np.round(delays[heard.sample == sample] * 1e12)).all()
    assert np.isfinite(found.branches).sum() == pytest.approx(len(delays), rel=0.02)


@settings(max_examples=40, deadline=None)
@given(st.floats(-80.0, 80.0), st.floats(0.01, 0.3), st.floats(-20.0, 20.0))
def test_the_truth_of_a_gentle_section_is_that_of_any(direction, depth, along_track):
    scene = Scene((20.0, 60.0), (TrawlMark(40.0, direction, depth), Roughness(0.003, 3, period=12.8, spacing=0.4)))
    profile, geometry = scene.profile(along_track), Geometry(SONAR, 0.0)
    times = np.linspace(0.02, 0.1, 1700)
    assume(not plan(scene, SONAR, rows=1).shadow and not survey(scene, SONAR, [along_track], None).shadow)
    found = truth_in_order(profile, geometry, times, heard_at(profile, SONAR, times, SONAR.altitude, shadow=False))
    expected = truth(profile, geometry, times)
    for name in ("delay", "height", "shadow", "layover", "branches"):
        np.testing.assert_array_equal(getattr(found, name), getattr(expected, name), err_msg=name)
