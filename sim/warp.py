"""Echoes of a seabed that is heard one part at a time: one series, and what a local warp of time makes of it."""

import numpy as np
import scipy.fft
from numpy.typing import NDArray

from sim.band import Complex, Real
from sim.compiled import compiled
from sim.levels import scatterer_power
from sim.listening import Listening
from sim.passes import scale
from sim.section import Section
from sim.streams import Streams, Use
from sim.texture import sampled, texture_shape
from sim.transforms import to_series


def warped_series(
    listening: Listening, sections: list[Section], rows: range, streams: Streams
) -> tuple[Complex, Complex]:
    """Noise-free series of rows at both receivers, (rows, samples) each; the secondary at the carrier it is recorded at.

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
    """Amplitude of the scatterer at every sample, for the length of seabed that is heard within a sample."""
    sonar, grid, (profile, heard) = listening.sonar, listening.plan.grid, section
    if (np.diff(heard.sample) <= 0).any():
        raise ValueError("delays is 'warp'; it must be 'scatterers' for a seabed that is heard several parts at a time")
    length = sonar.sound_speed / (2 * grid.sample_rate) / np.abs(profile.closing(heard.points, sonar.altitude))
    amplitude = np.zeros(grid.samples)
    power = scatterer_power(listening.scene, sonar, profile, heard.points, length, listening.plan.level)
    amplitude[heard.sample] = np.sqrt(power)
    return amplitude


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
    turning = -2 * np.pi * listening.sonar.centre_frequency
    for number, (_, heard) in enumerate(sections):
        rows = slice(None) if len(sections) == 1 else slice(number, number + 1)
        delay = np.zeros(grid.samples)
        left = listening.geometry.left_delay(heard.ground_range, heard.height)
        # A scene shorter than a sample may lie between two.
        if left.size:
            _spread(grid.times, heard.sample, left, delay)
        moved = np.flatnonzero(np.abs(turning * delay) > accuracy)
        if moved.size:
            phase = (grid.times[moved] - delay[moved] - grid.start) * (2 * np.pi / grid.period)
            read = to_series(phase, spectrum[rows], accuracy, fft_order=True)
            read *= np.exp(1j * turning * delay[moved]) * listening.recorded_carrier[moved]
            series[rows, moved] = read


@compiled
def _spread(times: Real, sample: NDArray[np.int64], left: Real, delay: Real) -> None:
    """Delays at times, straight between those of parts, each heard by the secondary at its sample's time and delay."""
    part, last = 0, len(left) - 1
    for number in range(len(times)):
        while part < last and times[sample[part + 1]] + left[part + 1] <= times[number]:
            part += 1
        before = times[sample[part]] + left[part]
        delay[number] = left[part]
        if part < last and times[number] > before:
            after = times[sample[part + 1]] + left[part + 1]
            delay[number] += (left[part + 1] - left[part]) * (times[number] - before) / (after - before)
