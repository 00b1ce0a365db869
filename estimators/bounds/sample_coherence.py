"""
Exact statistics of the sample coherence magnitude of L looks, and the removal of its bias.

With `g = tanh(zeta)` and `gamma = tanh(zeta_0)` the density is spread evenly in zeta, `(L - 1) sinh(2 zeta)
/ (cosh(zeta + zeta_0) cosh(zeta - zeta_0)^(2L-1)) M`, where `M = (2 / pi) int_0^(pi/2) (cos^2 a + r^2 sin^2
a)^(L-1) da`, `r = cosh(zeta - zeta_0) / cosh(zeta + zeta_0)`. It follows from the density with `2F1(L, L;
1; gamma^2 g^2)` (Touzi and Lopes 1996) by Euler's transformation and Laplace's integral of the Legendre
function; all terms are positive and L may be real.

`looks` L is 1 to 1e9, `coherence` gamma a magnitude in [0, 1]; they broadcast, and outside these ranges the
result is NaN. One look always gives 1, and so does full coherence.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from .conventions import MOST_LOOKS, Floats, checked_looks_and_coherence, within
from .quadrature import unit_gauss_legendre

STEP = 0.25


def sample_coherence_pdf(value: ArrayLike, looks: ArrayLike, coherence: ArrayLike) -> Floats:
    """
    Density of the sample coherence at `value`, in [0, 1] and NaN beyond, by the equation above.

    Relative error below 1e-7.
    NaN too at one look and at full coherence, where the sample coherence is 1 without spread.
    Source: Touzi and Lopes 1996, in a form whose terms are all positive.

    Parameters
    ----------
    value
        Sample coherence, 0 to 1; NaN beyond.
    looks, coherence
        As for `sample_coherence_mean`.

    Returns
    -------
    ndarray
        Density over coherence; of the broadcast shape.
    """
    g, n, gamma = np.broadcast_arrays(
        within(value, 0.0, 1.0), within(looks, 1.0, MOST_LOOKS), within(coherence, 0.0, 1.0)
    )
    defined = (n > 1.0) & (gamma < 1.0) & np.isfinite(g)
    m, rho = np.where(defined, n, 2.0), np.where(defined, gamma, 0.0)
    edge = g == 1.0
    zeta0 = np.arctanh(rho)
    value = np.where(defined & ~edge, g, 0.5)
    log_pdf = _log_density(np.arctanh(value) - zeta0, zeta0, m) - np.log1p(-value) - np.log1p(value)
    two_looks = 2.0 * (1.0 + rho * rho) / ((1.0 - rho) * (1.0 + rho))
    at_edge = np.where(m > 2.0, 0.0, np.where(m < 2.0, np.inf, two_looks))
    return np.where(defined, np.where(edge, at_edge, np.exp(log_pdf)), np.nan)


def _log_density(offset: Floats, zeta0: Floats, n: Floats) -> Floats:
    """Log density over zeta at `zeta0 + offset`."""
    zeta = zeta0 + offset
    log_ratio = _log_cosh(offset) - _log_cosh(zeta + zeta0)
    power = n - 1.0
    ratio2 = np.exp(2.0 * log_ratio)
    # Steps of sinh in tan(a), as narrow as the power makes the peak.
    scale = 1.0 / np.sqrt(np.maximum(1.0, power * (1.0 - ratio2)))
    total = np.full(np.broadcast(offset, zeta0, n).shape, 0.5)
    for w in STEP * np.arange(1, 89):
        tangent2 = (scale * np.sinh(w)) ** 2
        cosine2 = 1.0 / (1.0 + tangent2)
        with np.errstate(divide="ignore"):
            fall = np.log1p((ratio2 - 1.0) * tangent2 * cosine2)
        term = np.cosh(w) * cosine2 * np.exp(power * fall)
        total += term
        if np.all(term < 1e-17 * total):
            break
    # Beyond the last step, where the tangent is far above one, the power stays what it is at a right angle.
    with np.errstate(under="ignore"):
        total += ratio2**power / (scale**2 * STEP * np.sinh(w + 0.5 * STEP))
    total *= scale * STEP * 2.0 / np.pi
    with np.errstate(divide="ignore"):
        log_sinh = 2.0 * zeta + np.log(-0.5 * np.expm1(-4.0 * zeta))
    result: Floats = np.log(power * total) + log_sinh
    return result - 2.0 * n * _log_cosh(offset) + log_ratio


def _log_cosh(x: Floats) -> Floats:
    result: Floats = np.abs(x) + np.log1p(np.exp(-2.0 * np.abs(x))) - np.log(2.0)
    return result


def sample_coherence_moments(looks: ArrayLike, coherence: ArrayLike) -> tuple[Floats, Floats, Floats]:
    """Means of g and of `1 - g`, each to its relative accuracy, and standard deviation of g."""
    n, gamma = np.broadcast_arrays(within(looks, 1.0, MOST_LOOKS), within(coherence, 0.0, 1.0))
    spread = (n > 1.0) & (gamma < 1.0)
    m, zeta0 = np.where(spread, n, 2.0), np.arctanh(np.where(spread, gamma, 0.5))
    scale = 1.0 / np.sqrt(2.0 * m)
    # Beyond these the density is below exp(-40) of its peak.
    low = np.arcsinh(np.minimum(zeta0, np.sqrt(40.0 / m) + 20.0 / m) / scale)
    high = np.arcsinh(np.minimum(np.sqrt(40.0 / m) + 20.0 / (m - 1.0), 1e300) / scale)
    nodes, weights = unit_gauss_legendre(96)
    w = -low[..., None] + (low + high)[..., None] * nodes
    offset = scale[..., None] * np.sinh(w)
    log_density = _log_density(offset, zeta0[..., None], m[..., None])
    mass = weights * np.cosh(w) * np.exp(log_density - np.max(log_density, axis=-1, keepdims=True))
    mass = mass / np.sum(mass, axis=-1, keepdims=True)
    zeta = zeta0[..., None] + offset
    missing = 2.0 / (1.0 + np.exp(np.minimum(2.0 * zeta, 700.0)))
    mean = np.sum(mass * np.tanh(zeta), axis=-1)
    rest = np.sum(mass * missing, axis=-1)
    std = np.sqrt(np.sum(mass * (missing - rest[..., None]) ** 2, axis=-1))
    certain = 0.0 * (n + gamma)
    return np.where(spread, mean, 1.0 + certain), np.where(spread, rest, certain), np.where(spread, std, certain)


def sample_coherence_mean(looks: ArrayLike, coherence: ArrayLike) -> Floats:
    """
    Mean of the sample coherence, `E[g]`, from the density.

    Equal to `Gamma(L) Gamma(3/2) / Gamma(L + 1/2) (1 - gamma^2)^L 3F2(3/2, L, L; L + 1/2, 1; gamma^2)` (Touzi and
    Lopes 1996); at zero coherence the bias floor `(sqrt(pi) / 2) Gamma(L) / Gamma(L + 1/2)`. Relative error below
    1e-10.

    Parameters
    ----------
    looks, coherence
        Independent looks, real, 1 to 1e9; coherence magnitude, 0 to 1. NaN elsewhere.

    Returns
    -------
    ndarray
        0 to 1; of the broadcast shape.
    """
    return sample_coherence_moments(looks, coherence)[0]


def sample_coherence_std(looks: ArrayLike, coherence: ArrayLike) -> Floats:
    """
    Standard deviation of the sample coherence, `sqrt(E[g^2] - E[g]^2)`, from the density about its mean.

    Relative error below 1e-8, also where mean and standard deviation are far apart.
    Source: Touzi and Lopes 1996.

    Parameters
    ----------
    looks, coherence
        As for `sample_coherence_mean`.

    Returns
    -------
    ndarray
        0 to 1/2; of the broadcast shape.
    """
    return sample_coherence_moments(looks, coherence)[2]


def sample_sample_coherence(
    looks: ArrayLike,
    coherence: ArrayLike,
    *,
    rng: np.random.Generator,
    size: int | tuple[int, ...] | None = None,
) -> Floats:
    """
    Exact draws of the sample coherence magnitude.

    `g^2 = X / (X + Y)` with `X = |gamma sqrt(G) + sqrt(1 - gamma^2) w|^2`, `G ~ Gamma(L, 1)`, `w ~ CN(0,
    1)` and `Y = (1 - gamma^2) Gamma(L - 1, 1)`, which is the negative binomial mixture of beta laws.
    Source: theory section 4.

    Parameters
    ----------
    looks, coherence, rng, size
        As for `sample_multilook_phase`.

    Returns
    -------
    ndarray
        0 to 1; of that shape.

    Raises
    ------
    ValueError
        For looks or a coherence outside these limits.
    """
    n, gamma = checked_looks_and_coherence(looks, coherence)
    shape = n.shape if size is None else size
    noise = (1.0 - gamma) * (1.0 + gamma)
    real = gamma * np.sqrt(rng.gamma(n, size=shape)) + np.sqrt(0.5 * noise) * rng.standard_normal(shape)
    common = real**2 + 0.5 * noise * rng.standard_normal(shape) ** 2
    rest = noise * rng.gamma(n - 1.0, size=shape)
    return np.sqrt(common / (common + rest))
