"""
Exact statistics of the multilook interferometric phase about its true value.

The phase is that of `gamma sqrt(G) + sqrt(1 - gamma^2) w` with `G ~ Gamma(L, 1)` and `w ~ CN(0, 1)`.
`looks` L is real, 1 to 1e9, `coherence` gamma a magnitude in [0, 1]; they broadcast with all other
arguments, and outside these ranges the result is NaN. At full coherence the phase is exactly zero. Source:
theory section 4.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import ArrayLike
from scipy.special import betainc, betaincc

from .conventions import MOST_LOOKS, Floats, checked_looks_and_coherence, signal_strength, within
from .crlb import depth_of_phase, phase_crlb

STEP = 0.14


def _arguments(first: ArrayLike, looks: ArrayLike, coherence: ArrayLike) -> tuple[Floats, Floats, Floats]:
    n, gamma = within(looks, 1.0, MOST_LOOKS), within(coherence, 0.0, 1.0)
    a, b, c = np.broadcast_arrays(np.asarray(first, dtype=np.float64), n, gamma)
    return a, b, c


def multilook_phase_pdf(phase: ArrayLike, looks: ArrayLike, coherence: ArrayLike) -> Floats:
    """
    Density [1/rad] of the multilook phase error at `phase` [rad]; 2 pi periodic, infinite at zero for gamma
    = 1.

    `(L - 1/2) / (4 pi) (1 - gamma^2)^L y^(-L-1/2) int_0^inf s (y + s)^(L-3/2) (1 + s)^(-2L) ds` with
    `y = (1 - gamma) / 2 + gamma sin^2(phase / 2)`: Euler's integral of `2F1(2, 2L; L + 3/2; 1 - y)`. Relative
    error below 1e-7.
    Source: theory section 4.

    Parameters
    ----------
    phase
        Any phase error [rad].
    looks, coherence
        Independent looks, real, 1 to 1e9; coherence magnitude, 0 to 1. NaN elsewhere.

    Returns
    -------
    ndarray
        In 1/rad; of the broadcast shape.
    """
    phi, n, gamma = _arguments(phase, looks, coherence)
    y = 0.5 * (1.0 - gamma) + gamma * np.sin(0.5 * phi) ** 2
    certain = gamma == 1.0
    y = np.where(certain, 0.5, y)
    with np.errstate(divide="ignore"):
        scale = np.log1p(-gamma) + np.log1p(gamma) - np.log(y)
    log_pdf = n * scale - 0.5 * np.log(y) + np.log((n - 0.5) / (4.0 * np.pi)) + _log_euler_integral(y, n)
    return np.where(certain & (np.sin(0.5 * phi) == 0.0), np.inf, np.exp(log_pdf))


def _log_euler_integral(y: Floats, n: Floats) -> Floats:
    """Log of `int_0^inf s (y + s)^(n-3/2) (1 + s)^(-2n) ds`, on sinh steps of log s about the peak."""
    b = n + 0.5 - 2.0 * y * (n - 1.0)
    root = np.sqrt(b * b + 8.0 * y * (n - 0.5))
    s0 = np.where(b > 0.0, (b + root) / (2.0 * n - 1.0), 4.0 * y / np.where(b > 0.0, 1.0, root - b))
    width = 1.0 / np.sqrt(2.0 * n * s0 / (1.0 + s0) ** 2 - (n - 1.5) * y * s0 / (y + s0) ** 2)
    near, far = s0 / (y + s0), s0 / (1.0 + s0)
    total = np.zeros_like(y)
    for w in STEP * np.arange(-41, 42):
        v = width * np.sinh(w)
        step = np.expm1(np.minimum(v, 300.0))
        power = 2.0 * v + (n - 1.5) * np.log1p(near * step) - 2.0 * n * np.log1p(far * step)
        total += np.cosh(w) * np.exp(power)
    peak = 2.0 * np.log(s0) + (n - 1.5) * np.log(y + s0) - 2.0 * n * np.log1p(s0)
    result: Floats = peak + np.log(STEP * width * total)
    return result


def multilook_phase_cdf(phase: ArrayLike, looks: ArrayLike, coherence: ArrayLike) -> Floats:
    """
    Probability that the multilook phase error is below `phase` [rad], in [-pi, pi]; NaN beyond.

    Relative error below 1e-6, also in the lower tail; `1 - cdf(phase)` is `cdf(-phase)`.
    Source: the phase of a constant in Gaussian noise (Craig 1991), averaged over gamma distributed power.

    Parameters
    ----------
    phase
        Phase error [rad], -pi to pi; NaN beyond.
    looks, coherence
        As for `multilook_phase_pdf`.

    Returns
    -------
    ndarray
        Probability, 0 to 1; of the broadcast shape.
    """
    phi, n, gamma = _arguments(within(phase, -np.pi, np.pi), looks, coherence)
    tail = _upper_tail(np.abs(phi), n, gamma)
    return np.where(phi > 0.0, 1.0 - tail, tail)


def _upper_tail(psi: Floats, n: Floats, gamma: Floats) -> Floats:
    """
    Probability of a phase error above psi, in [0, pi].

    `1 / (2 pi) int_0^(pi-psi) (1 + q sin^2 psi / sin^2 theta)^-L dtheta`, `q = gamma^2 / (1 - gamma^2)`:
    Craig's form of the phase of a constant in Gaussian noise, averaged over the gamma distributed power.
    """
    strength = signal_strength(gamma) * np.sin(psi) ** 2
    beyond = _sector(np.minimum(np.pi - psi, psi), n, strength)
    # Student's distribution: the sign of a normal variate about a root of gamma power.
    half_plane = 0.5 * np.where(
        strength < 1.0, betaincc(0.5, n, strength / (1.0 + strength)), betainc(n, 0.5, 1.0 / (1.0 + strength))
    )
    tail = np.where(psi < 0.5 * np.pi, half_plane - beyond, beyond)
    return np.where(gamma == 1.0, np.where(psi == 0.0, 0.5, 0.0 * psi), tail)


def _sector(end: Floats, n: Floats, strength: Floats) -> Floats:
    """`1 / (2 pi) int_0^end (1 + strength / sin^2 theta)^-n dtheta` for end <= pi/2, by tanh-sinh steps."""
    total = np.zeros_like(end)
    for share, weight in tanh_sinh():
        sine2 = np.sin(end * share) ** 2
        with np.errstate(divide="ignore", invalid="ignore"):
            ratio = np.where(strength == 0.0, 0.0, strength / sine2)
        total += weight * np.exp(-n * np.log1p(ratio))
    return total * end / (2.0 * np.pi)


def tanh_sinh() -> Iterator[tuple[float, float]]:
    """Nodes and weights of tanh-sinh steps over [0, 1]."""
    step = 0.5 * STEP
    for w in np.arange(-52, 53) * step:
        rise = np.pi * np.sinh(w)
        yield 1.0 / (1.0 + np.exp(-rise)), step * np.pi * np.cosh(w) / (2.0 + 2.0 * np.cosh(rise))


def multilook_phase_std(looks: ArrayLike, coherence: ArrayLike) -> Floats:
    """
    Standard deviation [rad] of the multilook phase error about its true value, within (-pi, pi].

    `sigma^2 = 1/2 int_0^1 (1 + q x)^-L (-ln(1 - x)) dx / x + 1/2 int_1^inf (1 + q x)^-L ln((sqrt(x) + 1) /
    (sqrt(x) - 1)) dx / x`, `q = gamma^2 / (1 - gamma^2)`: four times the integral of phase times upper tail, in
    whose double integral `x = sin^2 psi / sin^2 theta` is fixed first. By trapezoids; relative error below 1e-10.
    Source: theory section 4 for the law; the two integrals are derived here.

    Parameters
    ----------
    looks, coherence
        As for `multilook_phase_pdf`.

    Returns
    -------
    ndarray
        In radians; of the broadcast shape.
    """
    _, n, gamma = _arguments(0.0, looks, coherence)
    q = signal_strength(gamma)
    variance = np.zeros_like(n)
    for log_x, below, above in _folded_phase():
        variance += below * np.exp(-n * np.log1p(q * np.exp(-log_x)))
        # Far above one nothing is left of a strong signal, and the power must not overflow.
        variance += above * np.exp(-n * np.log1p(np.minimum(q * np.exp(log_x), 1e300)))
    return np.where(gamma < 1.0, np.sqrt(variance), 0.0 * n * gamma)


def multilook_depth_std(
    looks: ArrayLike,
    coherence: ArrayLike,
    centre_frequency: ArrayLike,
    slant_range: ArrayLike,
    baseline: ArrayLike,
    sound_speed: ArrayLike = 1500.0,
) -> Floats:
    """
    Standard deviation [m] of the depth from the multilook phase, the wrap being known.

    `(r c / D) multilook_phase_std / (2 pi fc)`: what `estimators.bounds.depth_crlb`, which has the same arguments,
    is the bound of.
    Source: theory section 4; the geometry is that of paper B, eq. 3.

    Parameters
    ----------
    looks, coherence
        As for `multilook_phase_pdf`.
    centre_frequency, slant_range, baseline, sound_speed
        As for `depth_crlb`.

    Returns
    -------
    ndarray
        In metres; of the broadcast shape.

    Raises
    ------
    ValueError
        For a frequency, length or speed that is not finite and positive.
    """
    return multilook_phase_std(looks, coherence) * depth_of_phase(centre_frequency, slant_range, baseline, sound_speed)


def _folded_phase() -> Iterator[tuple[float, float, float]]:
    """Steps in `|log x|` with the weights of `x < 1` and `x > 1`, crowded towards x = 1 by `log(1 + exp(w))`."""
    step = 0.35
    for w in np.arange(-36.0, 90.0, step):
        log_x = np.logaddexp(0.0, w)
        width = 0.5 * step / (1.0 + np.exp(-w))
        yield log_x, -width * np.log1p(-np.exp(-log_x)), width * np.log1p(2.0 / np.expm1(0.5 * log_x))


def multilook_phase_quantile(probability: ArrayLike, looks: ArrayLike, coherence: ArrayLike) -> Floats:
    """
    Phase error [rad] that `multilook_phase_cdf` takes to `probability`, in [0, 1]; NaN beyond.

    Newton steps on the log of the tail, kept within a bracket that halves when a step leaves it.
    Source: the inverse of `multilook_phase_cdf`, theory section 4.

    Parameters
    ----------
    probability
        0 to 1; NaN beyond.
    looks, coherence
        As for `multilook_phase_pdf`.

    Returns
    -------
    ndarray
        In radians; of the broadcast shape.
    """
    p, n, gamma = _arguments(within(probability, 0.0, 1.0), looks, coherence)
    goal = np.minimum(p, 1.0 - p)
    low, high = np.zeros_like(p), np.full_like(p, np.pi)
    normal = np.sqrt(-2.0 * np.log(np.maximum(2.0 * goal, 1e-300)))
    psi = np.clip(normal * np.minimum(phase_crlb(n, gamma), 1.0), 0.0, 3.0)
    for _ in range(80):
        tail = _upper_tail(psi, n, gamma)
        below = tail > goal
        low, high = np.where(below, psi, low), np.where(below, high, psi)
        with np.errstate(divide="ignore", invalid="ignore"):
            step = tail * np.log(tail / goal) / multilook_phase_pdf(psi, n, gamma)
        proposal = psi + step
        inside = (proposal > low) & (proposal < high)
        # The geometric middle finds small phases in few halvings.
        middle = np.where(low > 0.0, np.sqrt(low * high), 1e-3 * high)
        following = np.where(inside, proposal, middle)
        done = np.abs(following - psi) <= 1e-13 * psi
        psi = following
        if np.all(done | np.isnan(goal)):
            break
    psi = np.where(goal == 0.0, np.pi, np.where(goal == 0.5, 0.0, psi))
    psi = np.where(gamma == 1.0, 0.0, psi + 0.0 * (p + n + gamma))
    return np.where(p < 0.5, -psi, psi)


def sample_multilook_phase(
    looks: ArrayLike,
    coherence: ArrayLike,
    *,
    rng: np.random.Generator,
    size: int | tuple[int, ...] | None = None,
) -> Floats:
    """
    Exact draws [rad] of the multilook phase error, `arg(gamma sqrt(G) + sqrt(1 - gamma^2) w)`.

    Source: theory section 4.

    Parameters
    ----------
    looks, coherence
        Independent looks, real, 1 to 1e9; coherence magnitude, 0 to 1.
    rng
        The only source of chance.
    size
        Shape of the result; the broadcast shape of looks and coherence where None.

    Returns
    -------
    ndarray
        In radians; of that shape.

    Raises
    ------
    ValueError
        For looks or a coherence outside these limits.
    """
    n, gamma = checked_looks_and_coherence(looks, coherence)
    shape = n.shape if size is None else size
    amplitude = np.sqrt(rng.gamma(n, size=shape))
    noise = np.sqrt(0.5 * (1.0 - gamma) * (1.0 + gamma))
    real = gamma * amplitude + noise * rng.standard_normal(shape)
    return np.arctan2(noise * rng.standard_normal(shape), real)
