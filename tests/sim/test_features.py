"""Shapes of a seabed against their formulas, and sections of scenes that they add up to."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sim import Box, HeightMap, Roughness, Scene, Slope, Step, TrawlMark, Wedge

NEAR, FAR = 20.0, 80.0


def height_of(features, along_track, ground_range):
    profile = Scene((NEAR, FAR), features).profile(along_track)
    return np.interp(ground_range, profile.ground_range, profile.height)


def test_heights_of_features_add_up():
    """A box and a furrow on a slope that starts before and ends behind them, with a step in between; by hand."""
    features = (
        Slope(30.0, 20.0, 4.0),
        Box(35.0, 5.0, 1.0),
        Step(45.0, -0.5),
        Wedge(60.0, 4.0, 2.0),
    )
    ground_range = np.array([25.0, 34.0, 36.0, 39.0, 42.0, 46.0, 55.0, 61.0, 62.0, 70.0])
    expected = [0.0, 0.8, 2.2, 2.8, 2.4, 2.7, 3.5, 4.5, 5.5, 3.5]
    np.testing.assert_allclose(height_of(features, 0.0, ground_range), expected, atol=1e-12)


def test_a_wall_has_two_corners_and_keeps_the_height_on_either_side():
    profile = Scene((NEAR, FAR), (Slope(30.0, 10.0, 1.0), Box(35.0, 2.0, 3.0), Box(37.0, 2.0, 1.0))).profile()
    for wall, near, far in ((35.0, 0.5, 3.5), (37.0, 3.7, 1.7), (39.0, 1.9, 0.9)):
        np.testing.assert_allclose(profile.height[profile.ground_range == wall], [near, far], atol=1e-12)


def test_features_with_ends_along_track_are_there_only():
    box = Box(35.0, 5.0, 1.0, along_track=(2.0, 4.0))
    found = [height_of((box,), x, np.array([37.0]))[0] for x in (1.99, 2.0, 3.99, 4.0)]
    np.testing.assert_array_equal(found, [0.0, 1.0, 1.0, 0.0])


@settings(max_examples=60, deadline=None)
@given(st.floats(-90.0, 90.0), st.floats(0.5, 4.0), st.floats(0.01, 0.5), st.floats(-30.0, 30.0), st.floats(NEAR, FAR))
def test_a_furrow_is_a_raised_cosine_across_its_axis(direction, width, depth, along_track, ground_range):
    mark = TrawlMark(50.0, direction, depth, width)
    angle = np.radians(direction)
    across = (ground_range - 50.0) * np.cos(angle) - along_track * np.sin(angle)
    expected = -depth / 2 * (1 + np.cos(2 * np.pi * across / width)) if abs(across) < width / 2 else 0.0
    found = height_of((mark,), along_track, np.array([ground_range]))[0]
    # Sixteen straight pieces are off by 1 - cos(pi / 16) of half the depth at the most.
    assert found == pytest.approx(expected, abs=0.0097 * depth + 1e-9)


def test_a_height_map_is_bilinear_and_level_beyond_its_edges(tmp_path):
    rng = np.random.default_rng(1)
    given_map = HeightMap(rng.standard_normal((4, 6)), start=(10.0, 30.0), spacing=(2.0, 5.0))
    np.savez(tmp_path / "map.npz", nodes=given_map.nodes, start=given_map.start, spacing=given_map.spacing)
    read = HeightMap.read(tmp_path / "map.npz")
    for along_track in (5.0, 10.0, 11.5, 14.0, 15.9, 30.0):
        x = np.clip((along_track - 10.0) / 2.0, 0, 3)
        row = [np.interp(x, np.arange(4), column) for column in given_map.nodes.T]
        ground_range = np.linspace(21.0, 79.0, 117)
        expected = np.interp(ground_range, 30.0 + 5.0 * np.arange(6), row)
        for one in (given_map, read):
            np.testing.assert_allclose(height_of((one,), along_track, ground_range), expected, atol=1e-12)


def test_a_pickled_height_map_is_not_read(tmp_path):
    np.savez(tmp_path / "map.npz", nodes=np.array([{}], dtype=object), start=[0, 0], spacing=[1, 1])
    with pytest.raises(ValueError, match=r"holds no height map \(.*\); it must be .npz with nodes, start and spacing$"):
        HeightMap.read(tmp_path / "map.npz")


def test_roughness_has_its_rms_exponent_and_seed():
    """Power of annuli of wavenumber over 512 by 512 nodes; a mean of n exponential powers, 5 standard errors."""
    rough = Roughness(0.05, 3, exponent=3.4, period=51.2, spacing=0.1)
    assert rough.tile.std() == pytest.approx(0.05, rel=1e-12)
    assert rough.tile.mean() == pytest.approx(0.0, abs=1e-12)
    np.testing.assert_array_equal(rough.tile, Roughness(0.05, 3, exponent=3.4, period=51.2, spacing=0.1).tile)
    assert not np.array_equal(rough.tile, Roughness(0.05, 4, exponent=3.4, period=51.2, spacing=0.1).tile)
    power = np.abs(np.fft.fft2(rough.tile)) ** 2
    wavenumber = np.hypot(*np.meshgrid(*[np.fft.fftfreq(512)] * 2, indexing="ij"))
    flattened = power * np.where(wavenumber > 0, wavenumber, np.nan) ** 3.4
    bands = [flattened[(wavenumber > low) & (wavenumber <= 2 * low)] for low in (0.01, 0.05, 0.2)]
    means = [band.mean() for band in bands]
    for band, mean in zip(bands, means, strict=True):
        # Real heights: half of the powers are copies.
        assert mean == pytest.approx(means[-1], rel=5 * np.sqrt(2 / len(band) + 2 / len(bands[-1])))


def test_roughness_repeats_and_is_straight_between_nodes():
    rough = Roughness(0.05, 3, period=12.8, spacing=0.2)
    ground_range = np.linspace(21.0, 40.0, 191)
    np.testing.assert_allclose(
        height_of((rough,), 3.3, ground_range), height_of((rough,), 3.3 - 12.8, ground_range + 12.8), atol=1e-12
    )
    rows = [height_of((rough,), x, ground_range) for x in (3.2, 3.3, 3.4)]
    np.testing.assert_allclose(rows[1], (rows[0] + rows[2]) / 2, atol=1e-12)
    column = round(30.0 / 0.2) % 64
    assert height_of((rough,), 3.2, np.array([30.0]))[0] == pytest.approx(rough.tile[16, column], abs=1e-12)


@pytest.mark.parametrize(
    ("features", "uniform"),
    [
        ((), True),
        ((Box(30, 2, 1), Slope(40, 5, 1), Step(50, 1), TrawlMark(60.0)), True),
        ((Box(30, 2, 1, (0, 5)),), False),
        ((TrawlMark(60.0, 10.0),), False),
        ((Roughness(0.01, 1, period=12.8),), False),
        ((HeightMap(np.zeros((2, 2)), (0, 30), (1, 10)),), True),
        ((HeightMap(np.eye(2), (0, 30), (1, 10)),), False),
    ],
)
def test_what_is_uniform_along_track(features, uniform):
    scene = Scene((NEAR, FAR), features)
    assert scene.uniform is uniform
    if uniform:
        np.testing.assert_array_equal(scene.profile(0.0).height, scene.profile(7.3).height)


def test_heights_bound_every_section():
    scene = Scene((NEAR, FAR), (Roughness(0.1, 5, period=12.8), TrawlMark(50.0, 30.0, 0.4), Box(30, 2, 1, (3, 9))))
    low, high = scene.heights
    for along_track in np.linspace(-20.0, 20.0, 41):
        height = scene.profile(along_track).height
        assert low <= height.min()
        assert height.max() <= high


def test_whole_numbers_are_as_good_as_others():
    whole = Scene((20, 80), (Box(30, 5, 2), Slope(40, 10, 1), Step(60, 1)))
    real = Scene((20.0, 80.0), (Box(30.0, 5.0, 2.0), Slope(40.0, 10.0, 1.0), Step(60.0, 1.0)))
    for part in ("ground_range", "height"):
        found = getattr(whole.profile(), part)
        assert found.dtype == np.float64
        np.testing.assert_array_equal(found, getattr(real.profile(), part))


def test_boxes_that_never_meet_do_not_add_up_in_the_bounds():
    scene = Scene((NEAR, FAR), (Box(35, 2, 8, (0, 1)), Box(45, 2, 7, (2, 3)), Step(40.0, -0.5), TrawlMark(60.0, 30.0)))
    assert scene.heights == pytest.approx((-0.65, 8.0))
