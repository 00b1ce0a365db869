"""Sub-bands of a series, and zero-lag interferograms carried to a delay."""

import numpy as np
import scipy.fft

from estimators.windows import Window
from sim.band import Complex, Real

LAGS_PER_RESOLUTION = 4
"""Lags in `1 / B` between which the full band's lag product is interpolated, to 6e-5 of its amplitude."""


def band_share(frequencies: Real, centre: float, width: float) -> Real:
    """Share of each Fourier bin that lies in a band; none of the Nyquist bin, which lies at both ends.

    `frequencies` are those of `scipy.fft.fftfreq` [Hz], relative to the centre frequency as `centre` is.
    """
    bin_width = frequencies[1]
    share: Real = np.clip((width / 2 - np.abs(frequencies - centre)) / bin_width + 0.5, 0.0, 1.0)
    if len(frequencies) % 2 == 0:
        share[len(frequencies) // 2] = 0.0
    return share


def band_pass(series: Complex, share: Real) -> Complex:
    """The part of periodic series (rows, samples) in a band, whose power in every bin is the share of it."""
    passed: Complex = scipy.fft.ifft(scipy.fft.fft(series, axis=-1) * np.sqrt(share), axis=-1)
    return passed


def lag_slope(primary: Complex, secondary: Complex, frequencies: Real, window: Window) -> Complex:
    """Derivative over the delay, at zero, of the windowed lag product `sum p*(t - tau/2) s(t + tau/2)` [1/s]."""
    turn: Complex = window.sum(
        primary.conj() * _derivative(secondary, frequencies) - _derivative(primary, frequencies).conj() * secondary
    )
    return turn / 2


def _derivative(series: Complex, frequencies: Real) -> Complex:
    slope: Complex = scipy.fft.ifft(2j * np.pi * frequencies * scipy.fft.fft(series, axis=-1), axis=-1)
    return slope


def carried_to(delay: Real, product: Complex, slope: Complex) -> Complex:
    """Lag product at a delay from its value and derivative at zero: the phase to first order, the magnitude kept."""
    rate = np.divide(slope, product, out=np.zeros_like(product), where=product != 0).imag
    carried: Complex = product * np.exp(1j * rate * delay)
    return carried
