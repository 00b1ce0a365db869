"""Multi-chromatic: a straight line through the phases of many sub-bands."""

from dataclasses import dataclass

import numpy as np
import scipy.fft

from estimators.estimate import DelayEstimate
from estimators.peak import Peak
from estimators.search import by_rows, describe, read_at
from estimators.sub_bands import LAGS_PER_RESOLUTION, band_pass, band_share, carried_to, lag_slope
from estimators.windows import WindowPolicy
from sim import EchoPair, checks
from sim.band import Complex, Real


@dataclass(frozen=True)
class MultiChromatic:
    """Delay from a straight line through the phases of sub-band interferograms, refined by the full-band phase.

    The band falls into `C` equal parts with centres `f_c`, `B / C` apart, whose windowed zero-lag interferograms are
    `I_c` (paper A, section 3.3). About the line of the delay that makes `|sum_c I_c exp(2 pi i f_c tau)|` highest, of a
    few in `1 / B` and all within `C / (2 B)`, beyond which phases are ambiguous, all bands are unwrapped at once. The
    straight line through the phases that remain, weighted by `|I_c|`, moves it by `-cov(f, phi) / (2 pi var f)`. The
    phase of the full band's lag product at that delay then refines it. Every sub-band is carried from zero lag to the
    delay along its derivative, as the speckle's spectrum is off centre within it. (Unwrapped from band to band, a
    single poor one would lose all beyond it.)

    The weights: noise of one power over the band leaves a phase the variance `(1 - gamma^2) / (2 gamma^2 E_c)`, with
    `E_c` the energy of the sub-band in the window, to which `|I_c|` is proportional; and to second order this line
    maximises `|sum_c I_c exp(2 pi i f_c tau)|`, the likelihood of one coherence over the band. The bound is the
    group-delay bound over `sqrt(1 - 1 / C^2)`: 1.155 times it for two bands, 1.061 for three, 1.02 for five.

    Parameters
    ----------
    window
        What to average over, or the policy that says it for a pair; a sub-band has only the share `1 / C` of its looks,
        and of one look the phase is poor.
    bands
        `C`, at least 2.
    refine
        Whether the residual phase refines the delay.

    Raises
    ------
    ValueError
        For fewer bands; by `estimate`, for so many that one holds no Fourier bin.
    """

    window: WindowPolicy
    bands: int = 5
    refine: bool = True

    def __post_init__(self) -> None:
        checks.flag("refine", self.refine)
        checks.count("bands", self.bands, least=2)

    def estimate(self, pair: EchoPair) -> DelayEstimate:
        """Estimate the delay at every sample; ValueError where the window exceeds the pair, or bands are too narrow."""
        window = self.window.on(pair)
        width = pair.bandwidth / self.bands
        if width * pair.grid.period < 1:
            most = int(pair.bandwidth * pair.grid.period)
            raise ValueError(f"bands is {self.bands}; it must be at most {most}, so that each holds a Fourier bin")

        def peaks(primary: Complex, secondary: Complex) -> Peak:
            frequencies = scipy.fft.fftfreq(primary.shape[1], 1 / pair.sample_rate)
            centres = width * (np.arange(self.bands) - (self.bands - 1) / 2)
            shares = [band_share(frequencies, centre, width) for centre in centres]
            middles = np.array([np.average(frequencies, weights=share) for share in shares])
            parts = [(band_pass(primary, share), band_pass(secondary, share)) for share in shares]
            interferograms = np.stack([window.sum(low.conj() * high) for low, high in parts])
            slopes = np.stack([lag_slope(low, high, frequencies, window) for low, high in parts])
            delay = _line_through(interferograms, slopes, middles)
            magnitude = np.abs(interferograms).sum(axis=0)
            return Peak(delay, interferograms.sum(axis=0), magnitude, np.ones((), dtype=np.bool_)).spread()

        line = by_rows(pair, window, 0, 256 + 384 * self.bands, peaks).delay
        search = min(0.5 / width, pair.grid.period / 2)
        peak = read_at(pair, window, line, LAGS_PER_RESOLUTION, search, refine=self.refine)
        bandwidth = pair.bandwidth * np.sqrt(1 - 1 / self.bands**2)
        return describe(pair, window, peak, refine=self.refine, search=search, bandwidth=bandwidth)


def _line_through(interferograms: Complex, slopes: Complex, centres: Real) -> Real:
    """Delay of the straight line through the phases of sub-bands, shape (band, rows, time) [s].

    `slopes` are the derivatives of the interferograms over the delay, with which they are carried to the delay that
    they are unwrapped about, and then to the better one.
    """
    spacing = (centres[-1] - centres[0]) / (len(centres) - 1)
    # An odd number of delays, some four in 1 / B and even about zero: receivers swapped give the same ones.
    delays = scipy.fft.fftfreq(4 * len(centres) + 1) / spacing
    delay: Real = delays[np.abs(scipy.fft.ifft(interferograms, len(delays), axis=0)).argmax(axis=0)]
    for _ in range(2):
        delay = delay - _slope(carried_to(delay, interferograms, slopes), centres) / (2 * np.pi)
    return delay


def _slope(interferograms: Complex, centres: Real) -> Real:
    """Slope over frequency of the line through the phases about that of the sum, weighted by magnitude [rad/Hz]."""
    f = centres[:, None, None]
    phase = np.angle(interferograms * interferograms.sum(axis=0).conj())
    weight = np.abs(interferograms)
    total = weight.sum(axis=0)
    middle = np.divide((weight * f).sum(axis=0), total, out=np.zeros_like(total), where=total > 0)
    moment = (weight * (f - middle) ** 2).sum(axis=0)
    covariance = (weight * (f - middle) * phase).sum(axis=0)
    slope: Real = np.divide(covariance, moment, out=np.zeros_like(total), where=moment > 0)
    return slope
