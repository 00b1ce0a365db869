"""Window policies: paper B's equations and numbers, sizes, and a window that is safe of wraps."""

import re
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from paper_b import FC, GEOMETRY, SONAR, B, C, D, H, pair_at, patch

from estimators import (
    AdaptiveWindow,
    ConstantStdWindow,
    CrossCorrelation,
    FixedWindow,
    Interferogram,
    KnownCoherence,
    MaximumLikelihood,
    MeasuredCoherence,
    ModelledCoherence,
    Pixels,
    TwoWindow,
    WrapSafeWindow,
    bounds,
)
from estimators.conformance import findings
from estimators.pixels import PAPER_B, nearest_odd
from estimators.ranges import Ranges
from estimators.window_sizes import least_coherence, side_of_constant_ratio, side_of_constant_std
from sim import SONARS, Geometry

COHERENCE = st.one_of(st.floats(1e-3, 1 - 1e-9), st.sampled_from([1e-3, 1 - 1e-9]))
SLANT = st.floats(42.5, 450.0)
PIXELS = st.builds(Pixels, st.floats(0.005, 0.1), st.floats(0.005, 0.1), st.floats(0.05, 1.0))


def ranges_of(slant, coherence):
    return Ranges(np.array([slant]), np.array([coherence]), FC, B, D, C)


def std_of(slant, coherence, looks):
    """Paper B, equation 3, as printed."""
    rho = coherence / (1 - coherence)
    return slant * C / D / (2 * np.pi * FC) / np.sqrt(looks) * np.sqrt(1 / rho + 1 / (2 * rho**2))


@given(SLANT, COHERENCE, st.floats(0.5, 4.0), PIXELS)
def test_equation_7_makes_the_side_kappa_times_the_spread(slant, coherence, kappa, pixels):
    one = ranges_of(slant, coherence).depth_crlb(1.0)
    (side,) = side_of_constant_ratio(one, kappa, pixels)
    looks = pixels.looks * side * (side * pixels.along_track / pixels.range)
    assert side * pixels.along_track == pytest.approx(kappa * std_of(slant, coherence, looks), rel=1e-12)
    # Square pixels, as printed.
    square = Pixels(pixels.range, pixels.range, pixels.looks)
    rho = coherence / (1 - coherence)
    of_snr = np.sqrt(1 / rho + 1 / (2 * rho**2))
    printed = kappa * np.sqrt(square.looks) / square.range * slant * C / D / (2 * np.pi * FC) * of_snr
    assert square.looks * side_of_constant_ratio(one, kappa, square) ** 2 == pytest.approx(printed, rel=1e-12)


@given(SLANT, COHERENCE, st.floats(1e-3, 10.0), PIXELS)
def test_equation_5_makes_the_spread_what_was_asked_for(slant, coherence, std, pixels):
    one = ranges_of(slant, coherence).depth_crlb(1.0)
    (side,) = side_of_constant_std(one, std, pixels)
    looks = pixels.looks * side * (side * pixels.along_track / pixels.range)
    assert std_of(slant, coherence, looks) == pytest.approx(std, rel=1e-12)


def policies(**options):
    return [
        ConstantStdWindow(0.3, **options),
        AdaptiveWindow(2.0, **options),
        WrapSafeWindow(1.0, 1e-2, predict=bounds.wrap_error_probability, **options),
    ]


@settings(max_examples=25, deadline=None)
@given(
    coherence=st.one_of(COHERENCE, st.sampled_from([0.0, 1.0])),
    ground=st.floats(0.0, 450.0),
    shape=st.tuples(st.integers(1, 40), st.integers(1, 40)),
    limits=st.tuples(st.integers(0, 5), st.integers(0, 20)),
    pixels=st.one_of(st.none(), PIXELS),
)
def test_sizes_are_odd_within_their_limits_and_the_record(coherence, ground, shape, limits, pixels):
    smallest, largest = 2 * limits[0] + 1, 2 * sum(limits) + 1
    pair = pair_at(ground, shape)
    options = {"smallest": smallest, "largest": largest, "pixels": pixels, "coherence": KnownCoherence(coherence)}
    for policy in policies(**options):
        window = policy.on(pair)
        window.check(pair)
        assert window.rows.shape == window.samples.shape == shape[1:]
        assert (window.rows % 2 == 1).all()
        assert (window.samples % 2 == 1).all()
        assert window.rows.max() <= largest
        assert window.rows.min() >= min(smallest, shape[0] - 1 + shape[0] % 2)
        # A square within a sample, where the record lets it.
        view = policy.view(pair)
        dy = np.broadcast_to(view.pixels.range, shape[1:])
        free = (window.samples < shape[1] - 1) & (window.rows < shape[0] - 1)
        long = window.rows * view.pixels.along_track
        off = np.abs(window.samples * dy - long)
        assert (off[free] <= np.maximum(dy, dy - long)[free] * (1 + 1e-9)).all()
        if coherence == 0:
            assert (window.rows == min(largest, shape[0] - 1 + shape[0] % 2)).all()
        # A window of one look tells no wrap, whatever its coherence.
        if coherence == 1 and not isinstance(policy, WrapSafeWindow):
            assert (window.rows == min(smallest, shape[0] - 1 + shape[0] % 2)).all()


