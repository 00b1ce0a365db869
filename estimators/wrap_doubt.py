"""How likely a delay lies in a wrong wrap, given the correlation at the rival wraps."""

import math
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from estimators.lag_product import LagStack
from estimators.peak_kernels import STENCIL
from estimators.posterior import Looks
from sim.band import Complex, Real
from sim.compiled import compiled

NODES = 513
"""Coherences at which the share of a wrap is tabulated, evenly from 0 to 1."""

CARE = 1e-2
"""Part of the odds that a rival may add without being read with care."""

PARTS = 128
"""Places between two lags at which a product is read; a peak is lower there by less than 1e-5 of its height."""


def _weights() -> Real:
    """Of the polynomial through products at nine lags, at `PARTS + 1` places within half a lag of the middle one."""
    place = np.linspace(-0.5, 0.5, PARTS + 1)
    lags = np.arange(-STENCIL, STENCIL + 1)
    weights: Real = np.vander(place, len(lags), increasing=True) @ np.linalg.inv(
        np.vander(lags.astype(float), increasing=True)
    )
    return weights


_WEIGHTS = _weights()


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
    found: Real = _doubts(
        np.broadcast_to(stack.products, (len(stack.products), *shape)),
        np.broadcast_to(stack.energies, (len(stack.energies), *shape)),
        np.ascontiguousarray(np.broadcast_to(delay, shape)) / stack.step,
        None if height is None else np.ascontiguousarray(np.broadcast_to(height, shape)),
        centre_frequency * stack.step,
        search / stack.step,
        distinct,
        which,
        np.stack([_mass_table(float(n)) for n in distinct]),
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
def _peak_mass(height: float, looks: float, table: Real) -> float:
    """Log of what the half of a wrap where the cosine is positive adds to twice M, that of the other half being 0."""
    place = height * (NODES - 1)
    node = min(int(place), NODES - 2)
    log_mean = table[node] + (place - node) * (table[node + 1] - table[node])
    return float(log_mean - (looks - 1.5) * math.log(1 - min(height * height, 1 - 1e-15)))


@compiled
def _log_share(height: float, looks: float, table: Real) -> float:
    """Log of twice M."""
    log_peak = _peak_mass(height, looks, table)
    return float(max(log_peak, 0.0) + math.log1p(math.exp(-abs(log_peak))))


@compiled
def _peak_height(products: Complex, energies: Real, row: int, time: int, lag: float, turns_a_lag: float) -> float:
    """Normalised height of the passband peak next to a lag: there the product has the phase of the carrier.

    That phase is read at the nearest whole lag, the height by the polynomial at the place it points to.
    """
    reach = len(products) // 2
    lag = min(max(lag, STENCIL + 0.5 - reach), reach - STENCIL - 0.5)
    whole = math.floor(lag + 0.5)
    product = products[whole + reach, row, time]
    turns = math.atan2(product.imag, product.real) * (0.5 / np.pi) + turns_a_lag * whole
    wrap = 1 / turns_a_lag
    lag = whole + (math.floor((lag - whole) * turns_a_lag + turns + 0.5) - turns) * wrap
    lag = min(max(lag, STENCIL + 0.5 - reach), reach - STENCIL - 0.5)
    nearest = math.floor(lag + 0.5)
    place = nearest + reach
    weights = _WEIGHTS[math.floor((lag - nearest + 0.5) * PARTS + 0.5)]
    real = imag = 0.0
    for k in range(2 * STENCIL + 1):
        product = products[place - STENCIL + k, row, time]
        real += weights[k] * product.real
        imag += weights[k] * product.imag
    share = lag - nearest
    here, before, after = energies[place, row, time], energies[place - 1, row, time], energies[place + 1, row, time]
    parabola = here + share / 2 * (after - before + share * (after + before - 2 * here))
    energy = max(parabola, min(here, before, after))
    return min(math.sqrt(real * real + imag * imag) / energy, 1.0) if energy > 0 else 0.0


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
def _doubts(
    products: Complex,
    energies: Real,
    delays: Real,
    heights: Real | None,
    turns_a_lag: float,
    search: float,
    looks: Real,
    which: NDArray[np.intp],
    tables: Real,
) -> Real:
    """Delays and search in lags, the carrier's turns a lag; looks and tables at each time are those of `which`.

    Rivals are asked from the nearest on, and with care only where they may add `CARE` of what those before them have.
    """
    found = np.empty(delays.shape)
    wrap = 1 / turns_a_lag
    for row in range(delays.shape[0]):
        for time in range(delays.shape[1]):
            n, table, delay = looks[which[time]], tables[which[time]], delays[row, time]
            if heights is None:
                height = _peak_height(products, energies, row, time, delay, turns_a_lag)
            else:
                height = heights[row, time]
            here = _log_share(height, n, table)
            nothing = math.exp(-here)
            own = min((search - abs(delay)) * turns_a_lag + 0.5, 1.0)
            # All rivals have the share of no correlation; those that correlate add to it.
            odds, least = max(2 * search * turns_a_lag - own, 0.0) * nothing, -1.0
            most = math.floor((search + abs(delay)) * turns_a_lag + 0.5)
            for away in range(1, most + 1):
                for side in (-1, 1):
                    lag = delay + side * away * wrap
                    share = min((search - abs(lag)) * turns_a_lag + 0.5, 1.0)
                    if share > 0 and _may_exceed(products, energies, row, time, lag, least):
                        height = _peak_height(products, energies, row, time, lag, turns_a_lag)
                        odds += share * math.exp(min(_peak_mass(height, n, table) - here, 700.0))
                if away == 1 and n > 1.5:
                    least = 1 - math.exp(min(-(math.log(CARE * odds + 1e-300) + here) / (n - 1.5), 0.0))
            found[row, time] = odds / (1 + odds)
    return found


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
            n, table, delay = looks[which[time]], tables[which[time]], delays[row, time]
            energy = energies[row, time] if energies[row, time] > 0 else np.inf
            first, second = low[row, time], high[row, time]
            here, odds = 0.0, 0.0
            for m in wraps:
                share = min(search - abs(delay + m) + 0.5, 1.0)
                if m == 0 or share > 0:
                    height = abs(first + second * np.exp(2j * np.pi * spacing * (delay + m))) / energy
                    there = _log_share(min(height, 1.0), n, table)
                    if m == 0:
                        here = there
                    else:
                        odds += share * np.exp(min(there - here, 700.0))
            found[row, time] = odds / (1 + odds)
    return found
