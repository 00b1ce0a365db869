"""Echoes of a seabed that is heard one part at a time: one series, and what a local warp of time makes of it."""

from functools import lru_cache

import numpy as np
import scipy.fft
from numpy.typing import NDArray

from sim.band import Complex, Real
from sim.compiled import compiled
from sim.heard import heard_at
from sim.levels import scatterer_power
from sim.listening import Listening
from sim.passes import scale, turn
from sim.profile import Profile, SeabedPoints
from sim.section import Section
from sim.streams import Streams, Use
from sim.texture import sampled, texture_shape
from sim.transforms import to_series


def warped_series(
    listening: Listening, sections: list[Section], rows: range, streams: Streams
) -> tuple[Complex, Complex]:
    """Noise-free series of rows at both receivers, (rows, samples) each; the secondary at its recorded carrier.

    A scatterer of Gaussian strength stands at the place that each sample of the primary hears. With the delay `d(u)`
    that registration leaves of what the secondary hears at `u`, its series is `p(u - d(u)) exp(-2 pi i fc d(u))`, one
    type-2 non-uniform FFT of the places where that delay turns the carrier by more than the accuracy; elsewhere it is
    `p`. That is all where the plan leaves out the decorrelation of the baseline. Where it does not, `p` is a series
    that fills the sampled band, of which the secondary's receiver passes `B`: registration moved that band by `-fc`
    times the slope of the plane's delay, which is undone by `exp(-2 pi i fc plane_delay(u))` for as long as the band is
    cut. Left out is that the stretch of time also widens it, an effect of second order on the coherence.

    Parameters
    ----------
    listening
        What is seen, by what, and what is modelled of it.
    sections
        One for all rows, or for each its own, with what the primary hears of it at the times of the grid.
    rows
        Numbers of the rows.
    streams
        Source of strengths.

    Raises
    ------
    ValueError
        Where several parts of the seabed are heard at a time.
    """
    plan, band = listening.plan, listening.band
    samples = _samples(listening, sections, rows, streams)
    spectrum = scipy.fft.fft(samples, axis=-1, norm="forward")
    if samples.shape[1] % 2 == 0:
        _without_highest(samples, spectrum)
    cut = band.passes * (band.grid.samples / band.weights.sum())
    if not plan.baseline:
        primary = _series(spectrum, cut)
        secondary = primary * listening.recorded_carrier
        _move(secondary, spectrum, listening, sections)
        return primary, secondary
    samples *= listening.recorded_carrier
    _move(samples, spectrum, listening, sections)
    return _series(spectrum, cut), _series(scipy.fft.fft(samples, axis=-1, norm="forward", overwrite_x=True), cut)


def _samples(listening: Listening, sections: list[Section], rows: range, streams: Streams) -> Complex:
    """Strengths of the scatterers at the samples of the rows, shape (rows, samples)."""
    scene, plan, band = listening.scene, listening.plan, listening.band
    samples = streams.gaussian(Use.SPECKLE, rows, np.array([_amplitude(listening, section) for section in sections]))
    if np.isfinite(scene.speckle_shape):
        in_range = sampled(plan.grid.sample_rate / band.bandwidth)
        shape = texture_shape(scene.speckle_shape, in_range, plan.along_track)
        samples *= np.sqrt(streams.texture(rows, plan.grid.samples, shape))
    return samples


def _amplitude(listening: Listening, section: Section) -> Real:
    """Amplitude of the scatterer at every sample: that of the floor where the section lies on it."""
    profile, (points, _, _, sample, _) = section
    # The ends of a furrow are off by what a cosine is.
    low = np.abs(profile.height) < 1e-15
    on_floor = low[:-1] & low[1:] & (not listening.scene.patches)
    amplitude = np.zeros(listening.plan.grid.samples)
    others = _as_floor(amplitude, _floor(listening), on_floor, points.segment, sample)
    if others is None:
        raise ValueError("delays is 'warp'; it must be 'scatterers' for a seabed that is heard several parts at a time")
    points = SeabedPoints(points.segment[others], points.share[others])
    amplitude[sample[others]] = _own_amplitude(listening, profile, points)
    return amplitude