@given(st.floats(1.0, 1e4))
def test_nearest_odd(size):
    odd = int(nearest_odd(size))
    assert odd % 2 == 1
    assert abs(odd - size) <= 1


def test_pixels_of_a_pair_on_the_plane():
    # A sample of c / (2 fs) of slant range covers 1 / cos(grazing) of it, here r / y; rows are a resolution apart.
    pair = pair_at(200.0, sample_rate=60e3)
    pixels = Pixels.of(pair, pair.geometry)
    times = pair.geometry.start + np.arange(64) / 60e3
    slant = C / 2 * times
    np.testing.assert_allclose(pixels.range, C / 120e3 * slant / np.sqrt(slant**2 - H**2), rtol=1e-6)
    assert pixels.along_track == SONAR.aperture.resolution
    assert pixels.looks == 0.5
    closer = replace(pair, row_spacing=0.01, row_looks=0.25)
    assert Pixels.of(closer, closer.geometry).along_track == 0.01
    assert Pixels.of(closer, closer.geometry).looks == 0.125
    # Before the first echo of the plane a sample has its length of slant range.
    early = replace(pair, geometry=Geometry(SONAR, 0.0))
    np.testing.assert_array_equal(Pixels.of(early, early.geometry).range, C / 120e3)


PAPER = {"pixels": PAPER_B, "largest": 101}


def test_paper_b_at_400_m():
    window = AdaptiveWindow(2.0, coherence=KnownCoherence(0.187), **PAPER).on(pair_at(400.0, (101, 101)))
    assert window.rows[0] == pytest.approx(39, abs=2)
    np.testing.assert_array_equal(window.rows, window.samples)
    std = bounds.depth_crlb(0.4 * 39**2, 0.187, FC, np.hypot(400.0, H), D, C)
    assert float(std) == pytest.approx(0.39, abs=0.02)


def test_paper_bs_fixed_window_crosses_50_cm_at_320_m():
    fixed = bounds.depth_crlb(0.4 * 81, 0.459, FC, np.hypot(320.0, H), D, C)
    assert float(fixed) == pytest.approx(0.5, abs=0.005)
    # With the constant spread of 50 cm the window there is that of 9 pixels, and 31 at 400 m.
    curve = KnownCoherence([0.459, 0.187], [320.0, 400.0])
    for ground, size in ((320.0, 9), (400.0, 31)):
        window = ConstantStdWindow(0.5, coherence=curve, **PAPER).on(pair_at(ground, (101, 101)))
        assert window.rows[0] == pytest.approx(size, abs=2)


def test_sizes_grow_smoothly_along_the_swath():
    pair = pair_at(60.0, (101, 17_000))
    window = AdaptiveWindow(2.0, coherence=ModelledCoherence("coarse sand"), largest=101).on(pair)
    beyond = np.sqrt((C / 2 * pair.grid.times) ** 2 - H**2) > 150.0
    steps = np.diff(window.rows[beyond])
    assert set(np.unique(steps)) == {0, 2}
    assert np.ptp(window.rows[beyond]) >= 10


@settings(max_examples=8, deadline=None)
@given(
    coherence=st.floats(0.05, 0.999),
    kappa=st.one_of(st.just(0.0), st.floats(0.2, 3.0)),
    most=st.floats(1e-6, 0.3),
    ground=st.floats(45.0, 400.0),
    pixels=st.one_of(st.none(), st.just(PAPER_B)),
)
def test_the_safe_window_is_the_smallest_that_does(coherence, kappa, most, ground, pixels):
    pair = pair_at(ground, (61, 200))
    predict, known = bounds.wrap_error_probability, KnownCoherence(coherence)
    policy = WrapSafeWindow(kappa, most, predict=predict, coherence=known, pixels=pixels, largest=31)
    window, view = policy.on(pair), policy.view(pair)
    at = np.array([0, 100, 199])
    slant, dx = C / 2 * pair.grid.times[at], view.pixels.along_track

    def does(rows):
        looks = view.square(rows).looks(pair)[at]
        wraps = predict(looks, coherence, B / FC) <= most * (1 + 1e-9)
        spread = slant * C / D / (2 * np.pi * FC) * bounds.multilook_phase_std(looks, coherence)
        return wraps & (rows[at] * dx * (1 + 1e-9) >= kappa * spread)

    assert (does(window.rows) | (window.rows[at] == policy.largest)).all()
    smaller = np.maximum(window.rows - 2, 1)
    assert (~does(smaller) | (window.rows[at] == policy.smallest)).all()
    # Each condition by itself asks for no more, and both together for the larger.
    for_wrap, for_phase = (part.on(pair).rows for part in policy.apart())
    np.testing.assert_array_equal(np.maximum(for_wrap, for_phase), window.rows)


