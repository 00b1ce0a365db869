"""Depth maps: places, spreads, resolution, and which depths are kept."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from estimators import (
    AdaptiveWindow,
    CrossCorrelation,
    DelayEstimate,
    FixedWindow,
    KnownCoherence,
    Pixels,
    Thresholds,
    VaryingWindow,
    bounds,
    coverage,
    depth_map,
    valid_range,
)
from sim import SONARS, Box, EchoPair, Geometry, Scene, simulate
from sim.geometry import ground_length, travel_times

SONAR = SONARS["hisas-1032"]
FC, C, D, H = 122e3, 1480.0, 0.3, 42.0
RATE = 40e3


def silence(ground_range, shape=(3, 64)):
    nothing = np.zeros(shape, dtype=complex)
    geometry = Geometry(SONAR, 2 * np.hypot(ground_range, H) / C)
    return EchoPair(nothing, nothing, RATE, FC, 30e3, geometry=geometry)


def estimate_of(delay, delay_std=1e-8, coherence=0.9, wraps=1e-3, valid=True):
    delay, *others = (np.array(a) for a in np.broadcast_arrays(delay, delay_std, coherence, wraps, valid))
    std, gamma, wrong, keeps = others
    return DelayEstimate(delay, 0 * delay, gamma, gamma, std, wrong, gamma, keeps.astype(bool))


@given(st.floats(45.0, 400.0), st.floats(-3.0, 3.0))
def test_a_point_is_placed_where_it_stands(ground, height):
    heard, heard_above = travel_times(SONAR, ground, height)
    pair = silence(50.0, (1, 2))
    pair = replace(pair, geometry=Geometry(SONAR, float(heard)))
    delay = pair.geometry.registered_delay(heard, heard_above)
    found = depth_map(pair, estimate_of(np.full((1, 2), delay)), FixedWindow(1, 1))
    assert found.height[0, 0] == pytest.approx(height, abs=1e-7)
    assert found.ground_range[0, 0] == pytest.approx(ground, abs=1e-7)
    assert found.valid.all()


def test_an_echo_too_early_for_its_height_is_not_valid():
    pair = replace(silence(0.0), geometry=Geometry(SONAR, 2 * 40.0 / C))
    found = depth_map(pair, estimate_of(np.zeros(pair.shape)), FixedWindow(1, 1))
    # At 40 m of slant range nothing can be on the plane, 42 m below.
    assert not found.valid[:, 0].any()
    assert np.isnan(found.plane_range[0])


@given(st.floats(50.0, 400.0), st.floats(0.01, 0.99), st.floats(2.0, 500.0))
def test_the_spread_is_equation_3(ground, coherence, looks):
    pair = silence(ground)
    std = float(bounds.phase_crlb(looks, coherence)) / (2 * np.pi * FC)
    found = depth_map(pair, estimate_of(np.zeros(pair.shape), std), FixedWindow(1, 1))
    slant = C / 2 * pair.grid.times
    # To first order in D / r, and in the delay's change over range, D H / (2 r^2).
    crlb = bounds.depth_crlb(looks, coherence, FC, slant, D, C)
    np.testing.assert_allclose(found.height_std[0], crlb, rtol=2 * D / slant[0] + D * H / slant[0] ** 2)
    np.testing.assert_allclose(found.wrap_height, slant * C / FC / D)


def test_resolution_is_the_window_on_the_ground():
    pair = silence(100.0)
    rows, samples = np.where(np.arange(64) < 32, 3, 5), np.where(np.arange(64) < 32, 5, 9)
    found = depth_map(pair, estimate_of(np.zeros(pair.shape)), VaryingWindow(rows, samples))
    slant = C / 2 * pair.grid.times
    dy = C / (2 * RATE) * slant / np.sqrt(slant**2 - H**2)
    np.testing.assert_allclose(found.resolution_along_track, rows * SONAR.aperture.resolution)
    np.testing.assert_allclose(found.resolution_range, samples * dy, rtol=1e-6)
    by_user = depth_map(pair, estimate_of(np.zeros(pair.shape)), FixedWindow(3, 9), pixels=Pixels(0.02, 0.02, 0.4))
    np.testing.assert_allclose(by_user.resolution_range, 0.18)
    np.testing.assert_allclose(by_user.cell, 4e-4)


@given(st.floats(42.1, 1e4), st.floats(1e-3, 0.1))
def test_ground_length_is_the_difference_of_ground_ranges(slant, extent):
    ends = np.maximum(slant + np.array([-0.5, 0.5]) * extent, H)
    expected = np.diff(np.sqrt(ends**2 - H**2)).item()
    # The plain difference loses digits at long range.
    assert float(ground_length(H, slant, extent)) == pytest.approx(expected, abs=1e-11 * slant, rel=1e-6)
    assert float(ground_length(H, 41.0, 0.1)) == 0.0


def test_a_box_has_its_height_and_its_predicted_spread():
    scene = Scene((100.0, 106.0), (Box(102.0, 2.0, 0.3),))
    pair = simulate(scene, SONAR, rng=np.random.default_rng(5), snr=10.0, rows=90)
    window = AdaptiveWindow(1.0, coherence=KnownCoherence(10 / 11), smallest=5)
    found = depth_map(pair, CrossCorrelation(window).estimate(pair), window)
    # Well inside the box and the floor behind its shadow.
    for ground, height in ((103.4, 0.3), (105.2, 0.0)):
        at = np.argmin(np.abs(found.plane_range - (ground - height * H / ground)))
        rows = slice(window.on(pair).rows[at] // 2, None, window.on(pair).rows[at])
        inside, std = found.height[rows, at], found.height_std[rows, at]
        # Independent rows; 4.9 standard errors are passed once in 1e6.
        n = inside.size
        assert inside.mean() == pytest.approx(height, abs=4.9 * inside.std(ddof=1) / np.sqrt(n) + 0.005)
        assert found.valid[rows, at].all()
        # The spread that is predicted is a bound, which so few looks miss by some per cent.
        ratio = inside.std(ddof=1) / np.sqrt(np.mean(std**2))
        assert ratio == pytest.approx(1.0, abs=4.9 / np.sqrt(2 * (n - 1)) + 0.1)


def along(stds, *, valid=True, wraps=0.0, coherence=1.0, ground=100.0):
    """Depths whose spread at each time is given."""
    stds = np.broadcast_to(np.asarray(stds, dtype=float), (3, np.size(stds)))
    pair = silence(ground, stds.shape)
    found = depth_map(pair, estimate_of(np.zeros(stds.shape), 1e-9, coherence, wraps, valid), FixedWindow(1, 1))
    return replace(found, height_std=stds)


def test_thresholds_keep_what_is_within_all_of_them():
    depths = along([0.1, 0.2, 0.3, 0.4], coherence=[0.9, 0.9, 0.4, 0.9], wraps=[0.2, 0.0, 0.0, 0.0])
    everything = Thresholds().mask(depths)
    assert everything.all()
    np.testing.assert_array_equal(Thresholds(height_std=0.3).mask(depths)[0], [1, 1, 1, 0])
    np.testing.assert_array_equal(Thresholds(coherence=0.5).mask(depths)[0], [1, 1, 0, 1])
    np.testing.assert_array_equal(Thresholds(wrap_error_probability=0.1).mask(depths)[0], [0, 1, 1, 1])
    both = Thresholds(height_std=0.3, coherence=0.5).mask(depths)
    np.testing.assert_array_equal(both[0], [1, 1, 0, 0])
    assert not Thresholds().mask(along([0.1, 0.2], valid=False)).any()


def test_valid_range_ends_before_the_first_piece_that_is_worse():
    # 20 cm of ground at each time, so that a piece of 1 m has five; better again beyond does not count.
    n = 200
    depths = along(np.full(n, 0.1))
    ground = 100.0 + 0.2 * np.arange(n)
    std = np.select([ground < 103.0, ground < 120.0, ground < 125.0], [9.0, 0.1, 0.9], 0.1)
    depths = replace(depths, plane_range=ground, height_std=np.broadcast_to(std, (3, n)).copy())
    assert valid_range(depths, 0.5) == pytest.approx(119.8)
    assert valid_range(depths, 1.0) == pytest.approx(139.8)
    assert valid_range(depths, 0.05) == 0.0
    # One row of three, and one time of five, do not move a median.
    depths.height_std[0] = 9.0
    depths.height_std[:, 52] = 9.0
    assert valid_range(depths, 0.5) == pytest.approx(119.8)
    # A piece without a valid depth is passed over.
    hole = (ground > 110.0) & (ground < 112.0)
    assert valid_range(replace(depths, valid=depths.valid & ~hole), 0.5) == pytest.approx(119.8)
    assert valid_range(replace(depths, valid=depths.valid & False), 0.5) == 0.0


def test_coverage_is_the_share_of_the_ground():
    depths = along([0.1, 0.2, 0.3, 0.4])
    depths = replace(depths, cell=np.array([1.0, 2.0, 3.0, 4.0]))
    found = coverage(depths, Thresholds(height_std=0.25))
    assert found.area == pytest.approx(3 * 3.0)
    assert found.share == pytest.approx(0.3)
    # What cannot be on the plane is not ground.
    early = replace(depths, plane_range=np.array([np.nan, 1.0, 2.0, 3.0]))
    assert coverage(early, Thresholds(height_std=0.25)).share == pytest.approx(2 / 9)


def test_paper_bs_windows_cover_more_than_the_fixed_one():
    # Coherence on a straight line through the two that paper B implies, .459 at 320 m and .187 at 400 m: the adaptive
    # window of kappa 2 stays within 50 cm to the end, the fixed one of 9 x 9 pixels to 320 m (predicted spreads).
    ground = np.linspace(300.0, 400.0, 4001)
    gamma = np.interp(ground, [300.0, 320.0, 400.0], [0.527, 0.459, 0.187])
    slant = np.hypot(ground, H)
    pixels = Pixels(0.02, 0.02, 0.4)
    pair = silence(300.0, (101, 5600))
    adaptive = AdaptiveWindow(2.0, coherence=KnownCoherence(gamma, ground), pixels=pixels, largest=101).on(pair)
    at = np.sqrt((C / 2 * pair.grid.times) ** 2 - H**2)
    side = np.interp(ground, at, adaptive.rows)
    for pixels_on_a_side, reach in ((9.0, 320.0), (side, 400.0)):
        std = bounds.depth_crlb(0.4 * np.square(pixels_on_a_side), gamma, FC, slant, D, C)
        depths = along(std, ground=300.0)
        assert valid_range(replace(depths, plane_range=ground), 0.5) == pytest.approx(reach, abs=2.0)


@pytest.mark.parametrize(
    ("build", "message"),
    [
        (lambda: Thresholds(height_std=0.0), "height_std is 0 m; it must be above 0 m"),
        (lambda: Thresholds(height_std=float("nan")), "height_std is nan m; it must be above 0 m"),
        (lambda: Thresholds(coherence=1.5), "coherence is 1.5; it must lie between 0 and 1"),
        (
            lambda: depth_map(replace(silence(50.0), geometry=None), None, FixedWindow(1, 1)),
            "the pair has no geometry; it must have one to place its delays",
        ),
    ],
)
def test_what_cannot_be(build, message):
    with pytest.raises(ValueError, match=f"^{message}$"):
        build()
