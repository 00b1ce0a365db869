"""Statistics of simulated scenes against theorems: decorrelation, layover, shadow, heavy tails, levels, shortcuts."""

from dataclasses import replace

import numpy as np
import pytest
from scipy import special, stats

from sim import (
    SEDIMENTS,
    SONARS,
    AlongTrack,
    Box,
    PointTarget,
    Scene,
    SedimentPatch,
    SnrProfile,
    Sonar,
    Step,
    SyntheticAperture,
    TrawlMark,
    plan,
    simulate,
)
from sim.band import Band
from sim.geometry import travel_times

NEAR, FAR = SONARS["hisas-100khz"], SONARS["hisas-1032"]
FALSE_ALARM = 1e-6


def jackknife(statistic, *rows):
    """A statistic of sums over independent rows, and its standard error from leaving out one row at a time."""
    whole = [part.sum(axis=0) for part in rows]
    left_out = np.array([statistic(*(total - part[row] for total, part in zip(whole, rows, strict=True)))
                         for row in range(len(rows[0]))])  # fmt: skip
    count = len(left_out)
    return statistic(*whole), np.sqrt((count - 1) / count * ((left_out - left_out.mean(axis=0)) ** 2).sum(axis=0))


@pytest.mark.parametrize(("altitude", "slant"), [(15.0, 20.0), (15.0, 30.0), (15.0, 60.0), (42.0, 60.0)])
@pytest.mark.parametrize("delays", ["scatterers", "warp"])
def test_coherence_of_a_flat_floor_falls_by_the_baseline_shift(altitude, slant, delays):
    """`1 - df / B` with `df = (fc / 2)(1 - r / r_s)`, about `fc D H / (2 r^2)`, in an endless record.

    What decorrelates comes from scatterers `c / (2 df)` away and beyond, 12 m and more: the sum over those of this
    record says how much of it there is (.95 to 1.03 of `df / B`). Within five standard errors of that, a false-alarm
    rate of 6e-7, from leaving out one of 300 independent rows at a time: it has a band of `df` only, and so far fewer
    looks than the echoes.
    """
    sonar = replace(NEAR, altitude=altitude)
    ground_range = np.sqrt(slant**2 - altitude**2)
    scene = Scene((5.0, ground_range + 100.0))
    made = plan(scene, sonar, delays=delays, baseline=True)
    pair = simulate(scene, sonar, rng=np.random.default_rng(3), rows=300, required=made)
    columns = np.abs(pair.grid.times * 750.0 - slant) < 0.25
    primary, secondary = pair.primary[:, columns], pair.secondary[:, columns]
    sums = ((np.abs(primary) ** 2).sum(1), (np.abs(secondary) ** 2).sum(1), (primary.conj() * secondary).sum(1))
    found, error = jackknife(lambda p, s, c: np.abs(c) / np.sqrt(p * s), *sums)
    expected = coherence_of_a_floor(pair, sonar, scene, pair.grid.times[columns])
    beyond = np.sqrt(slant**2 + sonar.baseline * (sonar.baseline + 2 * altitude))
    endless = sonar.centre_frequency / 2 * (1 - slant / beyond) / sonar.bandwidth
    assert 1 - expected == pytest.approx(endless, rel=0.05)
    assert error < 0.15 * endless
    assert found == pytest.approx(expected, abs=5 * error)


def coherence_of_a_floor(pair, sonar, scene, times):
    """Of scatterers of equal power everywhere in time, by a sum over them: both pulses, and the phase of the delays."""
    band = Band(pair.grid, pair.bandwidth)
    excess = sonar.baseline * (sonar.baseline + 2 * sonar.altitude)

    def delay(time):
        slant = time * sonar.sound_speed / 2
        return (np.sqrt(slant**2 + excess) - slant) / sonar.sound_speed

    def pulse(after):
        # The Fourier bins of the band, those at its edges with the root of their weight.
        turn, edge = np.pi * after / pair.grid.period, band.harmonics[-1]
        inner = np.sin((2 * edge - 1) * turn) / np.where(turn == 0, 1.0, np.sin(turn))
        return np.where(turn == 0, 2 * edge - 1, inner) + 2 * np.sqrt(band.weights[-1]) * np.cos(2 * edge * turn)

    first, last = (2 * np.hypot(y, sonar.altitude) / sonar.sound_speed for y in scene.ground_range)
    heard = np.linspace(first, last, 100_001)
    sums = np.zeros(3, dtype=complex)
    for time in times[::4]:
        one, other = pulse(time - heard), pulse(time + delay(time) - heard - delay(heard))
        turned = np.exp(2j * np.pi * sonar.centre_frequency * (delay(time) - delay(heard)))
        sums += [np.sum(one**2), np.sum(other**2), np.sum(one * other * turned)]
    return abs(sums[2]) / np.sqrt(sums[0].real * sums[1].real)


