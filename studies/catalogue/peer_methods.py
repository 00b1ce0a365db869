"""What the study `peers` compares: the same tasks by our code, by others' and by their definitions."""

from collections.abc import Sequence
from typing import Any

import numpy as np
import scipy.fft
import scipy.signal
from numpy.typing import NDArray
from scipy.ndimage import uniform_filter

from estimators import CrossCorrelation, FixedWindow, MaximumLikelihood
from estimators.interference import interferogram
from estimators.lag_product import extended, lag_product, upsampled
from estimators.matrix import everything, family
from sim import EchoPair, Sonar, speckle_pair
from sim.band import Band, Complex, Real, TimeGrid
from sim.echoes import echo_spectrum

SIZE = 9
"""Rows and samples of the interferogram's window."""

FINER = 16
"""How many times as fine series are resampled before their peaks are read by a parabola."""


def exact_interferogram(first: Complex, other: Complex) -> Complex:
    """Windowed `sum conj(p) s` where the window lies inside, added up in long doubles."""
    product = (first.conj() * other).astype(np.clongdouble)
    for axis in (0, 1):
        product = np.lib.stride_tricks.sliding_window_view(product, SIZE, axis).sum(axis=-1)
    return product.astype(np.complex128)


def ours_interferogram(first: NDArray[Any], other: NDArray[Any]) -> NDArray[Any]:
    """With the coherence, as all give."""
    return interferogram(first, other, SIZE, SIZE, circular=False)[0]


def uniform_filters(first: NDArray[Any], other: NDArray[Any]) -> NDArray[Any]:
    """Four of them, for product and coherence."""
    product = first.conj() * other
    real, imaginary, *energies = (
        uniform_filter(np.ascontiguousarray(plane), SIZE, mode="constant")
        for plane in (product.real, product.imag, np.abs(first) ** 2, np.abs(other) ** 2)
    )
    found: NDArray[Any] = real + 1j * imaginary
    np.abs(found) / np.sqrt(energies[0] * energies[1])
    return found


def convolved(first: NDArray[Any], other: NDArray[Any]) -> NDArray[Any]:
    """By overlapping FFTs, for product and coherence."""
    ones = np.ones((SIZE, SIZE))
    found, *energies = (
        scipy.signal.oaconvolve(plane, ones, mode="same")
        for plane in (first.conj() * other, np.abs(first) ** 2, np.abs(other) ** 2)
    )
    np.abs(found) / np.sqrt(np.abs(energies[0] * energies[1]))
    product: NDArray[Any] = found
    return product


def records(sonar: Sonar, shape: tuple[int, int], coherence: float, delay: Real, rng: np.random.Generator) -> EchoPair:
    """Periodic records of speckle, critically sampled, each with a delay [s]."""
    return speckle_pair(
        shape,
        coherence=coherence,
        delay=delay,
        centre_frequency=sonar.centre_frequency,
        bandwidth=sonar.bandwidth,
        sample_rate=sonar.bandwidth,
        rng=rng,
    )


def cross_correlation(pair: EchoPair, *, refine: bool = True) -> Real:
    """Delay of each record [s]."""
    return CrossCorrelation(FixedWindow(1, pair.shape[1]), refine).estimate(pair).delay[:, 0]


def maximum_likelihood(pair: EchoPair) -> Real:
    """Delay of each record [s]."""
    return MaximumLikelihood(FixedWindow(1, pair.shape[1])).estimate(pair).delay[:, 0]


def resampled_peaks(pair: EchoPair) -> Real:
    """`scipy.signal.resample` of the circular correlation, and a parabola through its highest magnitudes [s]."""
    spectra = (scipy.fft.fft(series, axis=-1) for series in (pair.primary, pair.secondary))
    correlation = scipy.fft.ifft(next(spectra).conj() * next(spectra), axis=-1)
    finer = np.abs(scipy.signal.resample(correlation, FINER * pair.shape[1], axis=-1))
    near = FINER * int(np.ceil(pair.sample_rate / pair.bandwidth))
    return _parabola(np.concatenate([finer[:, -near - 1 :], finer[:, : near + 2]], axis=1), near + 1) / (
        FINER * pair.sample_rate
    )


def correlated_peaks(pair: EchoPair) -> Real:
    """`scipy.signal.correlate` of each record resampled, and a parabola through the highest magnitudes [s]."""
    found = []
    for primary, secondary in zip(pair.primary, pair.secondary, strict=True):
        first, second = (scipy.signal.resample(series, FINER * series.size) for series in (primary, secondary))
        magnitude = np.abs(scipy.signal.correlate(second, first, mode="same", method="fft"))
        middle, near = first.size // 2, FINER * int(np.ceil(pair.sample_rate / pair.bandwidth))
        found.append(magnitude[middle - near - 1 : middle + near + 2])
    return _parabola(np.array(found), near + 1) / (FINER * pair.sample_rate)


