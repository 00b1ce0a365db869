"""How likely a delay lies in a wrong wrap, given the correlation at the rival wraps."""

import math
from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from estimators.lag_product import LagStack
from estimators.peak_kernels import STENCIL, read_energies, read_products
from estimators.posterior import Looks
from sim.band import Complex, Real
from sim.compiled import compiled

Times = NDArray[np.intp]
Stack = tuple[Complex, Real, int]

NODES = 513
"""Coherences at which the share of a wrap is tabulated, evenly from 0 to 1."""

CARE = 1e-2
"""Part of the odds that a rival may add without being read with care."""

PIXELS = 256
"""Rivals that are read together."""


class Model(NamedTuple):
    """What tells wraps apart: carrier, search range, and looks with the masses they give.

    Attributes
    ----------
    turns_a_lag
        Of the carrier.
    search
        Largest delay [lags].
    looks, tables
        Distinct looks, and log of the masses of peaks over coherence for each of them.
    which
        Those of each time.
    """

    turns_a_lag: float
    search: float
    looks: Real
    which: Times
    tables: Real


def wrap_doubt(
    stack: LagStack, delay: Real, looks: Looks, centre_frequency: float, search: float, height: Real | None = None
) -> Real:
    """Probability that a delay is in a wrong wrap, given the windowed lag products about it.

    The wraps `m / fc` from it within the search range compete. With the height `c_m` of the passband correlation's peak
    in each, its share of the likelihood is

        M(c) = [1 + 2F1(N - 1, 1/2; 1; c^2)] / 2
             = 1/2 + (1 - c^2)^(3/2 - N) / (2 pi) int_0^pi (1 - c^2 sin^2 a)^(N - 2) da,

    the mean of `(1 - c^2 cos^2)^-(N - 1)` over the half of a wrap where the cosine is positive, and of 1 over the
    other; at the ends of the range, times the part of the wrap that is within. That is the likelihood of a delay of
    circular Gaussian series, their scales and their coherence integrated out: that of gamma, which goes as
    `(1 - gamma^2)^N (1 - gamma c)^(1/2 - 2N)`, with a flat `atanh(gamma)`, by Laplace's method about `gamma = c`.
    As the wraps are taken to be periods of the carrier, it is within .1 of the integral at 5 looks, and within .005 at
    half of all records.

    The prior is flat in the delay over the range too. So what it says is right over scenes of many coherences, and not
    at each: of a high one, which the window does not know of itself, it says too much.

    Parameters
    ----------
    stack
        Lag products, `STENCIL` lags longer than the search range on either side.
    delay
        What an estimator found [s]; broadcasts to (rows, time).
    looks
        Equivalent independent looks in the window, a number or one for each time. Of a single one all wraps are alike.
    centre_frequency
        `fc` [Hz].
    search
        Largest delay that may be the true one [s].
    height
        Normalised height at the delay where that is a peak of the passband correlation; broadcasts likewise. It is read
        at the nearest such peak if None.

    Returns
    -------
    array
        Shape (rows, time).
    """
    shape = np.broadcast_shapes(stack.products.shape[1:], np.shape(delay))
    guess = max(1 - 1 / (2 * search * centre_frequency), 0.0)
    if np.max(looks) <= 1:
        return np.full(shape, guess)
    distinct, which = _looks_at(looks, shape[1])
    tables = np.stack([_mass_table(float(n)) for n in distinct])
    found: Real = _doubts(
        np.broadcast_to(stack.products, (len(stack.products), *shape)),
        np.broadcast_to(stack.energies, (len(stack.energies), *shape)),
        np.ascontiguousarray(np.broadcast_to(delay, shape)) / stack.step,
        None if height is None else np.ascontiguousarray(np.broadcast_to(height, shape)),
        Model(centre_frequency * stack.step, search / stack.step, distinct, which, tables),
    )
    return np.where(distinct[which] <= 1, guess, found)