def test_least_coherence():
    looks = np.array([[9.0, 33.0], [81.0, 0.5]])
    needed = least_coherence(bounds.wrap_error_probability, looks, 0.3, 0.01)
    assert needed[1, 1] == np.inf
    few = needed.ravel()[:3]
    np.testing.assert_allclose(bounds.wrap_error_probability([9.0, 33.0, 81.0], few, 0.3), 0.01, rtol=1e-8)
    np.testing.assert_array_equal(least_coherence(bounds.wrap_error_probability, looks[0], 0.3, 1.0), 0.0)


def test_the_wrap_rate_is_within_the_bound():
    coherence, most = 0.7, 0.02
    options = {"pixels": Pixels(0.02, 0.02, 0.75), "geometry": GEOMETRY, "coherence": KnownCoherence(coherence)}
    policy = WrapSafeWindow(0.0, most, largest=13, **options)
    pair = replace(patch(coherence, rows=9 * 50, samples=400), geometry=None)
    window = policy.on(pair)
    size = int(window.rows[0])
    assert (window.rows == size).all()
    looks = np.array([FixedWindow(n, n).looks(pair) for n in (size - 2, size)])
    smaller, predicted = bounds.cross_correlation_wrap_error_probability(looks, coherence, B / FC)
    assert predicted <= most < smaller

    def rate(size):
        """Of windows that do not overlap; the standard error is that of independent blocks of rows."""
        error = CrossCorrelation(FixedWindow(size, size)).estimate(pair).delay[size // 2 :: size, ::size]
        by_rows = (np.abs(error) > 0.5 / FC).mean(axis=1)
        return by_rows.mean(), by_rows.std(ddof=1) / np.sqrt(by_rows.size)

    # No more than was allowed (false alarms: 1e-6), and the next smaller window, which theory forbids, has more.
    wrong, error = rate(size)
    assert 0 < wrong <= most + 4.9 * error
    assert rate(size - 2)[0] > wrong


ON_SPECKLE = Geometry(SONARS["hisas-100khz"], 0.1)


SAFE = WrapSafeWindow(1.0, 0.01, geometry=ON_SPECKLE, smallest=1, largest=9, predict=bounds.wrap_error_probability)


@pytest.mark.parametrize(
    "estimator",
    [
        CrossCorrelation(ConstantStdWindow(0.05, geometry=ON_SPECKLE)),
        CrossCorrelation(SAFE),
        TwoWindow(Interferogram(AdaptiveWindow(2.0, geometry=ON_SPECKLE)), AdaptiveWindow(0.5, geometry=ON_SPECKLE)),
        MaximumLikelihood(
            AdaptiveWindow(1.0, geometry=ON_SPECKLE, coherence=KnownCoherence([0.99, 0.5], [70.0, 75.0]))
        ),
    ],
    ids=["constant-std", "wrap-safe", "two-window", "adaptive"],
)
def test_estimators_built_on_a_policy_have_no_findings(estimator):
    assert findings(estimator) == []


@pytest.mark.parametrize(
    ("build", "message"),
    [
        (lambda: ConstantStdWindow(0.0), "std is 0 m; it must be above 0 m"),
        (lambda: AdaptiveWindow(-1.0), "kappa is -1; it must be above 0"),
        (lambda: WrapSafeWindow(2.0, 0.0), "max_wrap_probability is 0; it must lie between 1e-12 and 1"),
        (lambda: WrapSafeWindow(-2.0, 0.1), "kappa is -2; it must lie between 0 and 1e+06"),
        (lambda: AdaptiveWindow(2.0, smallest=4), "smallest is 4; it must be odd"),
        (lambda: AdaptiveWindow(2.0, smallest=9, largest=7), "smallest is 9; it must be at most largest, 7"),
        (lambda: Pixels(0.02, 0.0, 0.4), "range is 0 m; it must be above 0 m"),
        (lambda: Pixels(0.02, 0.02, 1.4), "looks is 1.4; it must lie between 0 and 1"),
        (lambda: MeasuredCoherence(1, 1), "the first window is 1x1; it must have more pixels than one"),
        (lambda: KnownCoherence(1.5), "coherence is 1.5; it must lie between 0 and 1"),
        (lambda: KnownCoherence([0.5, 0.4]), "coherence has 2 values and ground_range 1; it must be as many"),
        (lambda: KnownCoherence([0.5, 0.4], [2.0, 1.0]), "ground_range has 1 m behind 2 m; it must rise"),
        (
            lambda: AdaptiveWindow(2.0).on(patch(0.5, 3, 20)),
            "the pair has no geometry; it must have one, or AdaptiveWindow be given geometry=",
        ),
    ],
)
def test_what_cannot_be(build, message):
    with pytest.raises(ValueError, match=f"^{re.escape(message)}$"):
        build()