@lru_cache(maxsize=2)
def _floor(listening: Listening) -> Real:
    """Amplitude of the scatterers of a flat floor at every sample."""
    sonar, grid = listening.sonar, listening.plan.grid
    profile = Profile(np.array(listening.scene.ground_range, dtype=float), np.zeros(2))
    heard = heard_at(profile, sonar, grid.times, sonar.altitude, shadow=False)
    amplitude = np.zeros(grid.samples)
    amplitude[heard.sample] = _own_amplitude(listening, profile, heard.points)
    return amplitude


def _own_amplitude(listening: Listening, profile: Profile, points: SeabedPoints) -> Real:
    """Amplitude of scatterers at points, for the length of seabed that is heard within a sample."""
    sonar, level = listening.sonar, listening.plan.level
    step = sonar.sound_speed / (2 * listening.plan.grid.sample_rate)
    length = step / np.abs(profile.closing(points, sonar.altitude))
    amplitude: Real = np.sqrt(scatterer_power(listening.scene, sonar, profile, points, length, level))
    return amplitude


@compiled
def _as_floor(
    amplitude: Real, floor: Real, on_floor: NDArray[np.bool_], segments: NDArray[np.int64], samples: NDArray[np.int64]
) -> NDArray[np.int64] | None:
    """Fill in the amplitude of parts that lie on the floor; which others there are, or None where samples repeat."""
    others, count, last = np.empty(len(samples), np.int64), 0, -1
    for part in range(len(samples)):
        if samples[part] <= last:
            return None
        last = samples[part]
        if on_floor[segments[part]]:
            amplitude[last] = floor[last]
        else:
            others[count] = part
            count += 1
    return others[:count]


def _without_highest(samples: Complex, spectrum: Complex) -> None:
    """Take from series of even length, and their spectra, the frequency that lies as far below the carrier as above."""
    middle = samples.shape[1] // 2
    highest = spectrum[:, [middle]]
    samples[:, ::2] -= highest
    samples[:, 1::2] += highest
    spectrum[:, middle] = 0.0


def _series(spectrum: Complex, cut: Real) -> Complex:
    """Series of spectra, which are cut in place."""
    for row in spectrum:
        scale(row, cut)
    series: Complex = scipy.fft.ifft(spectrum, axis=-1, norm="forward")
    return series


def _move(series: Complex, spectrum: Complex, listening: Listening, sections: list[Section]) -> None:
    """Put what has come before or after its time into series at the carrier they are recorded at."""
    grid, accuracy = listening.plan.grid, listening.plan.accuracy
    for number, (_, heard) in enumerate(sections):
        rows = slice(None) if len(sections) == 1 else slice(number, number + 1)
        delay = np.zeros(grid.samples)
        left = listening.geometry.left_delay(heard.ground_range, heard.height)
        # A scene shorter than a sample may lie between two.
        if left.size:
            _spread(grid.times, heard.sample, left, delay)
        turns = -listening.sonar.centre_frequency * delay
        moved = np.flatnonzero(np.abs(turns) > accuracy / (2 * np.pi))
        if moved.size:
            phase = (grid.times[moved] - delay[moved] - grid.start) * (2 * np.pi / grid.period)
            read = to_series(phase, spectrum[rows], accuracy, fft_order=True)
            for row in read:
                turn(row, turns[moved], np.ones(moved.size))
            read *= listening.recorded_carrier[moved]
            series[rows, moved] = read


@compiled
def _spread(times: Real, sample: NDArray[np.int64], left: Real, delay: Real) -> None:
    """Delays at times, straight between those of parts, each heard by the secondary at its sample's time and delay."""
    number, before, here = 0, -np.inf, left[0]
    for part in range(len(left)):
        after = times[sample[part]] + left[part]
        slope = (left[part] - here) / (after - before)
        while number < len(times) and times[number] < after:
            delay[number] = here + slope * (times[number] - before) if slope != 0 else here
            number += 1
        before, here = after, left[part]
    delay[number:] = here