def test_layover_of_two_patches_follows_the_cosine_of_half_their_phase():
    """A wall at the near end of the scene and the floor on top of it, at about 45 degrees below the sonar.

    Parts of powers P at delays d have the coherence `|sum P exp(-2 pi i fc d)| / sum P` at zero lag, for equal ones
    `|cos(pi fc dtau)|`; with even scattering the power goes with the length of seabed that is heard within a time,
    `1 / depth` for a wall and `1 / ground range` for a floor. Each part also loses `1 - df / B` and `sinc(B d)`.
    """
    sonar = Sonar(centre_frequency=100e3, bandwidth=10e3, baseline=0.1, altitude=30.0)
    scene = Scene((26.9, 60.0), (Step(26.9 + 1e-9, 6.0),))
    made = plan(scene, sonar)
    assert made.delays == "scatterers"
    pair = simulate(scene, sonar, rng=np.random.default_rng(4), rows=2000, required=made)
    deviations, errors, magnitudes, cosines = [], [], [], []
    for slant in np.arange(36.2, 40.0, 0.3):
        columns = np.abs(pair.grid.times * 750.0 - slant) < 0.05
        heard = pair.grid.times[columns][:, None] * 750.0
        # The wall, then the floor on top of it.
        y = np.concatenate([np.full_like(heard, 26.9), np.sqrt(heard**2 - 24.0**2)], axis=1)
        depth = np.concatenate([np.sqrt(heard**2 - 26.9**2), np.full_like(heard, 24.0)], axis=1)
        power = np.stack([1 / depth[:, 0], 1 / y[:, 1]], axis=1)
        delay = pair.geometry.registered_delay(*travel_times(sonar, y, 30.0 - depth))
        shift = 1e5 * 0.1 / (2 * heard**2) * np.stack([y[:, 0] ** 2 / depth[:, 0], depth[:, 1]], axis=1)
        kept = power * np.sinc(1e4 * delay) * (1 - shift / 1e4)
        expected = np.sum(kept * np.exp(-2j * np.pi * 1e5 * delay)) / power.sum()
        primary, secondary = pair.primary[:, columns], pair.secondary[:, columns]
        sums = ((np.abs(primary) ** 2).sum(1), (np.abs(secondary) ** 2).sum(1), (primary.conj() * secondary).sum(1))
        found = jackknife(lambda p, s, c: c / np.sqrt(p * s), *sums)[0]
        error = [
            jackknife(lambda p, s, c, part=part: part(c / np.sqrt(p * s)), *sums)[1] for part in (np.real, np.imag)
        ]
        deviations.append(abs(found - expected))
        errors.append(np.hypot(*error))
        magnitudes.append(abs(expected))
        cosines.append(abs(np.cos(np.pi * 1e5 * np.mean(delay[:, 1] - delay[:, 0]))))
    # Patches as equal as these follow the bare cosine, from its zero to its crest.
    assert np.abs(np.array(magnitudes) - cosines).max() < 0.05
    assert min(cosines) < 0.3
    assert max(cosines) > 0.95
    # At most one and a half times a Rayleigh deviate of variance 1 / 2 each, 13 of them: 1e-6 at 4.05.
    assert (np.array(deviations) < 4.05 * np.array(errors)).all()


