"""Backscatter of a rough fluid with volume scattering: the model of APL-UW TR 9407 (Jackson), section IV.

Grazing angles `th` in (0, pi / 2] rad and wavenumbers `k` [1/m] broadcast; results are power ratios per unit area and
solid angle. `kappa = (1 + i delta) / nu`, `P = sqrt(kappa^2 - cos^2 th)`, `alpha = gamma / 2 - 1`.
"""

from collections.abc import Callable

import numpy as np
from scipy.special import erfc, expit, gammaln

from sim.band import Complex, Real
from sim.scattering.roughness import exp_within, structure_constant
from sim.sediment import FluidBed

LIMITS = {
    "density_ratio": (1.0, 3.0),
    "sound_speed_ratio": (0.8, 3.0),
    "loss_parameter": (0.0, 0.1),
    "volume_parameter": (0.0, 0.02),
    "spectral_exponent": (2.4, 3.9),
    "spectral_strength_cm4": (0.0, 1.0),
}
"""Ranges of the parameters that the handbook states."""

FREQUENCIES = (10e3, 100e3)
"""Frequencies that the handbook states [Hz]."""

SLOPES = (1e-12, 1e6)
"""Bounds of the rms slope, for numbers' sake."""

SLOPE_NODES = ((1.224745, 0.295410), (0.0, 1.181636), (-1.224745, 0.295410))
"""Offsets in rms slopes and weights of the average over the slope of large roughness, times sqrt(pi)."""


def reflection(bed: FluidBed, angle: Real) -> Complex:
    """Plane-wave reflection coefficient `R = (Y - 1) / (Y + 1)`, `Y = rho sin th / P`."""
    ratio = bed.density_ratio * np.sin(angle) / _vertical(bed, angle)
    coefficient: Complex = (ratio - 1) / (ratio + 1)
    return coefficient


def roughness(bed: FluidBed, angle: Real, k: Real) -> Real:
    """Cross section of the rough surface: Kirchhoff near the vertical, composite roughness beyond, rocks apart.

    The blends are logistic: in `cos th`, 0.0125 wide, and in the rms slope, 0.5 degrees wide around 7 degrees.
    """
    slope = _rms_slope(bed, k)
    kirchhoff, change = _kirchhoff(bed, angle, k)
    composite = _shadowing(angle, slope) * _slope_average(lambda th: _bragg(bed, th, k), angle, slope)
    moderate = _blend((np.cos(angle) - change) / 0.0125, kirchhoff, composite)
    return _blend((np.degrees(np.arctan(slope)) - 7) / 0.5, moderate, _large_roughness(bed, angle, slope))


def volume(bed: FluidBed, angle: Real, k: Real) -> Real:
    """Cross section of the volume: `S <5 delta sigma2 |1 - R^2|^2 sin^2 th / (nu ln 10 |P|^2 Im P)>`."""

    def smooth(th: Real) -> Real:
        vertical = _vertical(bed, th)
        passed = np.abs(1 - reflection(bed, th) ** 2) ** 2 * np.sin(th) ** 2
        strength = 5 * bed.loss_parameter * bed.volume_parameter / (bed.sound_speed_ratio * np.log(10))
        scattered: Real = strength * passed / (np.abs(vertical) ** 2 * vertical.imag)
        return scattered

    slope = _rms_slope(bed, k)
    return _shadowing(angle, slope) * _slope_average(smooth, angle, slope)


def _wavenumber(bed: FluidBed) -> complex:
    return (1 + 1j * bed.loss_parameter) / bed.sound_speed_ratio


def _vertical(bed: FluidBed, angle: Real) -> Complex:
    """Vertical wavenumber in the sediment over `k`, `P`."""
    vertical: Complex = np.sqrt(_wavenumber(bed) ** 2 - np.cos(angle) ** 2)
    return vertical


def _rms_slope(bed: FluidBed, k: Real) -> Real:
    """Rms slope of large roughness: `s^2 = (2 pi w)^(1/alpha) / (2 (1-alpha)) (k^2 / alpha)^((1-alpha)/alpha)`."""
    alpha = bed.spectral_exponent / 2 - 1
    log_scale = np.log(2 * np.pi * bed.spectral_strength_si) / alpha - np.log(2 * (1 - alpha))
    log_slope2 = log_scale + (2 * np.log(k) - np.log(alpha)) * (1 - alpha) / alpha
    slope: Real = np.clip(exp_within(log_slope2 / 2), *SLOPES)
    return slope


