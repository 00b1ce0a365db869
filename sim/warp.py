"""Echoes of a seabed that is heard one part at a time: one series, and what a local warp of time makes of it."""

import numpy as np
import scipy.fft

from sim.band import Band, Complex, Real
from sim.geometry import travel_times
from sim.heard import Heard
from sim.levels import scatterer_power
from sim.listening import Listening
from sim.profile import Profile
from sim.registration import Resampling
from sim.streams import Streams, Use
from sim.texture import sampled, texture_shape


def warped_series(
    listening: Listening, profile: Profile, heard: Heard, rows: range, streams: Streams
) -> tuple[Complex, Complex]:
    """Noise-free series of rows with one section at both receivers, the secondary registered; (rows, samples) each.

    A scatterer of Gaussian strength stands at the place that each sample of the primary hears. With the delay `d(u)`
    that registration leaves of what the secondary hears at `u`, its series is `p(u - d(u)) exp(-2 pi i fc d(u))`, one
    type-2 non-uniform FFT. That is all where the plan leaves out the decorrelation of the baseline. Where it does not,
    `p` is a series that fills the sampled band, of which the secondary's receiver passes `B`: registration moved that
    band by `-fc` times the slope of the plane's delay, which is undone by `exp(-2 pi i fc plane_delay(u))` for as long
    as the band is cut. Left out is that the stretch of time also widens it, an effect of second order on the coherence.

    Parameters
    ----------
    listening
        What is seen, by what, and what is modelled of it.
    profile
        The section.
    heard
        What the primary hears of it at the times of the grid.
    rows
        Numbers of the rows.
    streams
        Source of strengths.

    Raises
    ------
    ValueError
        Where several parts of the seabed are heard at a time.
    """
    if (np.diff(heard.sample) <= 0).any():
        raise ValueError("delays is 'warp'; it must be 'scatterers' for a seabed that is heard several parts at a time")
    scene, sonar, plan, band = listening.scene, listening.sonar, listening.plan, listening.band
    grid = band.grid
    samples = streams.gaussian(Use.SPECKLE, rows, grid.samples)
    if np.isfinite(scene.speckle_shape):
        in_range = sampled(grid.sample_rate / band.bandwidth)
        shape = texture_shape(scene.speckle_shape, in_range, plan.along_track)
        samples *= np.sqrt(streams.texture(rows, grid.samples, shape))
    samples *= _amplitude(listening, profile, heard)
    spectrum = scipy.fft.fft(samples, axis=-1, overwrite_x=True)
    primary = np.take(spectrum, band.harmonics, axis=-1) * (np.sqrt(band.weights) / band.weights.sum())

    left = listening.geometry.registered_delay(*travel_times(sonar, heard.ground_range, heard.height))
    # A scene shorter than a sample may lie between two.
    delay = np.interp(grid.times, grid.times[heard.sample] + left, left) if left.size else np.zeros(grid.samples)
    if not plan.baseline:
        return band.series(primary), Resampling(band, sonar.centre_frequency, delay, plan.accuracy).series(primary)
    wide = Band(grid, grid.sample_rate)
    everything = np.take(spectrum, wide.harmonics, axis=-1) / band.weights.sum()
    secondary = Resampling(wide, sonar.centre_frequency, delay, plan.accuracy).series(everything)
    return band.series(primary), _passed(secondary, listening)


def _passed(series: Complex, listening: Listening) -> Complex:
    """What the secondary's receiver passes of registered series that fill the sampled band."""
    band = listening.band
    bins = scipy.fft.fft(series * listening.recorded_carrier, axis=-1, norm="forward", overwrite_x=True)
    passed: Complex = band.series(np.take(bins, band.harmonics, axis=-1) * np.sqrt(band.weights))
    passed *= listening.recorded_carrier.conj()
    return passed


def _amplitude(listening: Listening, profile: Profile, heard: Heard) -> Real:
    """Amplitude of the scatterer at every sample, for the length of seabed that is heard within a sample."""
    sonar, grid = listening.sonar, listening.plan.grid
    length = sonar.sound_speed / (2 * grid.sample_rate) / np.abs(profile.closing(heard.points, sonar.altitude))
    amplitude = np.zeros(grid.samples)
    power = scatterer_power(listening.scene, sonar, profile, heard.points, length, listening.plan.level)
    amplitude[heard.sample] = np.sqrt(power)
    return amplitude