def test_shadow_has_the_coherence_of_no_echo_and_any_phase():
    """Noise alone: mean sample coherence of L looks `(sqrt(pi) / 2) Gamma(L) / Gamma(L + 1/2)`, phase uniform.

    Behind a box, far from anything that is lit, where side lobes of the flat band are 40 dB below noise of 10 dB SNR.
    """
    scene = Scene((38.0, 62.0), (Box(40.0, 5.0, 3.0),))
    pair = simulate(scene, NEAR, rng=np.random.default_rng(6), snr=10.0, rows=800)
    dark = np.flatnonzero(np.abs(pair.grid.times * 750.0 - 51.0) < 0.8)[::4]
    assert pair.truth.shadow[dark].all()
    primary, secondary = (series[:, dark].reshape(-1, 8, len(dark)) for series in (pair.primary, pair.secondary))
    product = (primary.conj() * secondary).sum(axis=1)
    energy = np.sqrt((np.abs(primary) ** 2).sum(axis=1) * (np.abs(secondary) ** 2).sum(axis=1))
    samples = np.abs(product / energy).ravel()
    mean = np.sqrt(np.pi) / 2 * special.gamma(8) / special.gamma(8.5)
    # Every fourth sample, three resolution cells apart, is as good as independent.
    assert samples.mean() == pytest.approx(mean, abs=5 * samples.std() / np.sqrt(samples.size))
    assert stats.kstest(np.angle(product).ravel(), stats.uniform(-np.pi, 2 * np.pi).cdf).pvalue > FALSE_ALARM


@pytest.mark.parametrize(
    ("shape", "delays", "spacing"),
    [(0.5, "warp", 0.03), (2.0, "warp", 0.015), (2.0, "scatterers", 0.03), (8.0, "scatterers", 0.015)],
)
def test_speckle_has_the_second_moment_of_a_k_distribution(shape, delays, spacing):
    """`<I^2> / <I>^2 = 2 (1 + 1 / shape)`, over rows far apart; five standard errors from the scatter of 40 groups."""
    scene = Scene((40.0, 90.0), speckle_shape=shape)
    made = plan(scene, NEAR, row_spacing=spacing, delays=delays)
    pair = simulate(scene, NEAR, rng=np.random.default_rng(9), rows=240, required=made)
    lit = np.isfinite(pair.truth.delay)
    intensity = np.abs(pair.primary[:, lit][:, 40:-40]) ** 2
    groups = intensity.reshape(40, -1)
    # Far more samples than a group needs: the ratio is off by less than its standard error.
    ratios = (groups**2).mean(axis=1) / intensity.mean() ** 2
    error = ratios.std(ddof=1) / np.sqrt(len(ratios))
    assert ratios.mean() == pytest.approx(2 * (1 + 1 / shape), abs=5 * error)


@pytest.mark.parametrize("delays", ["scatterers", "warp"])
def test_speckle_close_below_the_sonar_has_the_second_moment_too(delays):
    """At 10 m of ground range from 15 m, where a resolution of slant range covers 1.8 times as much ground.

    With the texture of as many scatterers as lie in a resolution of ground the shape would be 3.6, the moment 2.55.
    """
    scene = Scene((9.0, 11.0), speckle_shape=2.0)
    made = plan(scene, NEAR, delays=delays)
    pair = simulate(scene, NEAR, rng=np.random.default_rng(14), rows=2000, required=made)
    ground_range = np.sqrt(np.maximum((pair.grid.times * 750.0) ** 2 - 15.0**2, 0))
    intensity = np.abs(pair.primary[:, (ground_range > 9.4) & (ground_range < 10.6)]) ** 2
    ratios = (intensity.reshape(40, -1) ** 2).mean(axis=1) / intensity.mean() ** 2
    error = ratios.std(ddof=1) / np.sqrt(len(ratios))
    assert 5 * error < 3.0 - 2.55
    assert ratios.mean() == pytest.approx(3.0, abs=5 * error)


def test_a_patch_of_sediment_is_as_bright_as_a_scene_of_it():
    patch = SedimentPatch((150.0, 250.0), SEDIMENTS["rock"])
    pair, whole = (
        simulate(scene, FAR, rng=np.random.default_rng(10), rows=30)
        for scene in (Scene((100.0, 300.0), sediment="silt", patches=(patch,)), Scene((100.0, 300.0), sediment="rock"))
    )
    ground_range = np.sqrt(np.maximum((pair.grid.times * 740.0) ** 2 - 42.0**2, 0))
    inside, outside = (ground_range > 160) & (ground_range < 240), (ground_range > 110) & (ground_range < 140)
    power, other = (np.abs(p.primary) ** 2 for p in (pair, whole))
    looks = 30 * inside.sum() * 0.75
    # The same strengths by the same seed: only side lobes of what is beside differ.
    assert power[:, inside].mean() == pytest.approx(other[:, inside].mean(), rel=5 / np.sqrt(looks))
    assert power[:, outside].mean() < 0.2 * other[:, outside].mean()


