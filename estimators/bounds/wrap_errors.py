"""Probability of picking the wrong wrap."""

import numpy as np
from numpy.polynomial.legendre import leggauss
from numpy.typing import ArrayLike

from estimators.bounds.quadrature import beta_nodes
from sim.band import Real

FEW = 5
"""Looks below which a number that is not whole is interpolated between those that are."""

NARROW = 0.01
"""Relative bandwidth below which the spectrum's shape is scaled from this one, as its variance drowns in rounding."""

SHAPES = 40
"""Nodes of the average over the spectrum's shape."""

ANGLES = 512
"""Nodes of the integral over the angle."""

SIDE_ANGLES = 128
"""Nodes of the integral over the angle for two sub-bands."""


def wrap_error_probability(looks: ArrayLike, coherence: ArrayLike, relative_bandwidth: ArrayLike) -> Real:
    """Probability that a correlation peak one wrap off stands higher than the right one, on either side.

    `2 E[P_env]` at the lag `1 / fc`: the envelope pair of theory section 3, averaged over speckle spectra
    `|P_k|^2 ~ exp(1)`. It holds for the cross-correlation refined by phase and for coherent maximum likelihood; wraps
    further off, which matter at few looks or wide bands, are left out.

    With `x = 1 - R^2` and `q = gamma^2 / (1 - gamma^2)`, the pair probability is
    `P_env = 1 / (4 pi) int exp(-q G x / (2 (1 - R cos E))) dE` over a full turn: the finite-range form of
    Marcum's function (Simon and Alouini 1998), its angle replaced as true by eccentric anomaly. Total power `G` is
    Gamma(N) and independent of the spectrum's shape, which leaves `(1 + q x / (2 (1 - R cos E)))^-N`. The shape enters
    by `x` alone; its first two moments over flat Dirichlet weights are exact, and a Beta distribution has them. Against
    averages over drawn spectra this is within 0.6 % for probabilities above 0.01, within 1.5 % above 1e-4 at 33 looks,
    and within 25 % at 1e-6 and 9 looks.

    Parameters
    ----------
    looks
        Independent looks, `N`, 1 or more; from 5 on the closed sums over Fourier bins take any real number, below that
        it is interpolated on a straight line between whole ones.
    coherence
        `gamma`, 0 to 1.
    relative_bandwidth
        `B / fc`, above 0 and below 2.

    Returns
    -------
    array
        0 to 1; broadcast. NaN outside the limits. 1 for a single look, whose correlation is as strong at any lag.
    """
    looks, coherence, ratio = np.broadcast_arrays(
        np.asarray(looks, dtype=float), np.asarray(coherence, dtype=float), np.asarray(relative_bandwidth, dtype=float)
    )
    allowed = (looks >= 1) & (coherence >= 0) & (coherence <= 1) & (ratio > 0) & (ratio < 2)
    probability = np.full(looks.shape, np.nan)
    for each in np.unique(np.stack([looks[allowed], ratio[allowed]]), axis=1).T:
        same = allowed & (looks == each[0]) & (ratio == each[1])
        probability[same] = _pair_on_both_sides(each[0], coherence[same], each[1])
    return probability


def _pair_on_both_sides(looks: float, coherence: Real, ratio: float) -> Real:
    whole = np.floor(looks)
    if looks < FEW and looks > whole:
        share = looks - whole
        low, high = (_pair_on_both_sides(n, coherence, ratio) for n in (whole, whole + 1))
        between: Real = (1 - share) * low + share * high
        return between
    if looks == 1:
        return np.ones_like(coherence)
    x, weights = _shape_nodes(looks, ratio)
    root = np.sqrt(1 - x)[:, None]
    # Midpoints of half a turn: the integrand is even and periodic.
    angle = (np.arange(ANGLES) + 0.5) * np.pi / ANGLES
    ellipse = x[:, None] / (2 * (1 - root * np.cos(angle)))
    with np.errstate(divide="ignore"):
        q = (coherence / (1 - coherence)) * (coherence / (1 + coherence))
        integrand = np.exp(-looks * np.log1p(q[:, None, None] * ellipse))
    probability: Real = np.minimum(integrand.mean(axis=2) @ weights, 1.0)
    return probability


