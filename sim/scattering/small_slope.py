"""Backscatter of a rough elastic solid in the small-slope approximation, with perturbation volume scattering.

After APL-UW TM 2-00 and Jackson and Richardson, High-Frequency Seafloor Acoustics (2007), in backscatter. Grazing
angles `t` in (0, pi / 2] rad and wavenumbers `k` [1/m] broadcast; results are power ratios per unit area and solid
angle. Speeds are relative to water and hold losses: `a_p = nu_p / (1 + i d_p)`, `a_t = nu_t / (1 + i d_t)`. Everything
is written in `a_t T = sqrt(1 - a_t^2 cos^2 t)`, so that a fluid, `a_t = 0`, is no special case.
"""

from typing import NamedTuple

import numpy as np

from sim.band import Complex, Real
from sim.scattering.roughness import exp_within, log_structure_integral, structure_constant
from sim.sediment import ElasticBed

LIMITS = {
    "density_ratio": (1.0, 3.0),
    "compressional_speed_ratio": (0.8, 3.0),
    "compressional_loss": (0.0, 0.1),
    "spectral_exponent": (2.4, 3.9),
}
"""Ranges of the parameters for which results were checked."""

FREQUENCIES = (20e3, 300e3)
"""Frequencies of the reference outputs that the model was checked against [Hz]."""

SATURATION = 0.1
"""Largest cross section of the volume: the reference outputs give `1 / (1 / 0.1 + 1 / s)`."""

VERTICAL = 1e-12
"""Least horizontal wavenumber over `2 k`: nearer to the vertical the cross section has reached its limit."""


class Solid(NamedTuple):
    """Waves in the sediment for a plane wave in the water, by grazing angle."""

    cosine: Real
    sine: Real
    ap: complex
    at: complex
    p: Complex
    """Vertical wavenumber of the compressional wave over `k`, `P = sqrt(a_p^-2 - cos^2 t)`."""
    att: Complex
    """`a_t T`, `T` that of the shear wave."""
    c2: Complex
    """`2 a_t^2 cos^2 t - 1`."""
    z: Complex
    """Impedance of sediment over water."""
    v: Complex
    """Reflection coefficient."""


def solid(bed: ElasticBed, angle: Real) -> Solid:
    """Refraction into an elastic sediment.

    `Z = rho sin t (C2^2 / P + S2^2 / T)` with `C2 = 2 a_t^2 cos^2 t - 1`, `S2^2 = 1 - C2^2 = 4 a_t^4 cos^2 t T^2`;
    `V = (Z - 1) / (Z + 1)`.
    """
    cosine, sine = np.cos(angle), np.sin(angle)
    ap = bed.compressional_speed_ratio / (1 + 1j * bed.compressional_loss)
    at = bed.shear_speed_ratio / (1 + 1j * bed.shear_loss)
    p = np.sqrt(ap**-2 - cosine**2)
    att = np.sqrt(1 - at**2 * cosine**2)
    c2 = 2 * at**2 * cosine**2 - 1
    z = bed.density_ratio * sine * (c2**2 / p + 4 * at**3 * cosine**2 * att)
    return Solid(cosine, sine, ap, at, p, att, c2, z, (z - 1) / (z + 1))


def reflection(bed: ElasticBed, angle: Real) -> Complex:
    """Plane-wave reflection coefficient `V`."""
    return solid(bed, angle).v


def roughness(bed: ElasticBed, angle: Real, k: Real) -> Real:
    """Cross section of the rough surface.

    `|A|^2 / (2 pi q^2 q3^2) int_0^inf J0(u) exp(-p u^(2 alpha)) u du` with `q = 2 k cos t`, `q3 = 2 k sin t` and
    `p = Ch2 q3^2 q^(-2 alpha) / 2`; `|A|^2 W(q)` for a small p.
    """
    alpha = bed.spectral_exponent / 2 - 1
    constant = structure_constant(bed.spectral_strength_si, bed.spectral_exponent)
    log_q = np.log(2 * k) + np.log(np.maximum(np.cos(angle), VERTICAL))
    log_q3 = np.log(2 * k * np.sin(angle))
    log_p = np.log(constant / 2) + 2 * log_q3 - 2 * alpha * log_q
    log_integral = log_structure_integral(log_p, alpha)
    amplitude2 = np.abs(_amplitude(bed, angle)) ** 2 * (k**2 / 2) ** 2
    section: Real = amplitude2 / (2 * np.pi) * exp_within(log_integral - 2 * (log_q + log_q3))
    return section


