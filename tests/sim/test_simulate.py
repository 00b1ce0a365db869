import numpy as np
import pytest
from scipy import stats

from sim import SONARS, Box, Scene, Sonar, Wedge, plan, simulate
from sim.band import Band
from sim.echoes import place_scatterers, scatterer_spectra
from sim.geometry import plane_delay, travel_times
from sim.levels import level_of_floor
from sim.listening import Listening
from sim.registration import registration
from sim.streams import Streams, Use
from sim.visibility import sees

SONAR = SONARS["hisas-100khz"]
SCENE = Scene((18.0, 32.0), (Box(22.0, 2.0, 1.0), Wedge(26.0, 2.0, 0.5)))


def flat_floor(seed, *, near=20.0, far=120.0, **options):
    return simulate(Scene((near, far)), SONAR, rng=np.random.default_rng(seed), **options)


def on_floor(pair):
    return np.isfinite(pair.truth.delay)


def test_series_equal_the_direct_sum_over_scatterers():
    made = plan(SCENE, SONAR, scatterers_per_resolution=2.0, accuracy=1e-12)
    grid, profile, streams = made.grid, SCENE.profile(), Streams((5,))
    band = Band(grid, SONAR.bandwidth)
    spectra = scatterer_spectra(Listening(SCENE, SONAR, made), profile, range(2), streams)
    primary, secondary = band.series(spectra[0]), registration(band, SONAR).series(spectra[1])

    points, length = place_scatterers(profile, SONAR.range_resolution / 2.0, streams.of(Use.PLACES))
    lit = sees(profile, points, SONAR.altitude)
    points, length = points.chosen(lit), length[lit]
    arrivals = travel_times(SONAR, *profile.position(points))
    gaussian = np.array([streams.of(Use.SPECKLE, row).standard_normal((len(length), 2)) for row in range(2)])
    strengths = (gaussian @ [1, 1j]) * np.sqrt(level_of_floor(SONAR, arrivals[0], length) / 2)
    # Drawn as the primary hears them, at its carrier.
    strengths = strengths * np.exp(2j * np.pi * SONAR.centre_frequency * arrivals[0])
    seen_above = sees(profile, points, SONAR.altitude + SONAR.baseline)

    def passband(times, arrival, strength):
        after = times[:, None] - arrival
        pulse = np.zeros(after.shape, dtype=complex)
        for weight, frequency in zip(np.sqrt(band.weights) / band.weights.sum(), band.frequencies, strict=True):
            pulse += weight * np.exp(2j * np.pi * frequency * after)
        return (pulse * np.exp(2j * np.pi * SONAR.centre_frequency * after)) @ strength.T

    checked = np.arange(0, grid.samples, 37)
    times = grid.times[checked]
    carrier = np.exp(-2j * np.pi * SONAR.centre_frequency * times)[:, None]
    direct_primary = (carrier * passband(times, arrivals[0], strengths)).T
    moved = times + plane_delay(SONAR, times)
    direct_secondary = (carrier * passband(moved, arrivals[1], strengths * seen_above)).T
    scale = np.abs(primary).max()
    np.testing.assert_allclose(primary[:, checked], direct_primary, atol=1e-9 * scale, rtol=0)
    np.testing.assert_allclose(secondary[:, checked], direct_secondary, atol=1e-9 * scale, rtol=0)


def test_speckle_is_circular_gaussian_of_unit_power():
    # Samples a resolution cell apart or more; 4 tests at 2.5e-7 make 1e-6 in all.
    pair = flat_floor(1, rows=40)
    spacing = int(np.ceil(3 * pair.sample_rate / pair.bandwidth))
    for series in (pair.primary, pair.secondary):
        samples = series[:, on_floor(pair)][:, 60:-60:spacing].ravel()
        assert stats.kstest(np.abs(samples) ** 2, stats.expon.cdf).pvalue > 2.5e-7
        assert stats.kstest(np.angle(samples), stats.uniform(-np.pi, 2 * np.pi).cdf).pvalue > 2.5e-7