def _shape_nodes(looks: float, ratio: float) -> tuple[Real, Real]:
    """Values of `x = 1 - R^2` and their weights: Gauss-Jacobi for the Beta distribution of the exact two moments.

    `R = |sum w_k exp(2 pi i f_k / fc)|` with weights `w_k` of `N` exponential powers. The moments of the sum without
    normalisation follow from its cumulants `(a + b - 1)! sum_k exp(i (a - b) theta_k)`; dividing by the moments of the
    total power, Gamma(N), gives those of `R`.
    """
    if ratio < NARROW:
        x, weights = _shape_nodes(looks, NARROW)
        return x * (ratio / NARROW) ** 2, weights
    first, second = (_bin_sum(looks, turns * ratio) for turns in (1, 2))
    n = looks
    square = (n + first**2) / (n * (n + 1))
    fourth = (6 * n + 8 * first**2 + second**2 + 2 * n**2 + 2 * second * first**2 + 4 * n * first**2 + first**4) / (
        n * (n + 1) * (n + 2) * (n + 3)
    )
    mean, variance = 1 - square, fourth - square**2
    # Of many looks the variance is nothing but rounding.
    spread = mean * (1 - mean) / max(variance, 1e-12 * mean * (1 - mean)) - 1
    return beta_nodes(mean * spread, (1 - mean) * spread, SHAPES)


def _bin_sum(looks: float, turns: float) -> float:
    """`sum_k exp(2 pi i turns f_k / B)` over `N` bins that fill a band around zero."""
    step = np.pi * turns / looks
    if abs(np.sin(step)) < 1e-9:
        return float(looks * np.cos(np.pi * turns) / np.cos(step))
    return float(np.sin(np.pi * turns) / np.sin(step))


def split_spectrum_wrap_error_probability(
    looks: ArrayLike, coherence: ArrayLike, relative_bandwidth: ArrayLike, sub_band_share: float = 1 / 3
) -> Real:
    """Probability that the delay of two outer sub-bands is off by more than half a wrap.

    The difference of two independent multilook phases, each of `L = N b / B` looks, errs by more than
    `T = pi (B - b) / fc`. For two vectors in noise that probability is
    `sin T / (2 pi) int W exp(-E) / E dt` over half a turn, `E = U - V sin t - W cos T cos t` (Pawula, Rice and Roberts
    1982), with the sum, difference and geometric mean of their signal-to-noise ratios. Those are
    `q G1` and `q G2`, `q = gamma^2 / (1 - gamma^2)`, with Gamma(L) powers `G`: their sum averages in closed form, to
    `(1 + q e)^-2L` with `e = E / (q (G1 + G2))`, and their shares are Beta(L, L), averaged by Gauss-Jacobi quadrature.
    Exact for a delay of zero; the quadrature holds to 1e-4 but for rates of a fully developed tail at 1 look a sub-band
    (0.6 % at 3 looks and coherence 0.999).

    Parameters
    ----------
    looks, coherence, relative_bandwidth
        As for `wrap_error_probability`; looks of the full band.
    sub_band_share
        `b / B`, at most 1/2.

    Returns
    -------
    array
        0 to 1; broadcast. NaN outside the limits; 0 where `T` is half a turn, which the phases cannot be apart.
    """
    looks, coherence, ratio = np.broadcast_arrays(
        np.asarray(looks, dtype=float), np.asarray(coherence, dtype=float), np.asarray(relative_bandwidth, dtype=float)
    )
    allowed = (looks > 0) & (coherence >= 0) & (coherence <= 1) & (ratio > 0) & (ratio < 2)
    probability = np.full(looks.shape, np.nan)
    for each in np.unique(np.stack([looks[allowed], ratio[allowed]]), axis=1).T:
        same = allowed & (looks == each[0]) & (ratio == each[1])
        probability[same] = _phases_apart(
            each[0] * sub_band_share, coherence[same], min(np.pi * each[1] * (1 - sub_band_share), np.pi)
        )
    return probability


def _phases_apart(looks: float, coherence: Real, threshold: float) -> Real:
    share, weights = beta_nodes(looks, looks, SHAPES)
    # E is least at t = arcsin(1 - 2 share), over a width of T: equal steps of asinh((t - there) / T).
    least = np.arcsin(np.clip(1 - 2 * share, -1, 1))[:, None]
    first, last = (np.arcsinh((end - least) / threshold) for end in (-np.pi / 2, np.pi / 2))
    nodes, steps = leggauss(SIDE_ANGLES)
    u = first + (nodes + 1) / 2 * (last - first)
    t, steps = least + threshold * np.sinh(u), steps / 2 * (last - first) * threshold * np.cosh(u)
    # e = (1 - cos(least - t)) / 2 + cos(least) cos(t) sin^2(T/2), without cancellation.
    e = np.sin((least - t) / 2) ** 2 + np.cos(least) * np.cos(t) * np.sin(threshold / 2) ** 2
    with np.errstate(divide="ignore"):
        q = (coherence / (1 - coherence)) * (coherence / (1 + coherence))
        integrand = np.exp(-2 * looks * np.log1p(q[:, None, None] * e)) * (np.cos(least) / 2 / e * steps)
    probability: Real = np.sin(threshold) / (2 * np.pi) * (integrand.sum(axis=2) @ weights)
    return np.minimum(probability, 1.0)
