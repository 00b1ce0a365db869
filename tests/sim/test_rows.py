"""Rows along track: alike within the resolution, and the same in blocks of any size."""

from dataclasses import replace

import numpy as np
import pytest

from sim import (
    SONARS,
    AlongTrack,
    Box,
    PointTarget,
    Roughness,
    Scene,
    SedimentPatch,
    SyntheticAperture,
    TrawlMark,
    echo_blocks,
    plan,
    simulate,
)

SONAR = SONARS["hisas-100khz"]
COARSE = replace(SONAR, aperture=SyntheticAperture(resolution=0.1))
SCENES = {
    "alike": Scene((20.0, 24.0), (Box(21.0, 1.0, 0.5),), speckle_shape=3.0),
    "warped": Scene((20.0, 24.0), (TrawlMark(22.0, 30.0, 0.05, 1.0),), targets=(PointTarget(21.0, along_track=0.3),)),
    "rough": Scene(
        (20.0, 24.0),
        (Roughness(0.1, 1, period=6.4), Box(22.0, 0.5, 0.5, (0.0, 0.3))),
        "sand",
        patches=(SedimentPatch((21.0, 22.0), "rock", (0.0, 0.2)),),
    ),
}


@pytest.mark.parametrize("name", SCENES)
@pytest.mark.parametrize(("block", "jobs"), [(1, 1), (3, 2), (100, 1)])
def test_blocks_are_the_scene_to_the_last_bit(name, block, jobs):
    scene = SCENES[name]
    spacing = 0.09
    whole = simulate(scene, COARSE, rng=np.random.default_rng(5), rows=8, row_spacing=spacing)
    blocks = list(
        echo_blocks(scene, COARSE, rng=np.random.default_rng(5), rows=8, row_spacing=spacing, block=block, jobs=jobs)
    )
    for channel in ("primary", "secondary"):
        joined = np.concatenate([getattr(pair, channel) for pair in blocks])
        assert joined.tobytes() == getattr(whole, channel).tobytes()
    if not scene.uniform:
        for part in ("delay", "height", "shadow", "layover"):
            joined = np.concatenate([getattr(pair.truth, part) for pair in blocks])
            np.testing.assert_array_equal(joined, getattr(whole.truth, part))


def test_a_target_beyond_the_rows_of_a_block_adds_nothing_to_it():
    scene = Scene((20.0, 21.0), targets=(PointTarget(20.5, level=40.0, along_track=1.0),))
    dark, lit = (
        list(echo_blocks(one, COARSE, rng=np.random.default_rng(5), rows=40, block=10))
        for one in (replace(scene, targets=()), scene)
    )
    differs = [bool((one.primary != other.primary).any()) for one, other in zip(dark, lit, strict=True)]
    # Of rows .1 m apart the target reaches those within 12 resolutions, 1.2 m, of its place at 1 m.
    assert differs == [True, True, True, False]


def test_a_scene_between_two_samples_is_silent():
    pair = simulate(Scene((30.0, 30.0001)), SONAR, rng=np.random.default_rng(1))
    assert not pair.primary.any()
    assert not pair.secondary.any()
    assert pair.truth.shadow.all()


def test_rows_a_resolution_apart_are_independent_and_not_filtered():
    rows = AlongTrack(0.1, 0.1)
    assert rows.halo == 0
    assert rows.looks == 1
    series = np.arange(6.0).reshape(3, 2) + 0j
    assert rows.gather(series) is series