def test_a_point_target_stands_where_it_is_and_is_as_bright_as_given():
    """In a silent scene: its delay, its level at the peak, and a row `d` away weaker by `sinc(d / dx)`."""
    target = PointTarget(50.0, height=1.0, level=26.0, along_track=0.09)
    scene = Scene((40.0, 60.0), sediment=SEDIMENTS["silt"].adjusted(level_offset=-150.0), targets=(target,))
    sonar = replace(NEAR, noise=replace(NEAR.noise, excess=-0.0))
    made = plan(scene, sonar, row_spacing=0.015)
    pair = simulate(scene, sonar, rng=np.random.default_rng(11), rows=13, required=made)
    noiseless = simulate(replace(scene, targets=()), sonar, rng=np.random.default_rng(11), rows=13, required=made)
    primary, secondary = pair.primary - noiseless.primary, pair.secondary - noiseless.secondary
    arrival, above = travel_times(sonar, 50.0, 1.0)
    peak = np.abs(primary[6]).argmax()
    assert pair.grid.times[peak] == pytest.approx(arrival, abs=0.5 / pair.sample_rate)
    fraction = (pair.grid.times[peak] - arrival) * pair.bandwidth
    assert np.abs(primary[6, peak]) == pytest.approx(10**1.3 * np.sinc(fraction), rel=1e-2)
    for away in (0, 1, 3, 5):
        expected = abs(np.sinc(away * 0.5)) * 10**1.3 * np.sinc(fraction)
        assert np.abs(primary[6 + away, peak]) == pytest.approx(expected, abs=0.01 * 10**1.3)
    phase = np.angle(np.sum(primary[6].conj() * secondary[6]))
    delay = pair.geometry.registered_delay(arrival, above)
    assert np.exp(1j * phase) == pytest.approx(np.exp(-2j * np.pi * 1e5 * delay), abs=0.02)


@pytest.mark.parametrize("height", [10.0, -10.0])
def test_a_target_heard_before_or_after_the_floor_stands_where_it_is(height):
    scene = Scene((30.0, 32.0), targets=(PointTarget(31.0, height=height),))
    pair = simulate(scene, NEAR, rng=np.random.default_rng(15), row_spacing=1.0)
    quiet = simulate(replace(scene, targets=()), NEAR, rng=np.random.default_rng(15), row_spacing=1.0)
    assert quiet.grid.period < pair.grid.period
    slant = pair.grid.times[np.abs(pair.primary[0]).argmax()] * 750.0
    assert slant == pytest.approx(np.hypot(31.0, 15.0 - height), abs=0.5 * 750.0 / pair.sample_rate)


def test_the_level_of_a_target_is_over_the_floor_of_a_profile():
    """At -10 dB of floor over noise, 40 dB over the floor are 30 dB over the noise."""
    scene = Scene((40.0, 60.0), targets=(PointTarget(50.0, level=40.0),))
    profile = SnrProfile((40.0,), (-10.0,))
    lit, dark = (
        simulate(one, NEAR, rng=np.random.default_rng(16), snr=profile).primary[0]
        for one in (scene, replace(scene, targets=()))
    )
    # Of a band-limited pulse of unit peak the samples' squares add up to `fs / B`, here 4/3.
    assert np.sum(np.abs(lit - dark) ** 2) == pytest.approx(10**3 * 4 / 3, rel=0.01)


MARKS = Scene((42.0, 400.0), (TrawlMark(90.0, 20.0, 0.15), TrawlMark(180.0, -40.0, 0.2)), sediment="coarse sand")


def measured(pair, edges):
    """Log power, Fisher's z of the coherence at the true delay and its phase, with standard errors, by stretch."""
    carried = np.exp(2j * np.pi * pair.centre_frequency * np.nan_to_num(pair.truth.delay))
    starts = np.searchsorted(pair.grid.times * 740.0, edges)
    sums = [
        np.add.reduceat(values, starts, axis=1)[:, :-1]
        for values in (
            np.abs(pair.primary) ** 2,
            np.abs(pair.secondary) ** 2,
            pair.primary.conj() * pair.secondary * carried,
        )
    ]
    statistics = (
        lambda p, s, c: np.log(p),
        lambda p, s, c: np.arctanh(np.abs(c) / np.sqrt(p * s)),
        lambda p, s, c: np.angle(c),
    )
    return [jackknife(statistic, *sums) for statistic in statistics]


