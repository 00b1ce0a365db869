"""Split spectrum (Delta-k): the phase slope between two outer sub-bands."""

from dataclasses import dataclass

import numpy as np
import scipy.fft

from estimators.estimate import DelayEstimate
from estimators.peak import Peak
from estimators.search import by_rows, describe, read_at
from estimators.sub_bands import LAGS_PER_RESOLUTION, band_share, carried_to, zero_lag_bands
from estimators.windows import WindowPolicy
from sim import EchoPair, checks
from sim.band import Complex, Real

BYTES_PER_SAMPLE = 1024


@dataclass(frozen=True)
class SplitSpectrum:
    """Delay from the phase difference of two sub-band interferograms, refined by the full-band phase.

    With sub-bands of width `b` at the ends of the band, `df` apart, and their windowed zero-lag interferograms
    `I_low`, `I_high`: `delay = -arg(I_high I_low*) / (2 pi df)`, unambiguous within `1 / (2 df)` (paper A, section 3.3;
    Delta-k). As the speckle's spectrum is off centre within each, their phases err in proportion to the delay from the
    lag at which they are read: they are carried half way to it, along their derivatives, which leaves a quarter of that
    variance. (Carried all the way they follow the error of the first reading too: up to a tenth more wrong wraps where
    these are rare.) The phase of the full band's lag product at the delay then refines it. The bound is the group-delay
    bound times `sqrt(B^3 / (6 b (B - b)^2))`, least at `b = B / 3`.

    Parameters
    ----------
    window
        What to average over, or the policy that says it for a pair; a sub-band has only the share `b / B` of its looks.
    sub_bandwidth
        `b` [Hz], at most `B / 2`; `B / 3` where None.
    refine
        Whether the residual phase refines the delay.
    """

    window: WindowPolicy
    sub_bandwidth: float | None = None
    refine: bool = True

    def __post_init__(self) -> None:
        if self.sub_bandwidth is not None:
            checks.positive("sub_bandwidth", self.sub_bandwidth, "Hz")

    def estimate(self, pair: EchoPair) -> DelayEstimate:
        """Estimate the delay at every sample; ValueError where window or sub-band exceed the pair."""
        window = self.window.on(pair)
        width = pair.bandwidth / 3 if self.sub_bandwidth is None else self.sub_bandwidth
        if width > pair.bandwidth / 2:
            raise ValueError(
                f"sub_bandwidth is {width:g} Hz; it must be at most half the band, {pair.bandwidth / 2:g} Hz"
            )
        if width * pair.grid.period < 1:
            raise ValueError(f"sub_bandwidth is {width:g} Hz; it must hold a Fourier bin, {1 / pair.grid.period:g} Hz")
        apart = pair.bandwidth - width

        def peaks(primary: Complex, secondary: Complex) -> Peak:
            frequencies = scipy.fft.fftfreq(primary.shape[1], 1 / pair.sample_rate)
            shares = [band_share(frequencies, centre, width) for centre in (-apart / 2, apart / 2)]
            spacing = np.average(frequencies, weights=shares[1]) - np.average(frequencies, weights=shares[0])
            interferograms, slopes = zero_lag_bands(primary, secondary, frequencies, shares, window)
            delay = _delay(interferograms, spacing)
            delay = delay / 2 + _delay(carried_to(delay / 2, interferograms, slopes), spacing)
            return Peak(delay, interferograms[0], np.abs(interferograms[0]), np.ones((), dtype=np.bool_)).spread()

        search = min(0.5 / apart, pair.grid.period / 2)
        delay = np.clip(by_rows(pair, window, 0, BYTES_PER_SAMPLE, peaks).delay, -search, search)
        peak = read_at(pair, window, delay, LAGS_PER_RESOLUTION, search, refine=self.refine)
        # Two bands have the rms width of a flat one that is narrower by the factor of their bound.
        share = width / pair.bandwidth
        bandwidth = pair.bandwidth * np.sqrt(6 * share) * (1 - share)
        return describe(pair, window, peak, refine=self.refine, search=search, bandwidth=bandwidth)


def _delay(interferograms: Complex, spacing: float) -> Real:
    """Delay from the phase difference of two sub-bands so far apart [Hz]."""
    low, high = interferograms
    delay: Real = -np.angle(high * low.conj()) / (2 * np.pi * spacing)
    return delay
