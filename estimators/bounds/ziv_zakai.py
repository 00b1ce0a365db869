"""Ziv-Zakai lower bound of the delay, which counts wrap errors and the prior's width."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from .coherent_pair import pair_probability
from .conventions import MOST_LOOKS, Floats, positive, signal_strength, within
from .crlb import coherent_delay_crlb
from .envelope_pair import MAX_LINES, band_lines


def ziv_zakai_delay_std(
    looks: ArrayLike,
    coherence: ArrayLike,
    centre_frequency: ArrayLike,
    bandwidth: ArrayLike,
    prior_width: ArrayLike,
) -> Floats:
    """
    Ziv-Zakai bound of the delay's RMS error [s], for a uniform prior of `prior_width` T [s].

    `MSE >= int_0^T h V{(1 - h / T) P(h)} dh`: P the coherent pair at lag h, V valley filling (Bell et
    al. 1997). `looks` N is real, 1 to 1e9, `coherence` in [0, 1]; NaN outside. Frequencies [Hz] and
    prior must be finite and positive and the bandwidth below twice the centre frequency, else
    ValueError. All broadcast; about 0.2 s for each element and ten wraps of prior. The N lines repeat
    after `N / B`: a wider prior counts their ambiguity too.
    """
    fc = positive("centre_frequency", centre_frequency, "Hz")
    b = positive("bandwidth", bandwidth, "Hz")
    width = positive("prior_width", prior_width, "s")
    if np.any(b >= 2.0 * fc):
        raise ValueError(f"bandwidth is {np.max(b / fc):g} of the centre frequency; it must be below 2")
    n, gamma, ratio, periods = np.broadcast_arrays(
        within(looks, 1.0, MOST_LOOKS), within(coherence, 0.0, 1.0), b / fc, width * fc
    )
    result = np.full(n.shape, np.nan)
    for i in np.ndindex(n.shape):
        if np.isfinite(n[i] + gamma[i]):
            result[i] = _std_in_wraps(float(n[i]), float(gamma[i]), float(ratio[i]), float(periods[i]))
    return result / fc


def _std_in_wraps(looks: float, gamma: float, ratio: float, prior: float) -> float:
    """The bound in units of one carrier period, in which the carrier is 1 and the band `ratio` wide."""
    if gamma == 1.0 and looks > 1.0:
        return 0.0
    lines = max(MAX_LINES, int(3.0 * ratio * prior) + MAX_LINES)
    theta, shapes = band_lines(looks, ratio, lines)
    frequency = 1.0 + theta / (2.0 * np.pi)
    q = signal_strength(np.asarray(gamma))
    scale = float(np.clip(coherent_delay_crlb(looks, gamma, 1.0, ratio), 1e-12, 0.25))
    h = _lags(frequency, shapes, float(q), scale, prior)
    p = pair_probability(np.sin(np.pi * h[:, None] * frequency) ** 2, shapes, np.broadcast_to(q, h.shape))
    filled = np.maximum.accumulate(((1.0 - h / prior) * p)[::-1])[::-1]
    # Exact for a filled valley that is straight between lags.
    left, right = h[:-1], h[1:]
    moment = (filled[:-1] * (2.0 * left + right) + filled[1:] * (left + 2.0 * right)) * (right - left) / 6.0
    return float(np.sqrt(np.sum(moment)))


def _lags(frequency: Floats, shapes: Floats, q: float, scale: float, prior: float) -> Floats:
    """Lags in [0, prior]: even ones, and dense ones about zero and about every most confusable lag."""

    def distance(lag: Floats) -> Floats:
        total = np.zeros(lag.shape)
        for f, shape in zip(frequency, shapes, strict=True):
            total += shape * np.log1p(q * np.sin(np.pi * f * lag) ** 2)
        return total

    even = np.linspace(0.0, prior, int(40.0 * prior) + 41)
    d = distance(even)
    centre = even[1:-1][(d[1:-1] <= d[:-2]) & (d[1:-1] <= d[2:])]
    for reach in (0.03, 0.0004, 0.000006):
        trial = centre[:, None] + reach * np.linspace(-1.0, 1.0, 201)
        centre = np.take_along_axis(trial, np.argmin(distance(trial), axis=1)[:, None], axis=1)[:, 0]
    dense = scale * np.sinh(np.linspace(0.0, np.arcsinh(0.5 / scale), 240))
    about = centre[:, None] + np.concatenate([-dense[:0:-4], dense[::4]])
    h = np.concatenate([even, dense, about.ravel()])
    return np.unique(h[(h >= 0.0) & (h <= prior)])
