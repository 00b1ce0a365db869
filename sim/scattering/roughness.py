"""Power-law roughness, and the integral over its structure function that the small-slope model needs."""

from functools import lru_cache

import numpy as np
from scipy.interpolate import BSpline, make_interp_spline
from scipy.special import gamma, gammaln, kve

from sim.band import Real

STEP = 0.06
"""Step of the trapezoid in the logarithm of the wavenumber."""

LOWEST, HIGHEST = -25.0, 25.0
"""Range of the table in the logarithm of the structure parameter; beyond it one term of a series holds to 1e-10."""


def structure_constant(strength: float, exponent: float) -> float:
    """`Ch2` of the structure function `Ch2 x^(2 alpha)` of a surface with the spectrum `W(K) = w K^-gamma`.

    `Ch2 = 2 pi w Γ(2 - alpha) 2^(-2 alpha) / (alpha (1 - alpha) Γ(1 + alpha))`, `alpha = gamma / 2 - 1` (TR 9407).

    Parameters
    ----------
    strength
        `w` in SI units [m^(4 - gamma)].
    exponent
        `gamma`, between 2 and 4.

    Returns
    -------
    float
        `Ch2` [m^(2 - 2 alpha)].
    """
    alpha = exponent / 2 - 1
    return float(2 * np.pi * strength * gamma(2 - alpha) * 4.0**-alpha / (alpha * (1 - alpha) * gamma(1 + alpha)))


def exp_within(logarithm: Real) -> Real:
    """`exp` within 1e-300 to 1e300: surfaces so smooth or so rough that a cross section leaves this have no meaning."""
    value: Real = np.exp(np.clip(logarithm, -690.0, 690.0))
    return value


def structure_integral(log_parameter: Real, alpha: float) -> Real:
    """`ln int_0^inf J0(u) exp(-p u^(2 alpha)) u du` against `ln p`, by quadrature.

    J0 is the real part of the Hankel function `H0`, and the path is turned into the upper half plane,
    `u = t e^(i psi)`, where both factors fall off: `psi = pi / (8 alpha)`, at most `pi / 2`. Along `t = e^x` the
    trapezoidal rule then converges exponentially. Below p = 1, where the integral falls with p, `exp - 1` is
    integrated: the real part of `int H0(u) u du` is 0.

    Relative accuracy, against series summed in high precision: 1e-12 for alpha 0.2 to 0.95 and all p, 3e-11
    from 0.05 to 0.995.

    Parameters
    ----------
    log_parameter
        `ln p`, shape (n,).
    alpha
        Between 0.05 and 0.995; the quadrature fails at 0.
    """
    turn = min(np.pi / 2, np.pi / (8 * alpha))
    lowest = min(0.0, float(-log_parameter.max() / (2 * alpha))) - 20.0
    x = np.arange(lowest, np.log(45 / np.sin(turn)), STEP)
    u = np.exp(x + 1j * turn)
    # H0(u) = -(2i / pi) K0(-iu)
    weight = -2j / np.pi * kve(0, -1j * u) * np.exp(1j * u) * u**2 * STEP
    exponent = -np.exp(log_parameter[:, None] + 2 * alpha * (x + 1j * turn))
    change = np.where(log_parameter[:, None] < 0, np.expm1(exponent), np.exp(exponent))
    integral: Real = np.log((change @ weight).real)
    return integral


@lru_cache(maxsize=64)
def _table(alpha: float) -> BSpline:
    """The integral over the range of the table as a spline of degree 7."""
    points = np.linspace(LOWEST, HIGHEST, 501)
    return make_interp_spline(points, structure_integral(points, alpha), k=7)


def log_structure_integral(log_parameter: Real, alpha: float) -> Real:
    """`structure_integral` from a table for each `alpha`; any shape.

    Beyond the table the first term of either series holds: `p 2^(2 alpha + 1) alpha Γ(1 + alpha) / Γ(1 - alpha)` for
    small and `Γ(1 / alpha) / (2 alpha) p^(-1 / alpha)` for large p. Relative accuracy: 1e-8, or 5e-8 dB.
    """
    small = log_parameter + (2 * alpha + 1) * np.log(2) + np.log(alpha) + gammaln(1 + alpha) - gammaln(1 - alpha)
    large = gammaln(1 / alpha) - np.log(2 * alpha) - log_parameter / alpha
    inside = _table(alpha)(np.clip(log_parameter, LOWEST, HIGHEST))
    integral: Real = np.where(log_parameter < LOWEST, small, np.where(log_parameter > HIGHEST, large, inside))
    return integral
