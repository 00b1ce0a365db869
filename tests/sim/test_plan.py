"""What a plan decides, from scenes for which the answer is known; and that its shortcuts are none where it must be."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sim import SONARS, Box, PointTarget, Roughness, Scene, Slope, Step, TrawlMark, Wedge, plan, simulate
from sim.survey import survey

NEAR, FAR = SONARS["hisas-100khz"], SONARS["hisas-1032"]


def test_a_flat_floor_needs_one_section_and_no_looking_for_shadow():
    made = plan(Scene((20.0, 60.0)), NEAR)
    assert (made.sections, made.shadow, made.delays, made.level) == ("one", False, "warp", "even")


@pytest.mark.parametrize("feature", [Box(30.0, 5.0, 1.0), Step(30.0, 0.1), Step(30.0, -0.1), Wedge(30.0, 1.0, 1.6)])
def test_what_may_be_heard_at_once_gets_scatterers(feature):
    """Walls; and a slope of 1.6 / .5 = 3.2, steeper than the 2.0 m / m at which the floor comes nearer at 30 m."""
    made = plan(Scene((20.0, 60.0), (feature,)), NEAR)
    if feature == Step(30.0, -0.1):
        # It falls away: nothing is heard twice, but its foot is hidden.
        assert (made.delays, made.shadow) == ("warp", True)
    else:
        assert made.delays == "scatterers"


@pytest.mark.parametrize(("slope", "overlaid"), [(1.95, False), (1.97, True)])
def test_a_slope_is_overlaid_from_where_it_faces_the_sonar(slope, overlaid):
    """At 30 m, 15.3 m below the upper receiver: from 30 / 15.3 = 1.961 m / m on."""
    scene = Scene((20.0, 60.0), (Slope(30.0, 2.0, 2 * slope),))
    assert survey(scene, NEAR, [0.0], None).overlaid is overlaid


@pytest.mark.parametrize(("fall", "shadow"), [(0.38, False), (0.4, True)])
def test_a_slope_hides_itself_from_where_it_falls_faster_than_the_ray(fall, shadow):
    """At 40 m the ray to the foot of a slope of 5 m falls by (15 + 5 s) / 45 m / m: s = .375 at its start, 15 / 40."""
    scene = Scene((20.0, 60.0), (Slope(40.0, 5.0, -5.0 * (0.37 if not shadow else fall)),))
    assert plan(scene, NEAR).shadow is shadow


def test_a_mark_across_the_track_varies_and_one_along_it_does_not():
    along, across = (plan(Scene((60.0, 90.0), (TrawlMark(75.0, direction),)), FAR) for direction in (0.0, 40.0))
    assert (along.sections, across.sections) == ("one", "each")


def test_a_box_that_only_some_rows_meet_is_found_in_them():
    scene = Scene((20.0, 60.0), (Box(30.0, 5.0, 1.0, along_track=(2.0, 2.5)),))
    assert plan(scene, NEAR, rows=40, row_spacing=0.03).delays == "warp"
    assert plan(scene, NEAR, rows=100, row_spacing=0.03).delays == "scatterers"


def test_decorrelation_is_left_out_where_noise_outweighs_it():
    """At 60 m of slant range and 15 m of altitude df / B is 2.1e-3; noise of 10 dB loses .091, of 30 dB 1e-3."""
    scene = Scene((58.1, 90.0))
    assert not plan(scene, NEAR, snr=10.0).baseline
    assert plan(scene, NEAR, snr=30.0).baseline
    assert plan(scene, NEAR).baseline
    assert plan(scene, NEAR, snr=10.0, tolerance=1e-3).baseline


def test_every_decision_can_be_overridden_and_says_so():
    scene = Scene((20.0, 60.0), (TrawlMark(40.0, 0.0, 0.05),))
    required = plan(scene, NEAR)
    for decision in required.decisions:
        other = {
            "sections": "each", "shadow": True, "delays": "scatterers", "baseline": not required.baseline,
            "level": "even", "scatterers_per_resolution": 3.0, "accuracy": 1e-5, "single": True,
            "grid": replace(required.grid, samples=4096), "along_track": replace(required.along_track, spacing=0.02),
        }[decision.name]  # fmt: skip
        chosen = plan(scene, NEAR, **{decision.name: other})
        assert getattr(chosen, decision.name) == other
        assert {d.name: d.reason for d in chosen.decisions}[decision.name] == "as asked for"
        simulate(scene, NEAR, rng=np.random.default_rng(0), required=chosen)
    assert all(decision.reason for decision in required.decisions)
    assert str(required).count("\n") == len(required.decisions) - 1


def test_costs_grow_with_the_rows():
    scene = Scene((60.0, 200.0), (TrawlMark(100.0, 40.0),), sediment="sand")
    few, many = (
        [sum(part) for part in zip(*((d.seconds, d.bytes) for d in plan(scene, FAR, rows=rows).decisions), strict=True)]
        for rows in (10, 1000)
    )
    assert many[0] == pytest.approx(100 * few[0], rel=0.05)
    assert many[1] > 50 * few[1]


@pytest.mark.parametrize(
    ("ask", "message"),
    [
        ({"delay": "warp"}, "decision is 'delay'; it must be accuracy or .*"),
        ({"delays": "exact"}, "delays is 'exact'; it must be scatterers or warp"),
        ({"level": "loud"}, "level is 'loud'; it must be even or flat or local"),
        ({"level": "local"}, "level is 'local'; it must be even for a scene without sediment"),
        ({"scatterers_per_resolution": 0.5}, "scatterers_per_resolution is 0.5; it must be at least 1"),
        ({"accuracy": 0.1}, "accuracy is 0.1; it must lie between 1e-14 and 0.01"),
        ({"tolerance": 0}, "tolerance is 0; it must lie between 1e-06 and 0.5"),
        ({"rows": 0}, "rows is 0; it must be a whole number of at least 1"),
        ({"row_spacing": -1}, "row_spacing is -1 m; it must be above 0 m"),
    ],
)
def test_bad_input(ask, message):
    with pytest.raises(ValueError, match=f"^{message}$"):
        plan(Scene((20.0, 60.0)), NEAR, **ask)


def test_a_warp_of_a_scene_with_layover_is_refused():
    scene = Scene((20.0, 60.0), (Box(30.0, 5.0, 1.0),))
    made = plan(scene, NEAR, delays="warp")
    with pytest.raises(ValueError, match=r"^delays is 'warp'; it must be 'scatterers' for a seabed that is"):
        simulate(scene, NEAR, rng=np.random.default_rng(0), required=made)


@st.composite
def gentle_or_not(draw):
    kind = draw(st.sampled_from(["slope", "mark", "wedge", "rough"]))
    size = draw(st.floats(0.01, 3.0))
    if kind == "slope":
        return Slope(30.0, 10.0, draw(st.sampled_from([-1, 1])) * 5 * size)
    if kind == "mark":
        return TrawlMark(40.0, draw(st.floats(-89.0, 89.0)), 0.3 * size, draw(st.floats(0.5, 3.0)))
    if kind == "wedge":
        return Wedge(30.0, draw(st.floats(0.5, 10.0)), size)
    return Roughness(0.1 * size, draw(st.integers(0, 99)), period=6.4, spacing=0.2)


@settings(max_examples=60, deadline=None)
@given(gentle_or_not())
def test_a_warp_is_never_planned_where_parts_are_heard_at_once_nor_shadow_forgotten(feature):
    """Against the truth of every row, which the plan does not use."""
    scene = Scene((20.0, 60.0), (feature,))
    made = plan(scene, NEAR, rows=3, row_spacing=0.5)
    pair = simulate(scene, NEAR, rng=np.random.default_rng(1), rows=3, required=made)
    inside = pair.grid.times * 750.0
    swath = (inside > np.hypot(20.0, 15.0 - scene.heights[0])) & (
        inside < np.hypot(60.0, 15.0 - scene.heights[1]) - 0.1
    )
    if made.delays == "warp":
        assert not pair.truth.layover.any()
    if not made.shadow:
        assert not pair.truth.shadow[..., swath].any()


def test_targets_and_sonar_above_the_scene():
    with pytest.raises(ValueError, match=r"^altitude is 15 m; it must be above the highest point of the scene, 16 m$"):
        plan(Scene((20.0, 60.0), (Box(30.0, 5.0, 16.0),)), NEAR)
    assert plan(Scene((20.0, 60.0), targets=(PointTarget(30.0),)), NEAR).delays == "warp"
