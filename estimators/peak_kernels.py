"""The interpolation between lags, compiled: read at given places, or climbed to the highest magnitude.

Through the products at nine lags runs a polynomial of degree 8, which is evaluated with its derivatives by Horner's
rule. A few hundred pixels at a time are laid side by side, coefficient by coefficient.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from sim.compiled import compiled

STENCIL = 4
"""Lags on either side of a peak that its interpolation uses, and that a stack holds beyond the search range. At four
lags per `1 / B` the polynomial of degree 8 follows the band's edge to 6e-5 of its amplitude half-way between lags."""

OFFSETS = np.arange(-STENCIL, STENCIL + 1)
COEFFICIENTS = np.linalg.inv(np.vander(OFFSETS.astype(float), increasing=True))
"""Of the polynomial, shape (power, lag), from the products at `OFFSETS`."""

LAGS = 2 * STENCIL + 1
SCALES = np.array([1 / np.prod([k - other for other in OFFSETS if other != k]) for k in OFFSETS])
"""Of Lagrange's weights of the nine lags."""

STEPS = 4
"""Of Newton's method."""

PIXELS = 256

Array = NDArray[Any]


@compiled
def strongest(products: Array) -> NDArray[np.intp]:
    """Lag of the largest magnitude, the first of equal ones; from shape (lag, rows, time) to (rows, time)."""
    lags, rows, times = products.shape
    index = np.zeros((rows, times), np.intp)
    for r in range(rows):
        highest = np.full(times, -1.0)
        for lag in range(lags):
            for t in range(times):
                power = _power(products[lag, r, t])
                index[r, t] = lag if power > highest[t] else index[r, t]
                highest[t] = max(power, highest[t])
    return index


@compiled
def climb_from_lags(
    products: Array, energies: Array, index: Array, share: Array, product: Array, energy: Array, inside: Array
) -> None:
    """From the highest lags to where the squared magnitude peaks, within a lag of them.

    `share` takes how far in lags; it is zero, and the peak not inside, where a neighbouring lag is higher.
    """
    weights = COEFFICIENTS
    real, imag = np.empty((LAGS, PIXELS)), np.empty((LAGS, PIXELS))
    for r in range(index.shape[0]):
        for begin in range(0, index.shape[1], PIXELS):
            part = slice(begin, min(begin + PIXELS, index.shape[1]))
            _fit(products, weights, r, begin, index[r, part], real, imag)
            _start(products, r, begin, index[r, part], share[r, part], inside[r, part])
            _climb(real, imag, share[r, part], inside[r, part])
            _read(real, imag, share[r, part], product[r, part])
            times = np.minimum(np.arange(part.start, part.stop), energies.shape[2] - 1)
            _weigh_energies(energies, r, times, index[r, part], _lagrange(share[r, part]), energy[r, part])


@compiled
def read_at_lags(products: Array, energies: Array, index: Array, share: Array, product: Array, energy: Array) -> None:
    """Products and energies at `share` of a lag from the lags `index`."""
    for r in range(index.shape[0]):
        for begin in range(0, index.shape[1], PIXELS):
            part = slice(begin, min(begin + PIXELS, index.shape[1]))
            # Where all times have one product, its column stands for all.
            times = np.minimum(np.arange(part.start, part.stop), products.shape[2] - 1)
            weights = _lagrange(share[r, part])
            _weigh_products(products, r, times, index[r, part], weights, product[r, part])
            _weigh_energies(energies, r, times, index[r, part], weights, energy[r, part])


@compiled
def read_products(products: Array, r: int, times: Array, index: Array, share: Array, product: Array) -> None:
    """The polynomials of products alone."""
    _weigh_products(products, r, times, index, _lagrange(share), product)


@compiled
def _lagrange(share: Array) -> Array:
    """Lagrange's weights of the nine lags, shape (lag, pixel)."""
    weights = np.empty((LAGS, share.size))
    for i in range(share.size):
        ahead = behind = 1.0
        for k in range(LAGS):
            weights[k, i] = ahead * SCALES[k]
            ahead *= share[i] - OFFSETS[k]
        for k in range(LAGS - 1, -1, -1):
            weights[k, i] *= behind
            behind *= share[i] - OFFSETS[k]
    return weights


@compiled
def _weigh_products(products: Array, r: int, times: Array, index: Array, weights: Array, product: Array) -> None:
    for i in range(index.size):
        real = imag = 0.0
        for k in range(LAGS):
            value = products[index[i] + k - STENCIL, r, times[i]]
            real += weights[k, i] * value.real
            imag += weights[k, i] * value.imag
        product[i] = complex(real, imag)