def test_noise_has_the_stated_ratio_and_leaves_the_speckle_alone():
    clean, noisy = flat_floor(2, rows=20), flat_floor(2, rows=20, snr=7.0)
    noise = noisy.primary - clean.primary
    power = np.mean(np.abs(noise) ** 2, axis=1)
    # A mean of about `looks` exponential powers a row; 5 standard errors have a false-alarm rate of 6e-7.
    looks = Band(clean.grid, clean.bandwidth).looks * 20
    assert power.mean() == pytest.approx(10**-0.7, rel=5 / np.sqrt(looks))


@pytest.mark.parametrize("slant", [20.0, 30.0, 60.0])
def test_coherence_of_a_flat_floor_falls_by_the_baseline_shift(slant):
    # 1 - df / B with df = fc D H / (2 r^2). The spread of a sample coherence g of N looks is (1 - g^2) / sqrt(2 N);
    # 5 standard errors have a false-alarm rate of 6e-7.
    scene = Scene((10.0, 75.0))
    made = plan(scene, SONAR, delays="scatterers")
    pair = simulate(scene, SONAR, rng=np.random.default_rng(3), rows=150, required=made)
    near = np.abs(pair.grid.times * 750.0 - slant) < 0.25
    primary, secondary = pair.primary[:, near], pair.secondary[:, near]
    energy = np.sqrt(np.sum(np.abs(primary) ** 2) * np.sum(np.abs(secondary) ** 2))
    coherence = np.abs(np.sum(primary.conj() * secondary)) / energy
    shift = SONAR.centre_frequency * SONAR.baseline * SONAR.altitude / (2 * slant**2)
    expected = 1 - shift / SONAR.bandwidth
    looks = 150 * near.sum() * pair.bandwidth / pair.sample_rate
    assert coherence == pytest.approx(expected, abs=5 * (1 - expected**2) / np.sqrt(2 * looks))


def test_interferogram_follows_the_true_delay():
    pair = simulate(SCENE, SONAR, rng=np.random.default_rng(4), rows=100)
    unique = on_floor(pair)
    carried = np.exp(2j * np.pi * SONAR.centre_frequency * pair.truth.delay[unique])
    phase = np.angle(np.sum(pair.primary[:, unique].conj() * pair.secondary[:, unique] * carried, axis=0))
    # 100 looks of coherence 0.95 or better: a spread of 0.023 rad, and half the samples within 0.68 of that.
    assert np.median(np.abs(phase)) < 0.023


def test_shadow_is_dark():
    pair = simulate(Scene((15.0, 90.0), (Box(40.0, 5.0, 3.0),)), SONAR, rng=np.random.default_rng(6), rows=10)
    dark = np.abs(pair.grid.times * 750.0 - 51.0) < 1.0
    assert pair.truth.shadow[dark].all()
    assert np.mean(np.abs(pair.primary[:, dark]) ** 2) < 0.01


def test_same_seed_same_bits():
    first, second = (simulate(SCENE, SONAR, rng=np.random.default_rng(9), snr=3.0, rows=2) for _ in range(2))
    assert first.primary.tobytes() == second.primary.tobytes()
    assert first.secondary.tobytes() == second.secondary.tobytes()


def test_one_scatterer_a_cell_gives_the_same_power_as_many():
    # Means over about 3,700 looks a row; 5 standard errors of a difference.
    scene = Scene((20.0, 120.0))
    plans = [plan(scene, SONAR, delays="scatterers", scatterers_per_resolution=density) for density in (1.0, 16.0)]
    pairs = (simulate(scene, SONAR, rng=np.random.default_rng(7), rows=20, required=made) for made in plans)
    powers = [np.mean(np.abs(pair.primary) ** 2) for pair in pairs]
    assert powers[0] / powers[1] == pytest.approx(1.0, abs=5 * np.sqrt(2 / (20 * 3700)))


def test_altitude_must_be_above_the_scene():
    low = Sonar(centre_frequency=100e3, bandwidth=30e3, baseline=0.3, altitude=1.0)
    with pytest.raises(ValueError, match=r"^altitude is 1 m; it must be above the highest point of the scene, 1 m$"):
        simulate(SCENE, low, rng=np.random.default_rng(0))