def _parabola(magnitude: Real, middle: int) -> Real:
    """Places of the highest of each row about its middle, in steps."""
    rows, top = np.arange(len(magnitude)), magnitude[:, 1:-1].argmax(axis=1) + 1
    before, here, after = (magnitude[rows, top + offset] for offset in (-1, 0, 1))
    place: Real = top - middle + 0.5 * (before - after) / (before - 2 * here + after)
    return place


def scikit_image(pair: EchoPair, normalization: str | None) -> Real:
    """`phase_cross_correlation` of each record, a hundredth of a sample fine [s]."""
    from skimage.registration import phase_cross_correlation

    shifts = [
        phase_cross_correlation(secondary, primary, upsample_factor=100, normalization=normalization)[0][0]
        for primary, secondary in zip(pair.primary, pair.secondary, strict=True)
    ]
    return np.array(shifts) / pair.sample_rate


def with_phase(pair: EchoPair, delay: Real) -> Real:
    """The delay nearest to one that the phase of the correlation there allows [s]."""
    frequencies = scipy.fft.fftfreq(pair.shape[1], 1 / pair.sample_rate)
    cross = scipy.fft.fft(pair.primary, axis=-1).conj() * scipy.fft.fft(pair.secondary, axis=-1)
    product = np.sum(cross * np.exp(2j * np.pi * frequencies * delay[:, None]), axis=-1)
    wraps = np.angle(product) / (2 * np.pi) + pair.centre_frequency * delay
    refined: Real = delay + (np.rint(wraps) - wraps) / pair.centre_frequency
    return refined


def lag_products(primary: Complex, secondary: Complex, lags: NDArray[np.int64]) -> Complex:
    """`p*(t - tau/2) s(t + tau/2)` at every pixel and half the lags as delays [samples], shape (lag, time)."""
    margin = int(np.abs(lags).max()) // 4 + 1
    before, after = (extended(upsampled(series[None], 4), margin) for series in (primary.conj(), secondary))
    products: Complex = np.concatenate([lag_product(before, after, int(lag)) for lag in lags])
    return products


def of_matrix(primary: Complex, secondary: Complex, times: Sequence[int], lags: NDArray[np.int64]) -> Complex:
    """The same by the matrix of paper A at some pixels, shape (lag, time)."""
    return family(primary, secondary, everything, lags / 2, times)


def direct_lag_products(primary: Complex, secondary: Complex, times: Sequence[int], lags: NDArray[np.int64]) -> Complex:
    """The same by the Fourier series of both, term by term in long doubles."""

    def at(series: Complex, when: Real) -> NDArray[np.clongdouble]:
        n = series.size
        harmonics = np.arange(-(n // 2), n // 2 + 1)
        turn = np.exp(-2j * np.longdouble(np.pi) * (np.outer(harmonics, np.arange(n)) % n) / n)
        weights = np.where(2 * np.abs(harmonics) == n, 0.5, 1.0)
        coefficients = weights * (turn * series).sum(axis=1) / n
        phase = 2j * np.longdouble(np.pi) * when[..., None].astype(np.longdouble) * harmonics / n
        value: NDArray[np.clongdouble] = (coefficients * np.exp(phase)).sum(axis=-1)
        return value

    when, half = np.asarray(times, dtype=float), lags[:, None] / 4
    return (at(primary, when - half).conj() * at(secondary, when + half)).astype(np.complex128)


def scatterers(sonar: Sonar, samples: int, count: int, rng: np.random.Generator) -> tuple[Band, Real, Complex]:
    """A band on a grid, and times [s] and strengths of scatterers anywhere in it."""
    band = Band(TimeGrid(samples, 4 / 3 * sonar.bandwidth), sonar.bandwidth)
    strengths = rng.normal(size=count) + 1j * rng.normal(size=count)
    return band, np.sort(rng.uniform(0, band.grid.period, count)), strengths


def our_echoes(band: Band, times: Real, strengths: Complex, accuracy: float) -> Complex:
    """Series of their echoes by a non-uniform FFT."""
    series: Complex = band.series(echo_spectrum(band, times, strengths[None], accuracy))[0]
    return series


def gridded_echoes(band: Band, times: Real, strengths: Complex) -> Complex:
    """Every scatterer at the nearest of sixteen instants a sample, and an FFT."""
    fine = FINER * band.grid.samples
    place = np.rint(times * band.grid.sample_rate * FINER).astype(np.int64) % fine
    comb = np.bincount(place, strengths.real, fine) + 1j * np.bincount(place, strengths.imag, fine)
    spectrum = scipy.fft.fft(comb, overwrite_x=True)[band.harmonics]
    return band.series(spectrum * np.sqrt(band.weights) / band.weights.sum())


def direct_echoes(band: Band, times: Real, strengths: Complex) -> Complex:
    """Echo by echo in every Fourier bin."""
    spectrum = np.empty(band.harmonics.size, dtype=np.complex128)
    for part in np.array_split(np.arange(spectrum.size), 16):
        turn = np.exp(-2j * np.pi * np.outer(band.frequencies[part], times - band.grid.start))
        spectrum[part] = turn @ strengths
    return band.series(spectrum * np.sqrt(band.weights) / band.weights.sum())
