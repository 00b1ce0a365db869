"""Wrap-error predictions beside the envelope pair: the Gaussian approximation and the split spectrum."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike
from scipy.special import erfc

from .conventions import MOST_LOOKS, Floats, within
from .crlb import phase_crlb
from .multilook import multilook_phase_cdf, multilook_phase_pdf, tanh_sinh


def gaussian_wrap_error_probability(
    looks: ArrayLike, coherence: ArrayLike, relative_bandwidth: ArrayLike
) -> Floats:
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

    Exact for two independent multilook phases of `N b / B` looks: the chance that their difference,
    taken within (-pi, pi], exceeds `pi (B - b) / fc`. `looks` N (`N b / B` from 1 to 1e9), `coherence`
    in [0, 1] and `relative_bandwidth` `B / fc` above 0 and below 2 broadcast; NaN outside.
    `sub_band_share` is `b / B`, above 0 and at most one half, else ValueError.
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
    uncertain = np.where(gamma < 1.0, gamma, 0.5)
    share, weight = np.array(list(tanh_sinh())).T
    start = np.stack([np.zeros_like(limit), limit], axis=-1)[..., None]
    length = np.stack([limit, np.pi - limit], axis=-1)[..., None]
    edge = limit[..., None, None]
    looks_of_band, coherence_of_band = n[..., None, None], uncertain[..., None, None]
    first = start + length * share
    beyond = first + edge
    past = multilook_phase_cdf(
        np.where(beyond < np.pi, -beyond, beyond - 2.0 * np.pi), looks_of_band, coherence_of_band
    )
    outside = multilook_phase_cdf(first - edge, looks_of_band, coherence_of_band)
    outside += np.where(beyond < np.pi, past, -past)
    density = multilook_phase_pdf(first, looks_of_band, coherence_of_band)
    total = np.sum(weight * length * density * outside, axis=(-2, -1))
    rate: Floats = np.where(gamma < 1.0, np.minimum(2.0 * total, 1.0), 0.0 * (n + limit))
    return rate
