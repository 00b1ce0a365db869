"""From a pair to delays: the steps that all methods share."""

from collections.abc import Callable

import numpy as np
import scipy.fft

from estimators.estimate import DelayEstimate
from estimators.height import Height
from estimators.lag_product import LagSeries, LagStack, lag_series, resolved, scale_of
from estimators.peak import Index, Peak, moved_to, peak_at
from estimators.peak_kernels import STENCIL
from estimators.posterior import delay_std
from estimators.uncertainty import debiased_coherence, predicted_std
from estimators.varying_stack import varying_lag_stack
from estimators.windows import FixedWindow, Window
from estimators.wrap_doubt import wrap_doubt
from sim import EchoPair, checks
from sim.band import Complex, Real

FAINTEST = 1e-150
"""Energy beside that of the brightest, near 1, of which estimates still make squares; of less they know nothing."""

BLOCK_BYTES = 2**27
"""Size that one block of rows may take, with its lag products."""

NEAR_BYTES = 2**24
"""Size of a block that stays in the cache, if eight windows' rows do: fewer would be small beside those around them."""

CACHE_BYTES = 3 * 2**22
"""Size that the lag products at the times searched together may take."""

FEW_WINDOWS, FEW_BYTES = 4, 3 * 2**23
"""Windows that are searched together even so, and the size up to which: one more is computed around them, so that of
fewer time would grow faster than lags."""

LEAST_PIXELS = 1024
"""Pixels that are searched together even so, beside which the call of a compiled function counts little."""


def search_range(pair: EchoPair, search: float | Height | None, resolutions: float) -> float:
    """Largest delay to look for [s]: as given, in delay or height, or so many times `1 / B`, within half the record.

    Raises
    ------
    ValueError
        For a range of 0 or less, or beyond half the record, and for a height of a pair that has none.
    """
    half_record = pair.grid.period / 2
    if search is None:
        return min(resolutions / pair.bandwidth, half_record)
    if isinstance(search, Height):
        search = search.delay(pair)
    if checks.positive("search", search, "s") > half_record:
        raise ValueError(f"search is {search:g} s; it must not exceed half the record, {half_record:g} s")
    return search


