import numpy as np
import pytest

from sim import (
    Box,
    EchoPair,
    HeightMap,
    PointTarget,
    Roughness,
    Scene,
    SedimentPatch,
    Slope,
    Sonar,
    TrawlMark,
)

GOOD_SONAR = {"centre_frequency": 100e3, "bandwidth": 30e3, "baseline": 0.3, "altitude": 15.0}


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"bandwidth": -1.0}, "bandwidth is -1 Hz; it must be above 0 Hz"),
        ({"bandwidth": 2e5}, "bandwidth is 200000 Hz; it must be below twice the centre frequency, 200000 Hz"),
        ({"baseline": 0.0}, "baseline is 0 m; it must be above 0 m"),
        ({"altitude": float("inf")}, "altitude is inf; it must be finite"),
        ({"sound_speed": "fast"}, "sound_speed is 'fast'; it must be a number in m/s"),
    ],
)
def test_sonar(change, message):
    with pytest.raises(ValueError, match=f"^{message}$"):
        Sonar(**{**GOOD_SONAR, **change})


@pytest.mark.parametrize(
    ("build", "message"),
    [
        (lambda: Box(30.0, 0.0, 1.0), "width is 0 m; it must be above 0 m"),
        (lambda: Scene((50.0, 20.0)), r"ground_range is \(50, 20\) m; its near end must come before its far end"),
        (lambda: Scene((20.0, 50.0), (Box(10.0, 5.0, 1.0),)), ".* leaves the scene; it must stand between 20 and 50 m"),
        (lambda: Box(30.0, 1.0, 1.0, (2.0, 2.0)), r"along_track is \(2, 2\) m; it must begin before it ends"),
        (lambda: Slope(30.0, 10.0, np.nan), "rise is nan; it must be finite"),
        (lambda: TrawlMark(30.0, 91.0), "direction is 91 degrees; it must lie between -90 and 90 degrees"),
        (lambda: Roughness(0.1, -1), "seed is -1; it must be a whole number of at least 0"),
        (lambda: Roughness(0.1, 1, period=1.05), r"period / spacing is 10\.5; it must be a whole number .*"),
        (lambda: HeightMap(np.zeros(3), (0, 0), (1, 1)), r"nodes have the shape \(3,\); it must be .*"),
        (lambda: HeightMap(np.full((2, 2), np.nan), (0, 0), (1, 1)), "nodes has 4 samples that are not finite, .*"),
        (lambda: HeightMap.read("missing.npz"), "missing.npz holds no height map .*"),
        (lambda: Scene((20.0, 50.0), speckle_shape=0.0), "speckle_shape is 0; it must be above 0"),
        (lambda: Scene((20.0, 50.0), speckle_shape="x"), "speckle_shape is 'x'; it must be a number"),
        (lambda: Scene((30.0,)), r"ground_range is \(30.0,\); it must be two numbers in m"),
        (lambda: Scene(30.0), "ground_range is 30.0; it must be two numbers in m"),
        (lambda: Box(30.0, 1.0, 1.0, (0, 1, 2)), r"along_track is \(0, 1, 2\); it must be two numbers in m"),
        (lambda: Box(30.0, 1.0, 1.0, (0, "x")), r"along_track is \(0, 'x'\); it must be two numbers in m"),
        (lambda: SedimentPatch((30.0,), "rock"), r"ground_range is \(30.0,\); it must be two numbers in m"),
        (lambda: SedimentPatch((30.0, 40.0), "rock", 3), "along_track is 3; it must be two numbers in m"),
        (
            lambda: Scene((20.0, 50.0), sediment="sand", patches=(SedimentPatch((50.0, 60.0), "rock"),)),
            "a patch from 50 to 60 m leaves the scene; it must lie between 20 and 50 m",
        ),
        (
            lambda: Scene((20.0, 50.0), patches=(SedimentPatch((30.0, 40.0), "rock"),)),
            "a scene without sediment has patches; it must have a sediment around them",
        ),
        (lambda: Scene((20.0, 50.0), targets=(PointTarget(60.0),)), ".* leaves the scene; it must lie between .*"),
    ],
)
def test_scene(build, message):
    with pytest.raises(ValueError, match=f"^{message}$"):
        build()


GOOD_PAIR = {
    "primary": np.ones((2, 8), complex),
    "secondary": np.ones((2, 8), complex),
    "sample_rate": 40e3,
    "centre_frequency": 100e3,
    "bandwidth": 30e3,
}


def with_nan():
    series = np.ones((2, 8), complex)
    series[1, 3] = np.nan
    series[1, 5] = np.inf
    return series


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (
            {"primary": with_nan()},
            r"primary has 2 samples that are not finite, the first at \(1, 3\); all must be finite",
        ),
        ({"secondary": np.ones((2, 9), complex)}, r"primary has the shape \(2, 8\) and secondary \(2, 9\); .* equal"),
        ({"secondary": np.ones((2, 8))}, "secondary is of type float64; it must be complex"),
        ({"bandwidth": 0.0}, "bandwidth is 0 Hz; it must be above 0 Hz"),
        ({"sample_rate": 20e3}, "bandwidth is 30000 Hz; it must not exceed the sample rate, 20000 Hz"),
        ({"centre_frequency": 15e3}, "bandwidth is 30000 Hz; it must be below twice the centre frequency, 30000 Hz"),
    ],
)
def test_echo_pair(change, message):
    with pytest.raises(ValueError, match=f"^{message}$"):
        EchoPair(**{**GOOD_PAIR, **change})


def test_samples_that_are_not_finite_are_gaps_where_asked():
    series = np.ones((2, 8), np.complex64)
    pair = EchoPair.with_gaps(with_nan().astype(np.complex64), series, 40e3, 100e3, 30e3)
    expected = np.zeros((2, 8), dtype=bool)
    expected[1, [3, 5]] = True
    np.testing.assert_array_equal(pair.missing, expected)
    for found in (pair.primary, pair.secondary):
        np.testing.assert_array_equal(found, np.where(expected, 0, series))
        assert found.dtype == np.complex64
    assert EchoPair.with_gaps(series, series, 40e3, 100e3, 30e3).missing is None
    with pytest.raises(ValueError, match="they must be equal"):
        EchoPair.with_gaps(series, np.ones((2, 9), complex), 40e3, 100e3, 30e3)