def sub_band_doubt(low: Complex, high: Complex, energy: Real, delay: Real, spacing: float, looks: Looks) -> Real:
    """The same from two sub-bands alone, in the range where their phase difference is unambiguous.

    With the interferograms `I` of sub-bands `df` apart the heights are `|I_low + I_high exp(2 pi i df tau)| / E`.

    Parameters
    ----------
    low, high
        Windowed interferograms of the sub-bands, shape (rows, time).
    energy
        `E`, the largest possible magnitude of their sum, same shape.
    delay
        The one that is doubted [wraps], as the phase of the whole band allows it, same shape.
    spacing
        `df / fc`.
    looks
        Equivalent independent looks of both sub-bands together, a number or one for each time.
    """
    search = 0.5 / spacing
    most = int(np.ceil(2 * search)) + 1
    # The delay's own wrap first.
    wraps = np.concatenate([[0], np.arange(1, most + 1), np.arange(-most, 0)])
    distinct, which = _looks_at(looks, low.shape[1])
    tables = np.stack([_mass_table(float(n)) for n in distinct])
    found: Real = _sub_band_doubts(low, high, energy, delay, wraps, spacing, search, distinct, which, tables)
    return found


def _looks_at(looks: Looks, times: int) -> tuple[Real, NDArray[np.intp]]:
    """Distinct looks, and which of them stands at each time; a record that is not periodic has been continued."""
    if np.ndim(looks) == 0:
        return np.array([looks]), np.zeros(times, dtype=np.intp)
    return np.unique(np.resize(looks, times), return_inverse=True)


@lru_cache(maxsize=256)
def _mass_table(looks: float) -> Real:
    """Log of `1/pi int_0^pi (1 - c^2 sin^2 a)^(N - 2) da` at `NODES` even steps of c; about `-log(pi N) / 2` at 1."""
    # Even steps over a period: exact for the polynomials that these are nearly.
    count = 64 + 16 * int(np.sqrt(looks))
    sine = np.sin(np.pi * (np.arange(count) + 0.5) / count)
    kept = 1 - (np.linspace(0, 1, NODES)[:, None] * sine) ** 2
    table: Real = np.log(np.mean(kept ** (looks - 2.0), axis=1))
    return table


@compiled
def _peak_mass(height: float, looks: Real, tables: Real, at: int) -> float:
    """Log of what the half of a wrap where the cosine is positive adds to twice M, that of the other half being 0."""
    place = height * (NODES - 1)
    node = min(int(place), NODES - 2)
    log_mean = tables[at, node] + (place - node) * (tables[at, node + 1] - tables[at, node])
    return float(log_mean - (looks[at] - 1.5) * math.log(1 - min(height * height, 1 - 1e-15)))


@compiled
def _log_share(height: float, looks: Real, tables: Real, at: int) -> float:
    """Log of twice M."""
    log_peak = _peak_mass(height, looks, tables, at)
    return float(max(log_peak, 0.0) + math.log1p(math.exp(-abs(log_peak))))


@compiled
def _turns(imag: float, real: float) -> float:
    """Phase in turns, to 2e-6 (Abramowitz and Stegun 1964, 4.4.49, which several of can be found at once)."""
    x, y = abs(real), abs(imag)
    ratio = min(x, y) / max(x, y, 1e-300)
    square = ratio * ratio
    series = 0.9998660 + square * (-0.3302995 + square * (0.1801410 + square * (-0.0851330 + square * 0.0208351)))
    turns = ratio * series * (0.5 / np.pi)
    turns = 0.25 - turns if y > x else turns
    turns = 0.5 - turns if real < 0 else turns
    return -turns if imag < 0 else turns


