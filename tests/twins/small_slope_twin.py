"""The small-slope model once more: in mpmath, bistatic formulas, series in place of quadrature. Slow."""

import mpmath as mp

from sim import ElasticBed

MOST_TERMS = 200


def integral(p, alpha):
    """`int_0^inf J0(u) exp(-p u^(2 alpha)) u du` by series to 13 digits; ArithmeticError where none gives that.

    In powers of p, which converges for alpha below 1/2, and of `p^(-1/alpha)`, which converges above; each is
    asymptotic on the other side, and then stops at its smallest term. Closed at 1/2.
    """
    if alpha == 0.5:
        p = mp.mpf(p)
        return p / (1 + p**2) ** mp.mpf(1.5)
    with mp.workdps(80):
        for terms in (_powers, _inverse_powers):
            total, largest, smallest = _summed(terms, mp.mpf(p), mp.mpf(alpha))
            if total > 0 and largest / total < mp.mpf(10) ** 60 and smallest / total < mp.mpf(10) ** -13:
                return +total
    raise ArithmeticError(f"p {p}, alpha {alpha}")


def _powers(p, alpha, k):
    k += 1
    return (-p) ** k / mp.factorial(k) * 2 ** (2 * alpha * k + 1) * mp.gamma(1 + alpha * k) * mp.rgamma(-alpha * k)


def _inverse_powers(p, alpha, k):
    scale = (-1) ** k / (mp.mpf(4) ** k * mp.factorial(k) ** 2)
    return scale * mp.gamma((k + 1) / alpha) / (2 * alpha) * p ** (-(k + 1) / alpha)


def _summed(terms, p, alpha):
    """Sum up to the smallest term; the largest and the smallest term. Single terms may vanish at poles."""
    values = [terms(p, alpha, k) for k in range(MOST_TERMS)]
    sizes = [max(abs(value) for value in values[k : k + 6]) for k in range(MOST_TERMS - 6)]
    stop = min(range(len(sizes)), key=sizes.__getitem__)
    return sum(values[:stop], mp.mpf(0)), max(sizes[: stop + 1]), sizes[stop]


def waves(bed, angle):
    rho = mp.mpf(bed.density_ratio)
    ap = bed.compressional_speed_ratio / mp.mpc(1, bed.compressional_loss)
    at = bed.shear_speed_ratio / mp.mpc(1, bed.shear_loss)
    c, s = mp.cos(angle), mp.sin(angle)
    p, t = mp.sqrt(ap**-2 - c**2), mp.sqrt(at**-2 - c**2)
    c2 = 2 * at**2 * c**2 - 1
    s2 = mp.sqrt(1 - c2**2)
    z = rho * s * (c2**2 / p + s2**2 / t)
    return rho, ap, at, c, s, p, t, c2, z, (z - 1) / (z + 1)


def amplitude(bed, angle):
    """`A / (k^2 / 2)`, the four bistatic terms at the azimuth of backscatter."""
    rho, ap, at, c, s, p, t, c2, _, v = waves(bed, angle)
    q = -(c**2)
    both = c2**2
    d1 = -1 + q + 1 / (ap**2 * rho * both)
    d1 -= at**2 * ((at**-2 - 4 * c**2 + 2 * q) * q + 2 * c**4) / (rho * both)
    d2 = -4 * at**4 * s * t * (p**2 * c**2 + (c**2 - q) * q) / both
    d4 = 2 * at**6 * rho * s**2 * t**2 * (2 * (at**-2 - 2 * q) * q - 4 * c**4 * (1 - 2 * at**2 / ap**2)) / both
    d4 -= (rho - 1) * s**2
    return d1 * (1 + v) ** 2 + 2 * d2 * (1 - v) * (1 + v) + d4 * (1 - v) ** 2


def roughness_db(bed, degrees, frequency, sound_speed=1500.0):
    k = 2 * mp.pi * frequency / sound_speed
    angle = mp.radians(mp.mpf(degrees))
    alpha = bed.spectral_exponent / 2 - 1
    constant = (
        2
        * mp.pi
        * bed.spectral_strength_si
        * mp.gamma(2 - alpha)
        * mp.mpf(4) ** -alpha
        / (alpha * (1 - alpha) * mp.gamma(1 + alpha))
    )
    q, q3 = 2 * k * mp.cos(angle), 2 * k * mp.sin(angle)
    whole = integral(constant * q3**2 * q ** (-2 * alpha) / 2, alpha)
    section = abs(amplitude(bed, angle) * k**2 / 2) ** 2 / (2 * mp.pi * q**2 * q3**2) * whole
    return float(10 * mp.log10(section))


