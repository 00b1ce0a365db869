"""From a pair to delays: the steps that all methods share."""

from collections.abc import Callable

import numpy as np
import scipy.fft

from estimators import bounds
from estimators.estimate import DelayEstimate
from estimators.lag_product import LagSeries, LagStack, lag_series, power, scale_of
from estimators.peak import Index, Peak, moved_to, peak_at
from estimators.peak_kernels import STENCIL
from estimators.uncertainty import WrapErrors, debiased_coherence, predicted_std, predicted_wrap_errors
from estimators.varying_stack import varying_lag_stack
from estimators.windows import FixedWindow, Window
from sim import EchoPair, checks
from sim.band import Complex, Real

BLOCK_BYTES = 2**27
"""Size that the lag products of one block of rows may take."""

CACHE_BYTES = 2**23
"""Size that the lag products at the times searched together may take."""


def search_range(pair: EchoPair, search: float | None, resolutions: float) -> float:
    """Largest delay to look for [s]: as given, or so many times `1 / B`, within half the record.

    Raises
    ------
    ValueError
        For a range of 0 or less, or beyond half the record.
    """
    half_record = pair.grid.period / 2
    if search is None:
        return min(resolutions / pair.bandwidth, half_record)
    if checks.positive("search", search, "s") > half_record:
        raise ValueError(f"search is {search:g} s; it must not exceed half the record, {half_record:g} s")
    return search


def search_peaks(
    pair: EchoPair,
    window: Window,
    search: float,
    lags_per_resolution: int,
    pick: Callable[[Real], Index],
    refine: bool,
) -> Peak:
    """Peak of the magnitude of the windowed lag product at every pixel.

    With refinement the product is read again at the delay that the phase of the peak allows: the phase at the peak of
    the magnitude still moves with the error of that peak where the speckle's spectrum is off centre.

    Parameters
    ----------
    pair, window
        The echoes, and what to average over.
    search
        Largest delay [s].
    lags_per_resolution
        Lags in `1 / B`, at least 4.
    pick
        Chooses a lag from the squared magnitudes within the search range, shape (lag, rows, time).
    refine
        Whether the peak is moved to the nearest delay that its phase allows.
    """

    def find(stack: LagStack, margin: int) -> Peak:
        peak = peak_at(stack, pick(power(stack.products[margin:-margin])) + margin)
        return moved_to(peak, stack, refined_delay(peak, pair.centre_frequency)) if refine else peak

    return over_lags(pair, window, search, lags_per_resolution, 0.5, find)


def over_lags(
    pair: EchoPair,
    window: Window,
    search: float,
    lags_per_resolution: int,
    wraps_beyond: float,
    find: Callable[..., Peak],
    *beside: Real,
) -> Peak:
    """Apply a method to the windowed lag products of every pixel.

    Parameters
    ----------
    pair, window, search, lags_per_resolution
        As in `search_peaks`.
    wraps_beyond
        How far beyond the search range the method reads the lag products, in wraps.
    find
        The method. It is given the lag products and how many lags at either end lie beyond the search range: the
        wraps it asked for, and `STENCIL` more for the interpolation; then the rows of what lies beside.
    beside
        Arrays of the pair's shape of which the method needs the same rows.
    """
    factor = int(np.ceil(2 * lags_per_resolution * pair.bandwidth / pair.sample_rate))
    lags_per_second = factor * pair.sample_rate / 2
    margin = STENCIL + int(np.ceil(wraps_beyond / pair.centre_frequency * lags_per_second))
    reach = max(int(np.ceil(search * lags_per_second)), 1) + margin

    def peaks(primary: Complex, secondary: Complex, *rows: Real) -> Peak:
        steps = factor, reach, pair.sample_rate
        if isinstance(window, FixedWindow):
            series = lag_series(primary, secondary, window, *steps)
            return over_times(series, lambda stack, *part: find(stack, margin, *part), *rows)
        return find(varying_lag_stack(primary, secondary, window, *steps), margin, *rows)

    bytes_per_sample = 40 * (2 * reach + 1) + 48 * factor
    return by_rows(pair, window, int(np.ceil(2 * reach / factor)), bytes_per_sample, peaks, *beside)


