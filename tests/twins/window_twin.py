"""Sums over windows, one window after the other; and the interpolation between lags, in plain NumPy."""

import numpy as np


def window_sum(array, rows, samples, circular):
    """Sum over the window around each pixel of (rows, time); sizes are numbers or have the shape (time,)."""
    height, times = array.shape
    sizes = np.broadcast_to(rows, times), np.broadcast_to(samples, times)
    total = np.zeros(array.shape, dtype=np.result_type(array, np.float64))
    for t, (n, m) in enumerate(zip(*sizes, strict=True)):
        when = t - m // 2 + np.arange(m)
        when = when % times if circular else when[(when >= 0) & (when < times)]
        for r in range(height):
            first = r - n // 2
            total[r, t] = array[max(first, 0) : max(first + n, 0), when].sum()
    return total


def interferogram(primary, secondary, rows, samples, circular):
    """Windowed product of (rows, time) and its coherence, 0 where there is no echo."""
    p, s = primary.astype(np.complex128), secondary.astype(np.complex128)
    product = window_sum(p.conj() * s, rows, samples, circular)
    energy = np.sqrt(window_sum(np.abs(p) ** 2, rows, samples, circular)) * np.sqrt(
        window_sum(np.abs(s) ** 2, rows, samples, circular)
    )
    return product, np.divide(np.abs(product), energy, out=np.zeros(p.shape), where=energy > 0)


def lag_products(primary, secondary, lags, samples):
    """Products of periodic series (time,) at even lags in samples, summed over a window; shape (lag, time)."""
    return np.stack(
        [
            window_sum((np.roll(primary, lag // 2).conj() * np.roll(secondary, -lag // 2))[None], 1, samples, True)[0]
            for lag in lags
        ]
    )


def peak(products, energies, index):
    """Share of a lag, product, energy and whether inside, of one pixel: from the highest lag by Newton's method.

    Through nine products runs a polynomial of degree 8; four steps, none beyond a lag.
    """
    around = products[index - 4 : index + 5]
    polynomial = np.polynomial.Polynomial.fit(np.arange(-4, 5), around, 8, domain=[-1, 1], window=[-1, 1])
    before, here, after = np.abs(around[3:6]) ** 2
    inside = here >= before and here >= after and here > 0
    share = 0.0
    if inside:
        bend = 2 * here - before - after
        share = np.clip((after - before) / (2 * bend), -1, 1) if bend > 0 else 0.0
        for _ in range(4):
            value, slope, curve = (polynomial.deriv(k)(share) if k else polynomial(share) for k in range(3))
            gradient = (np.conj(value) * slope).real
            curvature = np.abs(slope) ** 2 + (np.conj(value) * curve).real
            share = np.clip(share - (gradient / curvature if curvature < 0 else 0.0), -1, 1)
    nine = energies[index - 4 : index + 5]
    through = np.polynomial.Polynomial.fit(np.arange(-4, 5), nine, 8, domain=[-1, 1], window=[-1, 1])
    energy = max(through(share), nine[3:6].min())
    return share, polynomial(share), energy, inside
