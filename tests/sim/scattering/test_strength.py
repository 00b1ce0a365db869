import subprocess
import sys
import warnings

import numpy as np
import pytest
from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as st

from sim import SEDIMENTS, ElasticBed, FluidBed, Sediment, ValidityWarning, reflection_loss, scattering_strength
from sim.scattering import apl_uw, small_slope
from sim.scattering.roughness import structure_constant
from sim.scattering.validity import warn_once

MODELS = ("apl-uw", "small-slope")
BANDS = {"apl-uw": apl_uw.FREQUENCIES, "small-slope": small_slope.FREQUENCIES}


def between(low, high):
    return st.floats(low, high, allow_nan=False)


def logarithmic(low, high):
    return between(np.log(low), np.log(high)).map(np.exp)


FLUIDS = st.builds(
    FluidBed,
    density_ratio=between(1.0, 3.0),
    sound_speed_ratio=between(0.8, 3.0),
    loss_parameter=logarithmic(1e-4, 0.1),
    volume_parameter=between(0.0, 0.02),
    # Few exponents: each makes a table of its own.
    spectral_exponent=st.sampled_from([2.4, 2.75, 3.0, 3.25, 3.6, 3.9]),
    spectral_strength_cm4=logarithmic(1e-4, 1.0),
)
SOLIDS = st.builds(
    ElasticBed,
    density_ratio=between(1.0, 3.0),
    compressional_speed_ratio=between(0.8, 3.0),
    compressional_loss=logarithmic(1e-4, 0.1),
    shear_speed_ratio=st.one_of(st.just(0.0), logarithmic(1e-4, 2.0)),
    shear_loss=logarithmic(1e-3, 1.0),
    spectral_exponent=st.sampled_from([2.4, 2.75, 3.0, 3.25, 3.6, 3.9]),
    spectral_strength_si=logarithmic(1e-6, 1e-3),
    volume_exponent=between(2.5, 3.5),
    volume_strength=between(0.0, 0.01),
    compressional_speed_fluctuation=between(-4.0, 4.0),
    shear_speed_fluctuation=between(-4.0, 4.0),
)
SEABEDS = st.builds(Sediment, name=st.just("any"), fluid=FLUIDS, elastic=st.one_of(st.none(), SOLIDS))
ANGLES = st.one_of(logarithmic(0.01, 1.0), between(1.0, 90.0))
CASES = st.sampled_from(MODELS).flatmap(lambda model: st.tuples(st.just(model), logarithmic(*BANDS[model])))


def strength(sediment, angle, frequency, model, component="total"):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ValidityWarning)
        return scattering_strength(sediment, angle, frequency, model=model, component=component)


def critical_angles(sediment, model):
    bed = sediment.solid
    speeds = (
        [sediment.fluid.sound_speed_ratio]
        if model == "apl-uw"
        else [bed.compressional_speed_ratio, bed.shear_speed_ratio]
    )
    return [np.degrees(np.arccos(1 / speed)) for speed in speeds if speed >= 1] or [-90.0]


PARTS = np.linspace(0, 1, 257)


def has_jump(levels):
    """Whether one of many small steps [dB] is large beside all of them together: what is steep is no jump."""
    return np.abs(np.diff(levels)).max() > max(0.02, 0.25 * np.ptp(levels))


@settings(max_examples=300, deadline=None)
@given(sediment=SEABEDS, angle=ANGLES, case=CASES)
def test_finite_and_without_jump_in_angle_and_frequency(sediment, angle, case):
    """Within a thousandth of a degree and of the frequency, in steps of 1/256 of these.

    Slopes have no bound: the specular peak of the smoothest bed falls by 43 dB in a thousandth of a degree, and where
    the roughest goes from one approximation to another its level grows with the 24th power of frequency.
    """
    model, frequency = case
    levels = strength(sediment, angle - 0.001 * PARTS, frequency, model)
    beside = strength(sediment, angle, frequency * (1 + 0.001 * PARTS), model)
    assert np.isfinite(levels).all()
    assert np.isfinite(beside).all()
    if min(abs(angle - critical) for critical in critical_angles(sediment, model)) > 1:
        assert not has_jump(levels)
        assert not has_jump(beside)