def over_times(series: LagSeries, find: Callable[..., Peak], *beside: Real) -> Peak:
    """Apply a method to stacks of so many times that they stay in the cache, with what lies beside at these times."""
    if series.times == 1:
        return find(series.stack(), *beside)
    samples = series.window.samples
    # Whole windows, so that moving sums group the same samples in any stack.
    times = max(1, CACHE_BYTES // (24 * (2 * series.reach + 1) * series.primary.values.shape[1] * samples)) * samples
    starts = range(0, series.times, times)
    found = [find(series.stack(at, at + times), *(array[:, at : at + times] for array in beside)) for at in starts]
    return Peak(*(np.concatenate(parts, axis=1) for parts in zip(*found, strict=True)))


def read_at(pair: EchoPair, window: Window, delay: Real, lags_per_resolution: int) -> Peak:
    """Windowed lag product at a given delay of every pixel [s], within half the record."""

    def read(stack: LagStack, _: int, near: Real) -> Peak:
        unread = Peak(near, stack.products[0], stack.energies[0], np.ones((), dtype=np.bool_))
        return moved_to(unread, stack, near).spread()

    return over_lags(pair, window, float(np.abs(delay).max()), lags_per_resolution, 0.0, read, delay)


def by_rows(
    pair: EchoPair,
    window: Window,
    lag_samples: int,
    bytes_per_sample: int,
    peaks: Callable[..., Peak],
    *beside: Real,
) -> Peak:
    """Apply a method to blocks of rows, with as many rows around each as the window needs.

    The method sees series of double precision, scaled by a power of two towards 1, and periodic: one that is not is
    continued by zeros for `lag_samples` and the window. It sees the same rows of the arrays beside, continued likewise.
    """
    window.check(pair)
    rows, samples = pair.shape
    most_rows, most_samples = window.extent
    scales = [scale_of(series) for series in (pair.primary, pair.secondary)]
    # A few more zeros make a length that is fast to transform.
    padding = 0 if pair.circular else scipy.fft.next_fast_len(samples + lag_samples + most_samples) - samples
    # Whole windows of rows, so that moving sums group the same rows whatever the block.
    block = max(1, BLOCK_BYTES // (bytes_per_sample * (samples + padding) * most_rows)) * most_rows
    found = []
    for start in range(0, rows, block):
        stop = min(start + block, rows)
        first, last = max(start - most_rows, 0), min(stop + most_rows, rows)
        primary, secondary = (
            np.pad(series[first:last].astype(np.complex128) * scale, ((0, 0), (0, padding)))
            for series, scale in zip((pair.primary, pair.secondary), scales, strict=True)
        )
        others = (np.pad(array[first:last], ((0, 0), (0, padding))) for array in beside)
        inner = slice(start - first, stop - first)
        found.append([array[inner, :samples] for array in peaks(primary, secondary, *others)])
    return Peak(*(np.concatenate(parts) for parts in zip(*found, strict=True)))


def refined_delay(peak: Peak, centre_frequency: float) -> Real:
    """The delay nearest to a peak that its phase allows.

    With the peak at `tau` and the absolute phase `phi = -arg C`: `tau + wrap(phi - 2 pi fc tau) / (2 pi fc)`.
    """
    wraps = np.angle(peak.product) / (2 * np.pi) + centre_frequency * peak.delay
    delay: Real = peak.delay + (np.rint(wraps) - wraps) / centre_frequency
    return delay


def describe(
    pair: EchoPair,
    window: Window,
    peak: Peak,
    *,
    refine: bool,
    search: float,
    wrap_errors: WrapErrors = bounds.wrap_error_probability,
    wrong: Callable[[Real, Real], Real] | None = None,
) -> DelayEstimate:
    """Turn peaks into estimates: residual phase, coherence, uncertainty, validity.

    Parameters
    ----------
    pair, window
        The echoes, and what was averaged over.
    peak
        The peaks found, on any scale.
    refine
        Whether the residual phase refines the delay.
    search
        Largest delay that was looked for [s].
    wrap_errors
        Predicts the wrap errors of the method.
    wrong
        Gives their probability from debiased coherence and phase instead.
    """
    magnitude = np.abs(peak.product)
    has_echo = peak.energy > 0
    coherence = np.minimum(np.divide(magnitude, peak.energy, out=np.zeros_like(magnitude), where=has_echo), 1.0)
    looks = window.looks(pair)
    debiased = debiased_coherence(coherence, looks)
    bound = (
        bounds.coherent_delay_crlb(looks, debiased, pair.centre_frequency, pair.bandwidth)
        if refine
        else bounds.group_delay_crlb(looks, debiased, pair.bandwidth)
    )
    energy = peak.energy / window.pixels
    brightness = np.divide(energy, energy + energy.mean(), out=np.zeros_like(magnitude), where=has_echo)
    phase = np.pi - np.mod(np.angle(peak.product) + np.pi, 2 * np.pi)
    ratio, wraps = pair.bandwidth / pair.centre_frequency, search * pair.centre_frequency
    probability = (
        predicted_wrap_errors(wrap_errors, debiased, looks, ratio, wraps) if wrong is None else wrong(debiased, phase)
    )
    return DelayEstimate(
        *(
            np.broadcast_to(array, pair.shape)
            for array in (
                refined_delay(peak, pair.centre_frequency) if refine else peak.delay,
                phase,
                coherence,
                predicted_std(bound, search),
                probability,
                coherence * brightness,
                window.inside(pair) & peak.inside & has_echo,
            )
        )
    )