@compiled
def _heights(products: Complex, energies: Real, row: int, times: Times, lags: Real, turns_a_lag: float) -> tuple[Real, Real]:
    """Lags and normalised heights of the passband peaks next to lags: there the product has the phase of the carrier.

    That phase is read at the nearest whole lag, the height by the polynomial at the place it points to.
    """
    reach, wrap = len(products) // 2, 1 / turns_a_lag
    most = reach - STENCIL - 0.5
    index, share = np.empty(len(lags), np.intp), np.empty(len(lags))
    product, energy = np.empty(len(lags), np.complex128), np.empty(len(lags))
    # One thing at a time, so that a loop does it to several pixels at once.
    for i in range(len(lags)):
        index[i] = np.int32(math.floor(min(max(lags[i], -most), most) + 0.5)) + reach
    for i in range(len(lags)):
        product[i] = products[index[i], row, times[i]]
    for i in range(len(lags)):
        whole = float(index[i] - reach)
        turns = _turns(product[i].imag, product[i].real) + turns_a_lag * whole
        lag = min(max(lags[i], -most), most)
        lag = whole + (math.floor((lag - whole) * turns_a_lag + turns + 0.5) - turns) * wrap
        lag = min(max(lag, -most), most)
        whole = math.floor(lag + 0.5)
        index[i], share[i] = np.int32(whole) + reach, lag - whole
    read_products(products, row, times, index, share, product)
    read_energies(energies, row, times, index, share, energy)
    for i in range(len(lags)):
        magnitude = math.sqrt(product[i].real * product[i].real + product[i].imag * product[i].imag)
        energy[i] = min(magnitude / energy[i], 1.0) if energy[i] > 0 else 0.0
    return index - reach + share, energy