def test_a_jump_of_a_tenth_of_a_decibel_is_found():
    slope = np.linspace(0, 0.2, 257)
    assert not has_jump(slope)
    assert has_jump(slope + 0.1 * (slope > 0.07))


@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize("exponent", [2.1, 2.4, 3.9, 3.99])
def test_finite_far_outside_the_stated_ranges(model, exponent):
    angle = np.concatenate([[1e-300, 1e-9], np.geomspace(0.01, 1, 30), np.arange(1.0, 90.0), [90 - 1e-9, 90.0]])
    for strength_cm4 in (1e-12, 1.0, 100.0):
        bed = SEDIMENTS["clay"].adjusted(spectral_exponent=exponent, spectral_strength_cm4=strength_cm4)
        with np.errstate(all="raise", under="ignore"):
            levels = strength(bed, angle, np.array([[1e-3], [1e2], [1e5], [1e7]]), model)
        assert np.isfinite(levels).all()


@pytest.mark.parametrize("model", MODELS)
def test_steps_of_a_tenth_of_a_degree_over_the_catalogue(model):
    angle = np.arange(4.0, 87.0, 0.1)
    for sediment in SEDIMENTS.values():
        for frequency in (*BANDS[model], 100e3):
            step = np.abs(np.diff(strength(sediment, angle, frequency, model)))
            near = np.min([np.abs(angle[:-1] - critical) for critical in critical_angles(sediment, model)], axis=0) < 4
            assert step[~near].max() <= 0.5, sediment.name


@settings(max_examples=300, deadline=None)
@given(sediment=SEABEDS, angle=ANGLES, case=CASES)
def test_total_is_never_below_its_parts(sediment, angle, case):
    model, frequency = case
    total, roughness, volume = (
        strength(sediment, angle, frequency, model, component) for component in ("total", "roughness", "volume")
    )
    assert total >= max(roughness, volume)
    assert not np.isnan(volume)


def gently_rough(sediment, angle, frequency, model):
    """Where strength must rise with roughness.

    Beyond these the handbook hands over to its formula for rocks, at an rms slope of 7 degrees, and the small-slope
    integral saturates: at alpha = 1/2, `p / (1 + p^2)^(3/2)` falls beyond `p = 0.71`.
    """
    k = 2 * np.pi * frequency / 1500
    if model == "apl-uw":
        return np.full(np.shape(angle), np.degrees(np.arctan(apl_uw._rms_slope(sediment.fluid, k))) < 6)
    bed = sediment.solid
    constant = structure_constant(bed.spectral_strength_si, bed.spectral_exponent)
    q, q3 = 2 * k * np.cos(np.radians(angle)), 2 * k * np.sin(np.radians(angle))
    return constant / 2 * q3**2 * q ** (2 - bed.spectral_exponent) < 0.3


def rougher(sediment, factor):
    changed = sediment.adjusted(spectral_strength_cm4=sediment.fluid.spectral_strength_cm4 * factor)
    if changed.elastic:
        changed = changed.adjusted(spectral_strength_si=changed.elastic.spectral_strength_si * factor)
    return changed


@settings(max_examples=300, deadline=None, suppress_health_check=[HealthCheck.filter_too_much])
@given(sediment=SEABEDS, angle=between(1.0, 15.0), case=CASES, factor=between(1.05, 3.0))
def test_rises_with_roughness_strength_at_low_angles(sediment, angle, case, factor):
    model, frequency = case
    rough = rougher(sediment, factor)
    assume(gently_rough(rough, angle, frequency, model))
    low, high = (strength(bed, angle, frequency, model, "roughness") for bed in (sediment, rough))
    assert high > low