@pytest.mark.parametrize(("spacing", "resolution"), [(0.02, 0.0405), (0.05, 0.06), (0.01, 0.1)])
def test_weights_pass_the_band_of_the_aperture(spacing, resolution):
    """Flat within the band of wavenumbers `1 / resolution`, dark outside, half the power at its edges."""
    rows = AlongTrack(spacing, resolution)
    assert np.sum(rows.weights**2) == pytest.approx(1.0, rel=1e-12)
    wavenumber = np.linspace(0, 0.5 / spacing, 2001)
    response = np.abs(
        np.exp(-2j * np.pi * np.outer(wavenumber, np.arange(-rows.halo, rows.halo + 1)) * spacing) @ rows.weights
    )
    response /= response[0]
    edge = 0.5 / resolution
    assert np.abs(response[wavenumber < 0.85 * edge] - 1).max() < 0.01
    assert response[wavenumber > 1.15 * edge].max() < 0.01
    assert np.interp(edge, wavenumber, response) == pytest.approx(0.5, abs=0.01)


def test_looks_of_neighbouring_rows_are_those_of_the_spacing():
    """`1 / sum rho^2` over the autocorrelation of the weights, the looks of a row among many, is `spacing / dx`."""
    rows = AlongTrack(0.02, 0.0405)
    autocorrelation = np.correlate(rows.weights, rows.weights, "full")
    assert 1 / np.sum(autocorrelation**2) == pytest.approx(rows.looks, rel=0.02)
    # Paper B: .4 looks in a pixel of 2 by 2 cm.
    along_range = 0.02 / SONARS["hisas-1032"].range_resolution
    assert AlongTrack(0.02, SONARS["hisas-1032"].aperture.resolution).looks * along_range == pytest.approx(
        0.4, abs=0.005
    )


def test_gathering_is_a_sum_of_weighted_rows():
    rows = AlongTrack(0.02, 0.0405)
    rng = np.random.default_rng(3)
    series = rng.standard_normal((40 + 2 * rows.halo, 5)) + 1j * rng.standard_normal((40 + 2 * rows.halo, 5))
    expected = [np.tensordot(rows.weights, series[row : row + 2 * rows.halo + 1], axes=1) for row in range(40)]
    single = rows.gather(series.astype(np.complex64))
    np.testing.assert_allclose(rows.gather(series), expected, atol=1e-13)
    assert single.dtype == np.complex64
    np.testing.assert_allclose(single, expected, atol=1e-5)


def test_speckle_of_rows_correlates_as_the_aperture_says():
    """Mean of p*(m) p(m + d) over 20 m of seabed against the autocorrelation of a flat band, sinc(d spacing / dx).

    With the soft band edges of the filter it is off by .01 at the most; a mean over N looks scatters by 1 / sqrt(N),
    5 standard errors.
    """
    pair = simulate(Scene((30.0, 50.0)), COARSE, rng=np.random.default_rng(8), rows=200, row_spacing=0.04)
    lit = np.isfinite(pair.truth.delay)
    for series in (pair.primary[:, lit], pair.secondary[:, lit]):
        looks = series.size * 0.4 * pair.bandwidth / pair.sample_rate
        for apart in (0, 1, 2, 3, 5, 10):
            product = np.mean(series[: 200 - apart].conj() * series[apart:])
            assert product == pytest.approx(np.sinc(0.4 * apart), abs=0.01 + 5 / np.sqrt(looks))


def test_a_plan_says_the_spacing_or_the_call_does():
    scene = Scene((20.0, 24.0))
    with pytest.raises(ValueError, match=r"^row_spacing is 0.02 m; it must be left out where a plan says it$"):
        simulate(scene, SONAR, rng=np.random.default_rng(0), row_spacing=0.02, required=plan(scene, SONAR))


def test_single_precision_holds_the_same_numbers():
    scene = SCENES["alike"]
    made = plan(scene, COARSE, rows=4, row_spacing=0.05)
    double, single = (
        simulate(scene, COARSE, rng=np.random.default_rng(2), rows=4, required=replace(made, single=single))
        for single in (False, True)
    )
    assert single.primary.dtype == np.complex64
    scale = np.sqrt(np.mean(np.abs(double.primary) ** 2))
    # Half a unit in the last of 24 binary digits in each of 61 terms of weights that square to 1, and of the sum.
    np.testing.assert_allclose(single.primary, double.primary, atol=8 * scale * 2.0**-24 * np.sqrt(61), rtol=0)