def _kirchhoff(bed: FluidBed, angle: Real, k: Real) -> tuple[Real, Real]:
    """Cross section in the Kirchhoff approximation, and the `cos th` at which it hands over.

    `b qc |R(90°)|^2 / (8 pi [cos^(4 alpha) th + a qc^2 sin^4 th]^((1 + alpha) / (2 alpha)))` with
    `qc = Ch2 2^(1 - 2 alpha) k^(2 (1 - alpha))`. The handbook prints a minus in the exponent's denominator; the plus
    follows from the exact integral and gives its table.
    """
    alpha = bed.spectral_exponent / 2 - 1
    half = 1 / (2 * alpha)
    log_a = 2 * alpha * (np.log(8 * alpha**2) + gammaln(half + 0.5) - gammaln([0.5, 2 * half, half]).sum())
    log_b = (0.5 + half) * log_a + gammaln(1 / alpha) - np.log(2 * alpha)
    constant = structure_constant(bed.spectral_strength_si, bed.spectral_exponent)
    log_qc = np.log(constant) + (1 - 2 * alpha) * np.log(2) + 2 * (1 - alpha) * np.log(k)
    nadir = np.abs(reflection(bed, np.asarray(np.pi / 2))) ** 2
    log_spread = np.logaddexp(4 * alpha * np.log(np.cos(angle)), log_a + 2 * log_qc + 4 * np.log(np.sin(angle)))
    section = nadir / (8 * np.pi) * exp_within(log_b + log_qc - log_spread * (1 + alpha) / (2 * alpha))
    log_c4 = np.log(1000) / (1 + alpha) + (log_a + 2 * log_qc) / alpha
    return section, np.exp(-np.logaddexp(-log_c4, np.log(4)) / 4)


def _bragg(bed: FluidBed, angle: Real, k: Real) -> Real:
    """Small-roughness perturbation: `4 k^4 sin^4 th |Y|^2 W(K)`, `K^2 = 4 k^2 cos^2 th + (k / 10)^2`."""
    rho = bed.density_ratio
    cosine2, sine = np.cos(angle) ** 2, np.sin(angle)
    amplitude = ((rho - 1) ** 2 * cosine2 + rho**2 - _wavenumber(bed) ** 2) / (rho * sine + _vertical(bed, angle)) ** 2
    spectrum = bed.spectral_strength_si * (k * np.sqrt(4 * cosine2 + 0.01)) ** -bed.spectral_exponent
    section: Real = 4 * k**4 * sine**4 * np.abs(amplitude) ** 2 * spectrum
    return section


def _slope_average(section: Callable[[Real], Real], angle: Real, slope: Real) -> Real:
    """Average over the slope of large roughness by three nodes; angles are held within 0 to 90 degrees."""
    parts = [weight * section(np.clip(angle - offset * slope, 0.0, np.pi / 2)) for offset, weight in SLOPE_NODES]
    average: Real = sum(parts) / np.sqrt(np.pi)
    return average


def _shadowing(angle: Real, slope: Real) -> Real:
    """Share of the surface that is lit: `(1 - exp(-2 Q)) / (2 Q)`, `Q = (exp(-t^2) / sqrt(pi) - t erfc t) / (4 t)`."""
    t = np.minimum(np.tan(angle) / slope, 3.0)
    q = (np.exp(-(t**2)) / np.sqrt(np.pi) - t * erfc(t)) / (4 * t)
    share: Real = np.where(t > 2, 1.0, -np.expm1(-2 * q) / np.where(t > 2, 1.0, 2 * q))
    return share


def _large_roughness(bed: FluidBed, angle: Real, slope: Real) -> Real:
    """Empirical cross section of rock and gravel, in terms of the critical angle and the rms slope."""
    rho, nu = bed.density_ratio, bed.sound_speed_ratio
    critical = np.degrees(np.arccos(1 / nu)) if nu >= 1.001 else 2.5613
    degrees, slope_degrees = np.degrees(angle), np.degrees(slope)
    c = 1 + 0.81 * (critical / degrees) ** 2
    interface = (
        0.04682 * slope**1.25 * nu**3.25 * ((1 - 2 / rho) / nu**2 + 1) ** 2 / (1 + 3.54 * slope_degrees / critical)
    )
    low = interface * np.sin(np.pi / c) ** (0.7263 * slope ** (-1 / 3))
    nadir = np.abs(reflection(bed, np.asarray(np.pi / 2))) ** 2
    facets = (1 + (degrees - 90) ** 2 / (2.6 * slope_degrees**2)) ** 1.9
    section: Real = low + 0.0260 * nadir / (slope**2 * facets * c)
    return section


def _blend(x: Real, low: Real, high: Real) -> Real:
    """`f low + (1 - f) high` with `f = 1 / (1 + e^x)`."""
    share = expit(-np.clip(x, -40, 40))
    blended: Real = share * low + (1 - share) * high
    return blended
