"""Wrap-error predictions beside the envelope pair: the Gaussian approximation and the split spectrum."""

from __future__ import annotations

import numpy as np
from numpy.polynomial.legendre import leggauss
from numpy.typing import ArrayLike
from scipy.special import erfc

from .conventions import MOST_LOOKS, Floats, within
from .crlb import phase_crlb
from .quadrature import beta_nodes

SHARES = 40
ANGLES = 128


def gaussian_wrap_error_probability(looks: ArrayLike, coherence: ArrayLike, relative_bandwidth: ArrayLike) -> Floats:
    """
    Wrap-error probability if the group delay were Gaussian at its bound: `2 Q(d)`, `d = 1 / (2 fc
    sigma_group)`.

    The bound is that of N lines B / N apart, whose mean square bandwidth is `1 - 1 / N^2` of the flat
    band's. Too low by 10 to 70 %. `looks` N from 1 to 1e9, `coherence` in [0, 1], `relative_bandwidth`
    `B / fc` above 0 and below 2; they broadcast, NaN outside. Source: theory section 3.
    """
    ratio = within(relative_bandwidth, 0.0, 2.0)
    ratio = np.where((ratio > 0.0) & (ratio < 2.0), ratio, np.nan)
    n = within(looks, 1.0, MOST_LOOKS)
    sigma = phase_crlb(n, coherence)
    with np.errstate(divide="ignore"):
        d = np.pi / np.sqrt(12.0) * ratio * np.sqrt((1.0 - 1.0 / n) * (1.0 + 1.0 / n)) / sigma
    result: Floats = erfc(np.sqrt(0.5) * d)
    return result


def split_spectrum_wrap_error_probability(
    looks: ArrayLike,
    coherence: ArrayLike,
    relative_bandwidth: ArrayLike,
    *,
    sub_band_share: float = 1.0 / 3.0,
) -> Floats:
    """
    Wrap-error probability of the delay from the phase difference of the two outer sub-bands.

    The chance that the difference of two independent multilook phases of `L = N b / B` looks, taken
    within (-pi, pi], exceeds `T = pi (B - b) / fc`. For two vectors in noise it is
    `sin T / (2 pi) int W exp(-E) / E dt` over half a turn, `E = U - V sin t - W cos T cos t` (Pawula, Rice and
    Roberts 1982), with the sum, difference and geometric mean of their signal-to-noise ratios. Those are `q G1`
    and `q G2`, `q = gamma^2 / (1 - gamma^2)`, with Gamma(L) powers `G`: the sum of the powers averages in closed
    form, to `(1 + q e)^-2L` with `e = E / (q (G1 + G2))`, and their shares are Beta(L, L).

    `looks` N (`N b / B` from 1 to 1e9), `coherence` in [0, 1] and `relative_bandwidth` `B / fc` above 0 and
    below 2 broadcast; NaN outside. `sub_band_share` is `b / B`, above 0 and at most one half, else ValueError.
    The quadrature holds to 2e-4, but for 0.6 % in the tail at one look a sub-band.
    """
    if not 0.0 < sub_band_share <= 0.5:
        raise ValueError(f"sub_band_share is {sub_band_share}; it must be above 0 and at most 0.5")
    ratio = within(relative_bandwidth, 0.0, 2.0)
    sub_looks = np.asarray(looks, dtype=np.float64) * sub_band_share
    n, gamma, limit = np.broadcast_arrays(
        within(sub_looks * (1.0 + 1e-12), 1.0, MOST_LOOKS),
        within(coherence, 0.0, 1.0),
        np.pi * (1.0 - sub_band_share) * np.where((ratio > 0.0) & (ratio < 2.0), ratio, np.nan),
    )
    limit = np.minimum(limit, np.pi)
    rate = np.full(n.shape, np.nan)
    valid = np.isfinite(n + gamma + limit)
    for each in np.unique(np.stack([n[valid], limit[valid]]), axis=1).T:
        same = valid & (n == each[0]) & (limit == each[1])
        rate[same] = _phases_apart(each[0], gamma[same], each[1])
    return rate


def _phases_apart(looks: float, coherence: Floats, threshold: float) -> Floats:
    share, weights = beta_nodes(looks, looks, SHARES)
    # E is least at t = arcsin(1 - 2 share), over a width of T: equal steps of asinh((t - there) / T).
    least = np.arcsin(np.clip(1 - 2 * share, -1, 1))[:, None]
    first, last = (np.arcsinh((end - least) / threshold) for end in (-np.pi / 2, np.pi / 2))
    nodes, steps = leggauss(ANGLES)
    u = first + (nodes + 1) / 2 * (last - first)
    t, steps = least + threshold * np.sinh(u), steps / 2 * (last - first) * threshold * np.cosh(u)
    # e = (1 - cos(least - t)) / 2 + cos(least) cos(t) sin^2(T/2), without cancellation.
    e = np.sin((least - t) / 2) ** 2 + np.cos(least) * np.cos(t) * np.sin(threshold / 2) ** 2
    with np.errstate(divide="ignore"):
        q = (coherence / (1 - coherence)) * (coherence / (1 + coherence))
        integrand = np.exp(-2 * looks * np.log1p(q[:, None, None] * e)) * (np.cos(least) / 2 / e * steps)
    probability: Floats = np.sin(threshold) / (2 * np.pi) * (integrand.sum(axis=2) @ weights)
    return np.minimum(probability, 1.0)
