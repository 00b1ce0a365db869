"""A search range in height."""

import numpy as np
import pytest

from estimators import CrossCorrelation, FixedWindow, FullBandPhaseSlope, Height, MaximumLikelihood
from sim import SONARS, Box, Scene, simulate

SONAR = SONARS["hisas-100khz"]
METHODS = [CrossCorrelation, MaximumLikelihood, FullBandPhaseSlope]


@pytest.fixture(scope="module")
def pair():
    scene = Scene((20.0, 40.0), (Box(28, 4, 4),))
    return simulate(scene, SONAR, rng=np.random.default_rng(1), snr=20.0, rows=1)


@pytest.mark.parametrize("metres", [0.5, 2.0, 4.0])
def test_it_is_the_delay_of_that_height_where_it_is_largest(pair, metres):
    limit = Height(metres).delay(pair)
    # Back to heights by the geometry, which another formula gives: one of them is reached and none exceeded.
    times = pair.grid.times
    heights = np.array([pair.geometry.height(times, sign * limit) for sign in (1, -1)])
    assert np.abs(heights).min() == pytest.approx(metres, rel=1e-9)
    # And about -z D / (r c) at the nearest range of the record, to the first order of D / H.
    first_order = metres * SONAR.baseline / (times[0] * SONAR.sound_speed / 2 * SONAR.sound_speed)
    assert limit == pytest.approx(first_order, rel=0.03)


@pytest.mark.parametrize("method", METHODS)
def test_every_method_searches_as_far_as_the_height_asks(pair, method):
    window = FixedWindow(1, 33)
    by_height = method(window, search=Height(0.5)).estimate(pair)
    by_delay = method(window, search=Height(0.5).delay(pair)).estimate(pair)
    np.testing.assert_array_equal(by_height.delay, by_delay.delay)
    # The box of 4 m lies two wraps beyond a search of half a metre, and within one of 5 m.
    on_the_box = np.isclose(pair.truth.height, 4.0) & np.isfinite(pair.truth.delay)
    assert on_the_box.sum() > 30
    wide = method(window, search=Height(5.0)).estimate(pair)
    found = [np.mean(np.abs(e.delay - pair.truth.delay)[:, on_the_box] < 5e-6) for e in (by_height, wide)]
    assert found[0] == 0
    assert found[1] > 0.7


@pytest.mark.parametrize(
    ("metres", "message"),
    [
        (0.0, "height of the search is 0 m; it must be above 0 m"),
        (15.0, "search is 15 m of height; it must be below the altitude, 15 m"),
    ],
)
def test_heights_that_cannot_be(pair, metres, message):
    with pytest.raises(ValueError, match=f"^{message}$"):
        CrossCorrelation(FixedWindow(1, 9), search=Height(metres)).estimate(pair)


def test_a_pair_without_geometry_has_no_heights(make_patch):
    with pytest.raises(ValueError, match=r"^search is 1 m of height; the pair must have a geometry, or .*$"):
        CrossCorrelation(FixedWindow(1, 9), search=Height(1.0)).estimate(make_patch())
