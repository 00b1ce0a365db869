"""How likely a delay lies in a wrong wrap, given the correlation at the rival wraps."""

from functools import lru_cache
from typing import Any

import numpy as np
from numba import njit
from numpy.typing import NDArray

from estimators.lag_product import LagStack
from estimators.peak_kernels import STENCIL
from estimators.posterior import Looks
from sim.band import Complex, Real

NODES = 513
"""Coherences at which the share of a wrap is tabulated, evenly from 0 to 1."""

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


def wrap_doubt(stack: LagStack, delay: Real, looks: Looks, centre_frequency: float, search: float) -> Real:
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
        *(np.broadcast_to(lags, (len(lags), *shape)) for lags in (stack.products, stack.energies)),
        np.ascontiguousarray(np.broadcast_to(delay, shape)) / stack.step,
        2 * np.pi * centre_frequency * stack.step,
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


@njit(cache=True)  # type: ignore[misc,untyped-decorator,unused-ignore]
def _log_share(height: float, looks: float, table: Any) -> float:
    """Log of twice M."""
    place = height * (NODES - 1)
    node = min(int(place), NODES - 2)
    log_peak = table[node] + (place - node) * (table[node + 1] - table[node])
    log_peak -= (looks - 1.5) * np.log1p(-min(height * height, 1 - 1e-15))
    return float(max(log_peak, 0.0) + np.log1p(np.exp(-abs(log_peak))))


@njit(cache=True)  # type: ignore[misc,untyped-decorator,unused-ignore]
def _peak_height(products: Any, energies: Any, row: int, time: int, lag: float, carrier: float) -> float:
    """Normalised height of the passband peak next to a lag: there the product has the phase of the carrier.

    That phase is read at the nearest whole lag, the height by the polynomial at the place it points to.
    """
    reach = len(products) // 2
    lag = min(max(lag, STENCIL + 0.5 - reach), reach - STENCIL - 0.5)
    whole = np.rint(lag)
    turns = (np.angle(products[int(whole) + reach, row, time]) + carrier * whole) / (2 * np.pi)
    wrap = 2 * np.pi / carrier
    lag = whole - turns * wrap + np.rint((lag - whole) / wrap + turns) * wrap
    lag = np.rint(PARTS * min(max(lag, STENCIL + 0.5 - reach), reach - STENCIL - 0.5)) / PARTS
    nearest = int(np.rint(lag))
    place = nearest + reach
    weights = _WEIGHTS[int(np.rint((lag - nearest + 0.5) * PARTS))]
    product = 0j
    for k in range(2 * STENCIL + 1):
        product += weights[k] * products[place - STENCIL + k, row, time]
    share = lag - nearest
    here, before, after = energies[place, row, time], energies[place - 1, row, time], energies[place + 1, row, time]
    parabola = here + share / 2 * (after - before + share * (after + before - 2 * here))
    energy = max(parabola, min(here, before, after))
    return min(abs(product) / energy, 1.0) if energy > 0 else 0.0


@njit(cache=True)  # type: ignore[misc,untyped-decorator,unused-ignore]
def _doubts(
    products: Any, energies: Any, delays: Any, carrier: float, search: float, looks: Any, which: Any, tables: Any
) -> Any:
    """Delays and search in lags, the carrier's turn a lag [rad]; looks and tables at each time are those of `which`."""
    found = np.empty(delays.shape)
    wrap = 2 * np.pi / carrier
    for row in range(delays.shape[0]):
        for time in range(delays.shape[1]):
            n, table, delay = looks[which[time]], tables[which[time]], delays[row, time]
            here = _log_share(_peak_height(products, energies, row, time, delay, carrier), n, table)
            odds = 0.0
            first = int(np.ceil((-search - delay) / wrap - 0.5))
            last = int(np.floor((search - delay) / wrap + 0.5))
            for m in range(first, last + 1):
                lag = delay + m * wrap
                share = min((search - abs(lag)) / wrap + 0.5, 1.0)
                if m != 0 and share > 0:
                    there = _log_share(_peak_height(products, energies, row, time, lag, carrier), n, table)
                    odds += share * np.exp(min(there - here, 700.0))
            found[row, time] = odds / (1 + odds)
    return found


@njit(cache=True)  # type: ignore[misc,untyped-decorator,unused-ignore]
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