@compiled
def _may_exceed(products: Complex, energies: Real, row: int, time: int, lag: float, least: float) -> bool:
    """Whether the squared height next to a lag may exceed `least`, by a straight line between the two lags around it.

    Between lags a series of at least four samples in `1 / B` is higher by 8 % at the most, `1 / cos(pi / 8)`.
    """
    place = min(max(math.floor(lag) + len(products) // 2, 0), len(products) - 2)
    before, after, energy = products[place, row, time], products[place + 1, row, time], energies[place, row, time]
    share = lag + len(products) // 2 - place
    line = (1 - share) * (before.real * before.real + before.imag * before.imag)
    line += share * (after.real * after.real + after.imag * after.imag)
    return bool(1.18 * line > least * energy * energy)


@compiled
def _doubts(products: Complex, energies: Real, delays: Real, heights: Real | None, model: Model) -> Real:
    """Delays in lags."""
    found = np.empty(delays.shape)
    for row in range(delays.shape[0]):
        stack = products, energies, row
        for begin in range(0, delays.shape[1], PIXELS):
            times = np.arange(begin, min(begin + PIXELS, delays.shape[1]))
            lags = delays[row, begin : begin + PIXELS]
            if heights is None:
                peaks, height = _heights(*stack, times, lags, model.turns_a_lag)
            else:
                peaks, height = lags, heights[row, begin : begin + PIXELS]
            found[row, begin : begin + PIXELS] = _doubts_at(stack, times, lags, peaks, height, model)
    return found


@compiled
def _doubts_at(stack: Stack, times: Times, delays: Real, peaks: Real, heights: Real, model: Model) -> Real:
    """Rivals are asked from the nearest on, and with care only where they may add `CARE` of what those have."""
    turns_a_lag, search, looks, which, tables = model
    masses, odds, least = np.empty(len(delays)), np.empty(len(delays)), np.empty(len(delays))
    for i in range(len(delays)):
        masses[i] = _peak_mass(heights[i], looks, tables, which[times[i]])
        # All rivals have the share of no correlation; those that correlate add to it.
        others = max(2 * search * turns_a_lag - _part(delays[i], search, turns_a_lag), 0.0)
        odds[i] = others * math.exp(-masses[i])
    pixels, wrap = np.arange(len(delays)), 1 / turns_a_lag
    steps = np.empty(len(delays))
    for side in (-1, 1):
        steps[:] = side * wrap
        _add(stack, times, pixels, steps, delays, peaks, masses, model, odds)
    for i in range(len(delays)):
        power = looks[which[times[i]]] - 1.5
        log_odds = math.log(CARE * odds[i] + 1e-300) + masses[i]
        least[i] = 1 - math.exp(min(-log_odds / power, 0.0)) if power > 0 else -1.0
    count = 0
    for i in np.flatnonzero(_rise(stack, times, peaks, least, 1.5 * wrap) > 0):
        most = math.floor((search + abs(delays[i])) * turns_a_lag + 0.5)
        for away in range(2, int(most) + 1):
            for step in (-away * wrap, away * wrap):
                within = _part(delays[i] + step, search, turns_a_lag) > 0
                if within and _may_exceed(*stack, times[i], peaks[i] + step, least[i]):
                    pixels[count], steps[count] = i, step
                    count += 1
                    if count == len(steps):
                        _add(stack, times, pixels, steps, delays, peaks, masses, model, odds)
                        count = 0
    _add(stack, times, pixels[:count], steps[:count], delays, peaks, masses, model, odds)
    for i in range(len(delays)):
        odds[i] /= odds[i] + 1 + math.exp(-masses[i])
    return odds


@compiled
def _rise(stack: Stack, times: Times, delays: Real, least: Real, away: float) -> Real:
    products, energies, row = stack
    highest = np.full(len(delays), -1.0)
    reach = len(products) // 2
    begin, end = times[0], times[0] + len(times)
    for lag in range(-reach, reach + 1):
        product, energy = products[lag + reach, row, begin:end], energies[lag + reach, row, begin:end]
        for i in range(len(delays)):
            power = product[i].real * product[i].real + product[i].imag * product[i].imag
            rise = 1.18 * power - least[i] * energy[i] * energy[i]
            rise = rise if abs(lag - delays[i]) > away else -1.0
            highest[i] = max(highest[i], rise)
    return highest


@compiled
def _add(
    stack: Stack,
    times: Times,
    pixels: Times,
    steps: Real,
    delays: Real,
    peaks: Real,
    masses: Real,
    model: Model,
    odds: Real,
) -> None:
    """To the odds of some pixels what the rivals so many lags away have where they correlate."""
    turns_a_lag, search, looks, which, tables = model
    _, heights = _heights(*stack, times[pixels], peaks[pixels] + steps, turns_a_lag)
    for k in range(len(pixels)):
        i = pixels[k]
        mass = _peak_mass(heights[k], looks, tables, which[times[i]])
        part = max(_part(delays[i] + steps[k], search, turns_a_lag), 0.0)
        odds[i] += part * math.exp(min(mass - masses[i], 700.0))


@compiled
def _part(lag: float, search: float, turns_a_lag: float) -> float:
    """Of the wrap about a lag, how much is within the range; not above 0 where none is."""
    return min((search - abs(lag)) * turns_a_lag + 0.5, 1.0)


@compiled
def _sub_band_doubts(
    low: Any,
    high: Any,
    energies: Any,
    delays: Any,
    wraps: Any,
    spacing: float,
    search: float,
    looks: Any,
    which: Any,
    tables: Any,
) -> Any:
    found = np.empty(delays.shape)
    for row in range(delays.shape[0]):
        for time in range(delays.shape[1]):
            delay = delays[row, time]
            energy = energies[row, time] if energies[row, time] > 0 else np.inf
            first, second = low[row, time], high[row, time]
            here, odds = 0.0, 0.0
            for m in wraps:
                share = min(search - abs(delay + m) + 0.5, 1.0)
                if m == 0 or share > 0:
                    height = abs(first + second * np.exp(2j * np.pi * spacing * (delay + m))) / energy
                    there = _log_share(min(height, 1.0), looks, tables, which[time])
                    if m == 0:
                        here = there
                    else:
                        odds += share * np.exp(min(there - here, 700.0))
            found[row, time] = odds / (1 + odds)
    return found