def test_the_planned_warp_agrees_with_the_full_model_over_the_swath():
    """Power, coherence at the true delay and phase in 40 stretches, over 80 rows of independent speckle.

    The plan's tolerance is 2 % of the spread of an estimate: .02 of Fisher's z, as the spread goes with the root of
    `1 - coherence^2`. Beyond it, Student's t of 79 degrees of freedom at a false-alarm rate of 1e-6 in all.
    """
    made = plan(MARKS, FAR, rows=80)
    assert made.delays == "warp"
    edges = np.linspace(62.0, 400.0, 41)
    full, planned = (
        measured(simulate(MARKS, FAR, rng=np.random.default_rng(seed), rows=80, required=one), edges)
        for seed, one in ((1, plan(MARKS, FAR, rows=80, delays="scatterers")), (2, made))
    )
    limit = stats.t.isf(0.5 * FALSE_ALARM / 120, 79)
    for (one, error), (other, other_error), tolerance in zip(full, planned, (0.02, 0.02, 0.0), strict=True):
        assert (np.abs(one - other) < limit * np.hypot(error, other_error) + tolerance).all()
    for phase, error in (full[2], planned[2]):
        assert (np.abs(phase) < limit * error).all()


def test_looks_of_planned_rows_are_those_that_the_pair_states():
    """Paper B's pixel: variance of mean intensities over 9 by 9 pixels of 2 cm is one over 81 x .4 looks."""
    scene = Scene((200.0, 216.0))
    sample_rate = FAR.sound_speed / (2 * 0.02)
    made = plan(scene, FAR, row_spacing=0.02)
    made = replace(made, grid=replace(made.grid, sample_rate=sample_rate))
    pair = simulate(scene, FAR, rng=np.random.default_rng(12), rows=900, required=made)
    lit = np.isfinite(pair.truth.delay)
    intensity = np.abs(pair.primary[:, lit][:, 40:-40]) ** 2
    columns = intensity.shape[1] // 9 * 9
    means = intensity[:, :columns].reshape(100, 9, -1, 9).mean(axis=(1, 3))
    found = means.mean() ** 2 / means.var(ddof=1)
    # In a window, more than the mean over many: n^2 / sum (n - |d|) rho^2 for rows and samples, from their sincs.
    expected = np.prod(
        [
            81 / (9 + 2 * np.sum((9 - np.arange(1, 9)) * np.sinc(share * np.arange(1, 9)) ** 2))
            for share in (AlongTrack(0.02, 0.0405).looks, FAR.bandwidth / sample_rate)
        ]
    )
    assert 81 * 0.4 <= expected < 1.35 * 81 * 0.4
    # Neighbouring windows are nearly independent: relative spread of a variance sqrt(2 / n), here taken with n / 2.
    assert found == pytest.approx(expected, rel=5 * np.sqrt(4 / means.size))
    assert pair.row_looks == pytest.approx(0.02 / 0.0405)
    assert SyntheticAperture().resolution == 0.03


def test_a_profile_of_the_signal_to_noise_ratio_is_that_of_the_echoes():
    """Coherence `rho / (1 + rho)` and power `1 + rho` in stretches of 5 m; 5 standard errors from independent rows."""
    scene, profile = Scene((150.0, 250.0)), SnrProfile((160.0, 240.0), (10.0, -10.0))
    pair = simulate(scene, FAR, rng=np.random.default_rng(13), snr=profile, rows=150)
    ground_range = np.sqrt(np.maximum((pair.grid.times * 740.0) ** 2 - 42.0**2, 0))
    for low in np.arange(155.0, 245.0, 5.0):
        columns = (ground_range >= low) & (ground_range < low + 5.0)
        ratio = 10 ** (np.interp(ground_range[columns], (160.0, 240.0), (10.0, -10.0)) / 10)
        primary, secondary = pair.primary[:, columns], pair.secondary[:, columns]
        sums = ((np.abs(primary) ** 2).sum(1), (np.abs(secondary) ** 2).sum(1), (primary.conj() * secondary).sum(1))
        found, error = jackknife(lambda p, s, c: c.real / np.sqrt(p * s), *sums)
        # Power adds up, and so does what is common of it.
        assert found == pytest.approx(ratio.sum() / (1 + ratio).sum(), abs=5 * error + 4e-4)
        assert sums[0].mean() / columns.sum() == pytest.approx(
            1 + ratio.mean(), abs=5 * sums[0].std() / columns.sum() / np.sqrt(150)
        )