def elastic_volume(bed, degrees, k=1.0):
    """Perturbation volume scattering of an elastic solid, before saturation, with vectors of three components."""
    angle = mp.radians(mp.mpf(degrees))
    rho, ap, at, *_ = waves(bed, angle)
    g1, g2, g3 = bed.density_fluctuation, bed.compressional_speed_fluctuation, bed.shear_speed_fluctuation
    density, mu = rho * g1, rho * at**2 * (g1 + 2 * g3)
    lame = rho * ap**2 * (g1 + 2 * g2) - 2 * mu
    incoming = refracted(bed, angle, (1, 0))
    # The scattered wave goes back along (-1, 0); by reciprocity one comes from the receiver along minus that.
    outgoing = refracted(bed, angle, (1, 0))
    pairs = []
    for kind, (k1, u) in incoming.items():
        for other, (h, v) in outgoing.items():
            strength = density * dot(u, v) + lame * dot(k1, u) * dot(h, v)
            strength += mu * (dot(k1, h) * dot(u, v) + dot(k1, v) * dot(h, u))
            pairs.append(((1 if kind == other else -1) * strength, -(k1[2] + h[2])))
    total = mp.mpf(0)
    for one, vertical in pairs:
        for other, beyond in pairs:
            change2 = 4 * mp.cos(angle) ** 2 + (mp.re(vertical + beyond) / 2) ** 2 + mp.mpf(10) ** -6
            spectrum = bed.volume_strength * change2 ** (-mp.mpf(bed.volume_exponent) / 2)
            total += mp.re(one * mp.conj(other) * spectrum * 1j / (vertical - mp.conj(beyond)))
    return float(mp.pi / 2 * total * mp.mpf(k) ** (3 - bed.volume_exponent))


def refracted(bed, angle, along):
    """Wavenumbers and displacements (x, y, z up) of the waves in the sediment, for a wave along `along`."""
    _, _, at, c, s, p, t, c2, z, v = waves(bed, angle)
    a = -(1 + v) * c2 * s / (p * z)
    b = 2 * c * p * at**2 * a / c2

    def vector(horizontal, up):
        return [horizontal * along[0], horizontal * along[1], up]

    kp = vector(c, -p)
    return {
        "P": (kp, [1j * a * part for part in kp]),
        "S": (vector(c, -t), [1j * b * part for part in vector(t, c)]),
    }


def dot(x, y):
    return sum(one * other for one, other in zip(x, y, strict=True))


def fluid(bed, degrees):
    """`cos t`, `sin t`, `kappa`, `P` and `1 + R` of a fluid."""
    angle = mp.radians(mp.mpf(degrees))
    c, s = mp.cos(angle), mp.sin(angle)
    kappa = mp.mpc(1, bed.compressional_loss) / bed.compressional_speed_ratio
    p = mp.sqrt(kappa**2 - c**2)
    y = bed.density_ratio * s / p
    return c, s, kappa, p, 2 * y / (y + 1)


def fluid_volume(bed, degrees):
    """Published fluid form `pi k^3 |1 + V|^4 |Dv|^2 W3 / (4 rho^2 Im 2P)`, before saturation, at the exponent 3."""
    c, _, kappa, p, passed = fluid(bed, degrees)
    change2 = 4 * c**2 + 4 * mp.re(p) ** 2 + mp.mpf(10) ** -6
    spectrum = bed.volume_strength / change2 ** mp.mpf(1.5)
    contrast = kappa**2 + c**2 + p**2
    return float(mp.pi * abs(passed) ** 4 * abs(contrast) ** 2 * spectrum / (8 * bed.density_ratio**2 * mp.im(p)))


def handbook_volume(bed, degrees):
    """TR 9407's `5 delta sigma2 |1 - R^2|^2 sin^2 th / (nu ln 10 |P|^2 Im P)`, without slopes."""
    _, s, _, p, passed = fluid(ElasticBed.of_fluid(bed), degrees)
    section = 5 * bed.loss_parameter * bed.volume_parameter * abs(passed * (2 - passed)) ** 2 * s**2
    return float(section / (bed.sound_speed_ratio * mp.log(10) * abs(p) ** 2 * mp.im(p)))
