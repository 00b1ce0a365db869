"""The likelihood of rival wraps, compiled: a few hundred pixels at a time, one thing after the other.

Rivals are read by the polynomial through nine lags, but only those that may matter.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from estimators.peak_kernels import STENCIL, read_energies, read_products
from sim.band import Complex, Real
from sim.compiled import compiled

Times = NDArray[np.intp]
Stack = tuple[Complex, Real, int]
"""Lag products and energies, shape (lag, rows, time), and which row."""

NODES = 513
"""Coherences at which the share of a wrap is tabulated, evenly from 0 to 1."""

CARE = 1e-2
"""Part of the odds of the nearest two rivals that another may have without being asked."""

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


@compiled
def _peak_mass(height: float, looks: Real, tables: Real, at: int) -> float:
    """Log of what the half of a wrap where the cosine is positive adds to twice M, that of the other half being 0."""
    place = height * (NODES - 1)
    node = min(int(place), NODES - 2)
    log_mean = tables[at, node] + (place - node) * (tables[at, node + 1] - tables[at, node])
    return float(log_mean - (looks[at] - 1.5) * math.log(1 - min(height * height, 1 - 1e-15)))


@compiled
def log_share(height: float, looks: Real, tables: Real, at: int) -> float:
    """Log of twice M."""
    log_peak = _peak_mass(height, looks, tables, at)
    return float(max(log_peak, 0.0) + math.log1p(math.exp(-abs(log_peak))))


@compiled
def _turns(imag: float, real: float) -> float:
    """Phase in turns, to 2e-6: the polynomial of Abramowitz and Stegun (1964), section 4.4, for the arc tangent.

    The library's would keep a loop from finding several at once.
    """
    x, y = abs(real), abs(imag)
    ratio = min(x, y) / max(x, y, 1e-300)
    square = ratio * ratio
    series = 0.9998660 + square * (-0.3302995 + square * (0.1801410 + square * (-0.0851330 + square * 0.0208351)))
    turns = ratio * series * (0.5 / np.pi)
    turns = 0.25 - turns if y > x else turns
    turns = 0.5 - turns if real < 0 else turns
    return -turns if imag < 0 else turns


@compiled
def _heights(
    products: Complex, energies: Real, row: int, times: Times, lags: Real, turns_a_lag: float
) -> tuple[Real, Real]:
    """Lags and normalised heights of the passband peaks next to lags: there the product has the phase of the carrier.

    That phase is read at the nearest whole lag, the height by the polynomial at the place it points to.
    """
    reach, wrap = len(products) // 2, 1 / turns_a_lag
    # Short of half a lag, so that it is rounded inwards at either end.
    most = reach - STENCIL - 0.501
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
    before, after = products[place, row, time], products[place + 1, row, time]
    # The same with the receivers swapped.
    energy = min(energies[place, row, time], energies[place + 1, row, time])
    share = lag + len(products) // 2 - place
    line = (1 - share) * (before.real * before.real + before.imag * before.imag)
    line += share * (after.real * after.real + after.imag * after.imag)
    return bool(1.18 * line > least * energy * energy)


@compiled
def doubts(products: Complex, energies: Real, delays: Real, heights: Real | None, model: Model) -> Real:
    """Doubt of delays [lags], whose heights are read where they are None; shape (rows, time)."""
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
    """Doubts of some pixels of a row, given lags and heights of the passband peaks next to their delays.

    The nearest rivals are asked first, and others only where they may add `CARE` of what those have.
    """
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
    count, rise = 0, _rise(stack, times, peaks, least, 1.5 * wrap)
    for i in range(len(delays)):
        most = math.floor((search + abs(delays[i])) * turns_a_lag + 0.5) if rise[i] > 0 else 0
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
    """How far the squared magnitude at any lag so far away exceeds what may matter; below 0 where it nowhere does."""
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
