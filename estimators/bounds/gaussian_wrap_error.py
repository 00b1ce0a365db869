"""Wrap-error probability if the delay error were Gaussian at its Cramer-Rao bound."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike
from scipy.special import erfc

from .conventions import MOST_LOOKS, Floats, open_ratio, sub_band_looks, within
from .crlb import phase_crlb


def gaussian_wrap_error_probability(looks: ArrayLike, coherence: ArrayLike, relative_bandwidth: ArrayLike) -> Floats:
    """
    Chance that a Gaussian group delay is off by half a carrier period: `2 Q(d)`, `d = 1 / (2 fc sigma_group)`.

    The bound is that of N lines B / N apart, whose mean square bandwidth is `1 - 1 / N^2` of the flat
    band's. 10 to 67 % below `wrap_error_probability` in theory section 3, its source.

    Parameters
    ----------
    looks, coherence, relative_bandwidth
        As for `wrap_error_probability`.

    Returns
    -------
    ndarray
        Probability, 0 to 1; of the broadcast shape.
    """
    n = within(looks, 1.0, MOST_LOOKS)
    half_period = np.pi / np.sqrt(12.0) * open_ratio(relative_bandwidth) * np.sqrt((1.0 - 1.0 / n) * (1.0 + 1.0 / n))
    return _two_sided(half_period, phase_crlb(n, coherence))


def gaussian_split_spectrum_wrap_error_probability(
    looks: ArrayLike,
    coherence: ArrayLike,
    relative_bandwidth: ArrayLike,
    *,
    sub_band_share: float = 1.0 / 3.0,
) -> Floats:
    """
    The same for the split spectrum: `2 Q(d)`, `d = 1 / (2 fc sigma_split)`, without phase ambiguity.

    The Gaussian approximation of `split_spectrum_wrap_error_probability`.
    Source: `split_spectrum_crlb`; two phases of `N b / B` looks each, compared over `B - b`.

    Parameters
    ----------
    looks, coherence, relative_bandwidth, sub_band_share
        As for `split_spectrum_wrap_error_probability`.

    Returns
    -------
    ndarray
        Probability, 0 to 1; of the broadcast shape.

    Raises
    ------
    ValueError
        For a share outside these limits.
    """
    if not 0.0 < sub_band_share <= 0.5:
        raise ValueError(f"sub_band_share is {sub_band_share}; it must be above 0 and at most 0.5")
    threshold = np.pi * (1.0 - sub_band_share) * open_ratio(relative_bandwidth)
    phase_std = phase_crlb(sub_band_looks(looks, sub_band_share), coherence)
    return _two_sided(threshold, np.sqrt(2.0) * phase_std)


def _two_sided(limit: Floats, std: Floats) -> Floats:
    with np.errstate(divide="ignore", invalid="ignore"):
        # One look has no group delay, whatever its coherence.
        distance = np.where((limit == 0.0) & (std == 0.0), 0.0, limit / std)
    result: Floats = erfc(np.sqrt(0.5) * distance)
    return result