@compiled
def _weigh_energies(energies: Array, r: int, times: Array, index: Array, weights: Array, energy: Array) -> None:
    """On the same polynomial: of 33 looks a parabola errs by 1e-5, so that at 60 dB coherences came out as 1."""
    for i in range(index.size):
        here, t = index[i], times[i]
        value = 0.0
        for k in range(LAGS):
            value += weights[k, i] * energies[here + k - STENCIL, r, t]
        least = min(energies[here, r, t], min(energies[here - 1, r, t], energies[here + 1, r, t]))
        # Of a single dark pixel it may undershoot.
        energy[i] = max(value, least)


@compiled
def read_energies(energies: Array, r: int, times: Array, index: Array, share: Array, energy: Array) -> None:
    """On a parabola between lags, which is enough for rivals."""
    for i in range(index.size):
        t = times[i]
        before, here, after = energies[index[i] - 1, r, t], energies[index[i], r, t], energies[index[i] + 1, r, t]
        parabola = here + share[i] / 2 * (after - before + share[i] * (after + before - 2 * here))
        # Of a single dark pixel it may undershoot.
        energy[i] = max(parabola, min(here, min(before, after)))


@compiled
def _fit(products: Array, weights: Array, r: int, begin: int, index: Array, real: Array, imag: Array) -> None:
    """Coefficients of the polynomials, shape (power, pixel)."""
    # Where all times have one product, its column stands for all.
    last = products.shape[2] - 1
    sums, differences = np.empty((2, STENCIL + 1, index.size)), np.empty((2, STENCIL + 1, index.size))
    for j in range(STENCIL + 1):
        for i in range(index.size):
            t = min(begin + i, last)
            behind, ahead = products[index[i] - j, r, t], products[index[i] + j, r, t]
            sums[0, j, i], sums[1, j, i] = ahead.real + behind.real, ahead.imag + behind.imag
            differences[0, j, i], differences[1, j, i] = ahead.real - behind.real, ahead.imag - behind.imag
    # Even powers take lags on either side alike, odd ones oppositely.
    for k in range(LAGS):
        parts = differences if k % 2 else sums
        for i in range(index.size):
            a, b = weights[k, STENCIL] / 2 * parts[0, 0, i], weights[k, STENCIL] / 2 * parts[1, 0, i]
            for j in range(1, STENCIL + 1):
                a += weights[k, STENCIL + j] * parts[0, j, i]
                b += weights[k, STENCIL + j] * parts[1, j, i]
            real[k, i], imag[k, i] = a, b


@compiled
def _start(products: Array, r: int, begin: int, index: Array, share: Array, inside: Array) -> None:
    """The peak of the parabola through three squared magnitudes."""
    last = products.shape[2] - 1
    for i in range(index.size):
        t = min(begin + i, last)
        before = _power(products[index[i] - 1, r, t])
        here = _power(products[index[i], r, t])
        after = _power(products[index[i] + 1, r, t])
        inside[i] = here >= before and here >= after and here > 0
        bend = 2 * here - before - after
        share[i] = min(max((after - before) / (2 * bend), -1.0), 1.0) if inside[i] and bend > 0 else 0.0


@compiled
def _climb(real: Array, imag: Array, share: Array, inside: Array) -> None:
    """Newton's method on half the squared magnitude."""
    for _ in range(STEPS):
        for i in range(share.size):
            x = share[i]
            a, b = real[LAGS - 1, i], imag[LAGS - 1, i]
            slope_a = slope_b = half_a = half_b = 0.0
            for k in range(2, LAGS + 1):
                half_a, half_b = half_a * x + slope_a, half_b * x + slope_b
                slope_a, slope_b = slope_a * x + a, slope_b * x + b
                a, b = a * x + real[LAGS - k, i], b * x + imag[LAGS - k, i]
            gradient = a * slope_a + b * slope_b
            curvature = slope_a * slope_a + slope_b * slope_b + 2 * (a * half_a + b * half_b)
            step = gradient / curvature if curvature < 0 else 0.0
            share[i] = min(max(x - step, -1.0), 1.0)
    for i in range(share.size):
        share[i] = share[i] if inside[i] else 0.0


@compiled
def _read(real: Array, imag: Array, share: Array, product: Array) -> None:
    for i in range(share.size):
        a, b = real[LAGS - 1, i], imag[LAGS - 1, i]
        for k in range(2, LAGS + 1):
            a, b = a * share[i] + real[LAGS - k, i], b * share[i] + imag[LAGS - k, i]
        product[i] = complex(a, b)


@compiled
def _power(value: complex) -> float:
    return value.real * value.real + value.imag * value.imag