def _amplitude(bed: ElasticBed, angle: Real) -> Complex:
    """First-order perturbation amplitude over `k^2 / 2`, in backscatter, where the two mixed terms are equal."""
    w, rho = solid(bed, angle), bed.density_ratio
    c2, c4, at2 = w.cosine**2, w.cosine**4, w.at**2
    both = w.c2**2
    d1 = -1 - c2 + 1 / (w.ap**2 * rho * both) + ((1 - 6 * at2 * c2) * c2 - 2 * at2 * c4) / (rho * both)
    d2 = -4 * w.at**3 * w.sine * w.att * (w.p**2 * c2 - 2 * c4) / both
    shear = -2 * (1 + 2 * at2 * c2) * c2 - 4 * at2 * c4 * (1 - 2 * at2 / w.ap**2)
    d4 = (2 * at2 * rho * w.att**2 * shear / both - (rho - 1)) * w.sine**2
    amplitude: Complex = d1 * (1 + w.v) ** 2 + 2 * d2 * (1 - w.v**2) + d4 * (1 - w.v) ** 2
    return amplitude


def volume(bed: ElasticBed, angle: Real, k: Real) -> Real:
    """Cross section of the volume by first-order perturbation, saturated.

    `(pi / 2) Re sum_ab s_a s_b M_a M_b* W_ab i / (K_a - K_b*)` over the pairs of waves a, b of `_pairs`;
    `W_ab = w3 k^(3 - g3) / (q^2 + [Re(K_a + K_b) / 2]^2 + 1e-6)^(g3 / 2)`. Lengths are in units of `1 / k`. It equals
    the published fluid form where there is no shear.
    """
    w = solid(bed, angle)
    pairs = _pairs(bed, w)
    q2 = 4 * w.cosine**2
    section = np.zeros(np.shape(angle))
    for strength_a, vertical_a in pairs:
        for strength_b, vertical_b in pairs:
            wavenumber2 = q2 + (vertical_a + vertical_b).real ** 2 / 4 + 1e-6
            response = strength_a * strength_b.conj() * 1j / (vertical_a - vertical_b.conj())
            section = section + response.real * wavenumber2 ** (-bed.volume_exponent / 2)
    section = section * (np.pi / 2) * bed.volume_strength * k ** (3 - bed.volume_exponent)
    saturated: Real = section / (1 + section / SATURATION)
    return saturated


def _pairs(bed: ElasticBed, w: Solid) -> list[tuple[Complex, Complex]]:
    """`s M` and `K` of the pairs of waves by which sound comes in and, by reciprocity, goes out: PP, PS, SP, SS.

    `M = drho u.w + dlambda (k.u)(h.w) + dmu [(k.h)(u.w) + (k.w)(h.u)]` for the waves (k, u) and (h, w), without
    conjugation; `s = -1` for PS and SP; `K` is the sum of both vertical wavenumbers.
    """
    rho = bed.density_ratio
    density = rho * bed.density_fluctuation
    mu = w.at**2 * (density + 2 * rho * bed.shear_speed_fluctuation)
    lame = w.ap**2 * (density + 2 * rho * bed.compressional_speed_fluctuation) - 2 * mu
    pairs = []
    for one in _waves(w):
        for other in _waves(w):
            along = _dot(one.u, other.u)
            crossed = _dot(one.k, other.k) * along + _dot(one.k, other.u) * _dot(other.k, one.u)
            strength = density * along + lame * _dot(one.k, one.u) * _dot(other.k, other.u) + mu * crossed
            pairs.append((one.sign * other.sign * strength, one.vertical + other.vertical))
    return pairs


class Wave(NamedTuple):
    """A wave in the sediment: wavenumber and displacement (horizontal, up), shape (2, ...)."""

    k: Complex
    u: Complex
    vertical: Complex
    sign: int


def _waves(w: Solid) -> list[Wave]:
    """The compressional and the shear wave that a plane wave sends into the sediment; a fluid bears the first alone.

    `k_P = (cos t, -P)`, `u_P = i a k_P`, `k_S = (cos t, -T)`, `u_S = i b (T, cos t)`, z up, with
    `a = -(1 + V) C2 sin t / (P Z)` and `b = 2 cos t P a_t^2 a / C2`.
    """
    cosine = w.cosine + 0j
    a = -(1 + w.v) * w.c2 * w.sine / (w.p * w.z)
    compressional = np.stack([cosine, -w.p])
    waves = [Wave(compressional, 1j * a * compressional, w.p, 1)]
    if w.at != 0:
        t = w.att / w.at
        b = 2 * w.cosine * w.p * w.at**2 * a / w.c2
        waves.append(Wave(np.stack([cosine, -t]), 1j * b * np.stack([t, cosine]), t, -1))
    return waves


def _dot(x: Complex, y: Complex) -> Complex:
    product: Complex = (x * y).sum(axis=0)
    return product