def search_peaks(
    pair: EchoPair,
    window: Window,
    search: float,
    lags_per_resolution: int,
    pick: Callable[..., Index],
    refine: bool,
    *starts: Real,
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
        Chooses a lag from the lag products within the search range, shape (lag, rows, time), and the lags nearest to
        the `starts`, shape (rows, time).
    refine
        Whether the peak is moved to the nearest delay that its phase allows.
    starts
        Delays [s] of the pair's shape.
    """
    looks = window.looks(pair)

    def find(stack: LagStack, margin: int, *near: Real) -> Peak:
        lags = (np.rint(delay / stack.step).astype(np.intp) + stack.reach - margin for delay in near)
        peak = peak_at(stack, pick(stack.products[margin:-margin], *lags) + margin)
        peak = moved_to(peak, stack, refined_delay(peak, pair.centre_frequency)) if refine else peak
        height = peak.height if refine else None
        return peak._replace(doubt=wrap_doubt(stack, peak.delay, looks, pair.centre_frequency, search, height))

    return over_lags(pair, window, search, lags_per_resolution, 0.5, find, *starts)


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

    # Of a fixed window the lag products of a few windows' times are held at once.
    held = window.samples / pair.shape[1] if isinstance(window, FixedWindow) else 1.0
    bytes_per_sample = int(40 * (2 * reach + 1) * held) + 48 * factor
    return by_rows(pair, window, int(np.ceil(2 * reach / factor)), bytes_per_sample, peaks, *beside)


def over_times(series: LagSeries, find: Callable[..., Peak], *beside: Real) -> Peak:
    """Apply a method to stacks of so many times that they stay in the cache, with what lies beside at these times."""
    if series.times == 1:
        return find(series.stack(), *beside)
    samples = series.window.samples
    pixels = series.primary.values.shape[1] * samples
    size = 24 * (2 * series.reach + 1) * pixels
    # Whole windows, so that moving sums group the same samples in any stack.
    few = min(FEW_WINDOWS, FEW_BYTES // size)
    windows = max(1, few, CACHE_BYTES // size, min(-(-LEAST_PIXELS // pixels), BLOCK_BYTES // 2 // size))
    times = windows * samples
    starts = range(0, series.times, times)
    found = [find(series.stack(at, at + times), *(array[:, at : at + times] for array in beside)) for at in starts]
    return Peak(*(np.concatenate(parts, axis=1) for parts in zip(*found, strict=True)))


def read_at(
    pair: EchoPair,
    window: Window,
    delay: Real,
    lags_per_resolution: int,
    search: float | None = None,
    *,
    refine: bool = False,
) -> Peak:
    """Windowed lag product at a given delay of every pixel [s], within half the record.

    With refinement it is read again at the delay that its phase allows, as in `search_peaks`. Where a search range [s]
    is given, the wraps within it tell how doubtful that of the delay is.
    """
    looks, reach = window.looks(pair), max(float(np.abs(delay).max()), search or 0.0)

    def read(stack: LagStack, _: int, near: Real) -> Peak:
        unread = Peak(near, stack.products[0], stack.energies[0], np.ones((), dtype=np.bool_))
        peak = moved_to(unread, stack, near).spread()
        if refine:
            peak = moved_to(peak, stack, refined_delay(peak, pair.centre_frequency))
        if search is None:
            return peak
        height = peak.height if refine else None
        return peak._replace(doubt=wrap_doubt(stack, peak.delay, looks, pair.centre_frequency, search, height))

    beyond = 0.5 if refine or search is not None else 0.0
    return over_lags(pair, window, reach, lags_per_resolution, beyond, read, delay)


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
    size = bytes_per_sample * (samples + padding) * most_rows
    # Whole windows of rows, so that moving sums group the same rows whatever the block.
    block = max(1, NEAR_BYTES // size, min(8, BLOCK_BYTES // size)) * most_rows
    before, after = (most_rows if most_rows > 1 else 0), most_rows - 1 - most_rows // 2
    found = []
    for start in range(0, rows, block):
        stop = min(start + block, rows)
        first, last = max(start - before, 0), min(stop + after, rows)
        primary, secondary = (
            np.pad(series[first:last].astype(np.complex128) * scale, ((0, 0), (0, padding)))
            for series, scale in zip((pair.primary, pair.secondary), scales, strict=True)
        )
        others = (np.pad(array[first:last], ((0, 0), (0, padding))) for array in beside)
        inner = slice(start - first, stop - first)
        found.append([array[inner, :samples] for array in peaks(primary, secondary, *others)])
    return Peak(*(np.concatenate(parts) for parts in zip(*found, strict=True)))


def refined_delay(peak: Peak, centre_frequency: float, angle: Real | None = None) -> Real:
    """The delay nearest to a peak that its phase allows, given the angle of its product where that is known.

    With the peak at `tau` and the absolute phase `phi = -arg C`: `tau + wrap(phi - 2 pi fc tau) / (2 pi fc)`.
    """
    wraps = (np.angle(peak.product) if angle is None else angle) / (2 * np.pi) + centre_frequency * peak.delay
    delay: Real = peak.delay + (np.rint(wraps) - wraps) / centre_frequency
    return delay


def describe(
    pair: EchoPair,
    window: Window,
    peak: Peak,
    *,
    refine: bool,
    search: float,
    bandwidth: float | None = None,
) -> DelayEstimate:
    """Turn peaks into estimates: residual phase, coherence, uncertainty, validity.

    Parameters
    ----------
    pair, window
        The echoes, and what was averaged over.
    peak
        The peaks found, on the scale of `scale_of` of both series.
    refine
        Whether the residual phase refines the delay.
    search
        Largest delay that was looked for [s].
    bandwidth
        Of the flat band that tells the delay as well as the method does without the phase [Hz]; the pair's where None.
    """
    coherence, angle = peak.height, np.angle(peak.product)
    looks = window.looks(pair)
    relative_bandwidth = (bandwidth or pair.bandwidth) / pair.centre_frequency
    within_wrap = delay_std(coherence, looks, relative_bandwidth, refine=refine) / pair.centre_frequency
    heard = resolved(pair.primary) and resolved(pair.secondary)
    return DelayEstimate(
        *(
            np.broadcast_to(array, pair.shape)
            for array in (
                refined_delay(peak, pair.centre_frequency, angle) if refine else peak.delay,
                np.where(angle == np.pi, angle, -angle),
                coherence,
                debiased_coherence(coherence, looks),
                predicted_std(within_wrap, search),
                peak.doubt,
                1 - peak.doubt,
                window.inside(pair) & peak.inside & (peak.energy > FAINTEST) & heard,
            )
        )
    )