@pytest.mark.parametrize("model", MODELS)
def test_rises_with_roughness_strength_over_the_catalogue(model):
    angle = np.arange(0.5, 15.1, 0.5)
    for sediment in SEDIMENTS.values():
        for frequency in (30e3, 100e3):
            rough = rougher(sediment, 1.3)
            low, high = (strength(bed, angle, frequency, model, "roughness") for bed in (sediment, rough))
            rises = high > low
            assert rises[gently_rough(rough, angle, frequency, model)].all(), sediment.name


@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize("component", ["total", "roughness", "volume"])
def test_what_is_not_lit_does_not_scatter(model, component):
    levels = scattering_strength("sand", [0.0, -0.0, -5.0, -90.0, 180.0, np.nan], 1e5, model=model, component=component)
    assert (levels[:5] == -np.inf).all()
    assert np.isnan(levels[5])


@pytest.mark.parametrize("model", MODELS)
def test_angles_fold_at_the_normal_and_broadcast_with_frequency(model):
    angle, frequency = np.array([[20.0], [160.0], [90.0]]), np.array([30e3, 60e3])
    levels = scattering_strength("sand", angle, frequency, model=model)
    assert levels.shape == (3, 2)
    np.testing.assert_allclose(levels[0], levels[1], rtol=1e-12)
    assert levels[0, 1] == scattering_strength("sand", 20.0, 60e3, model=model)


def test_level_offset_moves_every_component():
    moved = SEDIMENTS["rock"].adjusted(level_offset=-15.0)
    for model in MODELS:
        for component in ("total", "roughness", "volume"):
            levels = [scattering_strength(bed, 20.0, 1e5, model=model, component=component) for bed in ("rock", moved)]
            assert levels[1] == pytest.approx(levels[0] - 15)


def test_sound_speed_scales_the_wavenumber():
    assert scattering_strength("sand", 20.0, 30e3, sound_speed=1500.0) == pytest.approx(
        scattering_strength("sand", 20.0, 60e3, sound_speed=3000.0)
    )


def test_warns_once_beyond_the_stated_band():
    warn_once.cache_clear()
    with pytest.warns(ValidityWarning, match="^apl-uw is used outside 10 to 100 kHz"):
        first = scattering_strength("sand", 20.0, 122e3)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert scattering_strength("sand", 20.0, 122e3) == first
    steep = SEDIMENTS["clay"].adjusted(spectral_exponent=2.2)
    with pytest.warns(ValidityWarning, match="^apl-uw is used with a spectral_exponent outside 2.4 to 3.9"):
        assert np.isfinite(scattering_strength(steep, 20.0, 100e3))


def test_reflection_loss_has_no_value_where_nothing_is_reflected():
    for model in MODELS:
        assert np.isnan(reflection_loss("sand", [0.0, -3.0], model=model)).all()
        # At the normal: (rho nu - 1) / (rho nu + 1) for a fluid of nearly no loss.
        product = 1.845 * 1.1782
        assert reflection_loss("sand", 90.0, model=model) == pytest.approx(
            -20 * np.log10((product - 1) / (product + 1)), abs=0.01
        )


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"sediment": "mud"}, "sediment is 'mud'; the closest names are sandy mud"),
        ({"model": "lambert"}, "model is 'lambert'; it must be apl-uw or small-slope"),
        ({"component": "all"}, "component is 'all'; it must be total or roughness or volume"),
        ({"frequency": 0.0}, "frequency is 0 Hz at the least; all must be finite and above 0 Hz"),
        ({"sound_speed": -1.0}, "sound_speed is -1 m/s; it must be above 0 m/s"),
    ],
)
def test_bad_input(change, message):
    good = {"sediment": "sand", "grazing_angle": 20.0, "frequency": 1e5}
    with pytest.raises(ValueError, match=f"^{message}$"):
        scattering_strength(**{**good, **change})


def test_importing_the_catalogue_needs_no_file_of_the_tests(tmp_path):
    code = "import sim; print(len(sim.SEDIMENTS))"
    run = subprocess.run([sys.executable, "-c", code], cwd=tmp_path, capture_output=True, text=True, check=True)
    assert run.stdout.strip() == "23"
