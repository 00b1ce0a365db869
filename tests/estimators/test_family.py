"""Every fast method against its mask of paper A's frequential cross-correlation matrix."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from estimators import FixedWindow, Interferogram, MultiChromatic, SplitSpectrum
from estimators.interference import interferogram
from estimators.lag_product import extended, lag_product, lag_series, upsampled
from estimators.matrix import band, everything, family, window
from estimators.sub_bands import band_pass, band_share
from sim import EchoPair

SAMPLES = st.integers(2, 24)
SEED = st.integers(0, 2**32 - 1)
few = settings(max_examples=25, deadline=None)


def series_of(samples, seed):
    rng = np.random.default_rng(seed)
    return rng.normal(size=(2, samples)) + 1j * rng.normal(size=(2, samples))


def agree(found, matrix):
    np.testing.assert_allclose(np.broadcast_to(found, matrix.shape), matrix, rtol=0, atol=1e-10 * np.abs(matrix).max())


def band_passed(series, centre, width):
    """By frequency in bins, as if the sample rate were the number of samples."""
    samples = len(series)
    return band_pass(series[None], band_share(np.fft.fftfreq(samples, 1 / samples), centre, width))


@st.composite
def windows(draw):
    samples = draw(SAMPLES)
    return samples, draw(st.integers(1, samples))


@st.composite
def sub_bands(draw):
    samples = draw(st.integers(4, 24))
    width = draw(st.floats(1.0, samples / 2))
    centre = draw(st.floats(-(samples - width) / 2, (samples - width) / 2))
    return samples, draw(st.integers(1, samples)), centre, width


@few
@given(SAMPLES, SEED)
def test_zero_lag_interferogram_is_the_whole_matrix(samples, seed):
    primary, secondary = series_of(samples, seed)
    found, _ = interferogram(primary[None], secondary[None], 1, 1, circular=True)
    agree(found[0], family(primary, secondary, everything))


@few
@given(SAMPLES, st.integers(1, 6), st.integers(-12, 12), SEED)
def test_full_band_phase_slope_is_the_whole_matrix_against_a_slope(samples, factor, lag, seed):
    primary, secondary = series_of(samples, seed)
    planes = (extended(upsampled(series[None], factor), 12) for series in (primary.conj(), secondary))
    agree(lag_product(*planes, lag)[0], family(primary, secondary, everything, 2 * lag / factor))


@few
@given(windows(), st.integers(1, 4), SEED)
def test_windowed_cross_correlation_is_a_mask_in_the_difference_of_frequencies(sizes, factor, seed):
    samples, length = sizes
    primary, secondary = series_of(samples, seed)
    stack = lag_series(primary[None], secondary[None], FixedWindow(1, length), factor, 3, 1.0).stack()
    for lag, product in zip(range(-3, 4), stack.products, strict=True):
        agree(product[0], family(primary, secondary, window(length), lag * stack.step))


@few
@given(sub_bands(), SEED)
def test_sub_band_interferogram_is_a_block_on_the_diagonal(sizes, seed):
    samples, length, centre, width = sizes
    primary, secondary = series_of(samples, seed)
    low, high = (band_passed(series, centre, width) for series in (primary, secondary))
    found = FixedWindow(1, length).sum(low.conj() * high)[0]

    def block(n, m, samples):
        return window(length)(n, m, samples) * band(centre, width)(n, m, samples)

    matrix = family(primary, secondary, block)
    np.testing.assert_allclose(np.broadcast_to(found, matrix.shape), matrix, rtol=0, atol=1e-10)


@few
@given(windows(), SEED)
def test_interferogram_reports_the_phase_of_its_mask(sizes, seed):
    samples, length = sizes
    primary, secondary = series_of(samples, seed)
    pair = EchoPair(primary, secondary, 1.0, 2.0, 1.0, circular=True)
    matrix = family(primary, secondary, window(length))
    estimate = Interferogram(FixedWindow(1, length)).estimate(pair)
    agree(np.abs(matrix) * np.exp(-1j * estimate.phase[0]), matrix)


@few
@given(st.integers(6, 24), SEED)
def test_split_spectrum_reports_the_slope_between_its_blocks(samples, seed):
    primary, secondary = series_of(samples, seed)
    pair = EchoPair(primary, secondary, 1.0, 2.0, 1.0, circular=True)
    low, high = (
        family(primary, secondary, lambda *nm, c=centre: window(5)(*nm) * band(c, samples / 3)(*nm))
        for centre in (-samples / 3, samples / 3)
    )
    turn = high * low.conj()
    estimate = SplitSpectrum(FixedWindow(1, 5), refine=False).estimate(pair)
    apart = middle_of(samples / 3, samples / 3, samples) - middle_of(-samples / 3, samples / 3, samples)
    agree(np.abs(turn) * np.exp(-2j * np.pi * apart / samples * estimate.delay[0]), turn)


def middle_of(centre, width, samples):
    """Where the bins that a band holds have their middle: the Nyquist bin, which is left out, may move it."""
    bins = np.arange(-samples, samples + 1)
    return np.average(bins, weights=np.diag(band(centre, width)(bins[:, None], bins[None], samples)))


@few
@given(st.integers(9, 24), st.integers(2, 4), SEED)
def test_multi_chromatic_reports_the_line_through_its_blocks(samples, bands, seed):
    primary, secondary = series_of(samples, seed)
    # No edge of a sub-band on one of a bin, where rounding leaves a share whose square root is 1e-8.
    pair = EchoPair(primary, secondary, 1.0, 2.0, 0.97, circular=True)
    width = 0.97 * samples / bands
    centres = width * (np.arange(bands) - (bands - 1) / 2)
    masks = [lambda n, m, k, c=c: window(5)(n, m, k) * band(c, width)(n, m, k) for c in centres]
    blocks = np.array([family(primary, secondary, mask) for mask in masks])
    # How they turn with the delay.
    turns = np.array(
        [family(primary, secondary, lambda n, m, k, f=f: 1j * np.pi * (n + m) / k * f(n, m, k)) for f in masks]
    )
    frequencies = np.array([middle_of(centre, width, samples) for centre in centres]) / samples
    found = MultiChromatic(FixedWindow(1, 5), bands, refine=False).estimate(pair).delay[0]
    spacing = np.diff(frequencies).mean()
    grid = np.arange(-2 * bands, 2 * bands + 1) / (4 * bands + 1) / spacing
    for products, rates, delay in zip(blocks.T, (turns / blocks).imag.T, found, strict=True):
        line = grid[np.argmax(np.abs(np.exp(2j * np.pi * np.outer(grid, spacing * np.arange(bands))) @ products))]
        for _ in range(2):
            carried = products * np.exp(1j * rates * line)
            phases = np.angle(carried * carried.sum().conj())
            line -= np.polyfit(frequencies, phases, 1, w=np.sqrt(np.abs(products)))[0] / (2 * np.pi)
        # A block of next to nothing turns at a rate that rounding makes.
        worst = np.abs(blocks).max() / np.abs(products).min()
        np.testing.assert_allclose(delay, line, rtol=0, atol=1e-10 * samples * worst)
