"""Bounds, geometry and the seabed at the extremes, against 50 digits of the same formulas in decimal arithmetic."""

from collections.abc import Iterator
from dataclasses import replace
from decimal import Decimal, localcontext
from typing import Any, get_args

import numpy as np

from estimators import bounds
from sim import SEDIMENTS, Scene, Sonar, reflection_loss, scattering_strength, simulate
from sim.coherence import noise_coherence
from sim.geometry import plane_delay
from sim.scattering.strength import Model

LOOKS = 33
SNRS = (-60.0, -30.0, 0.0, 30.0, 60.0, 90.0, 120.0)
ANGLES = (0.01, 0.1, 1.0, 10.0, 45.0, 90.0)
SEDIMENT = "coarse sand"

RELATIVE = 1e-9
"""Relative error that counts as exact."""

PI = Decimal("3.14159265358979323846264338327950288419716939937510582")

Number = tuple[Decimal, Decimal]
"""A complex one."""


def functions(sonar: Sonar, rng: np.random.Generator) -> list[dict[str, Any]]:
    """One row for each function and value, as of `measure`."""
    with localcontext() as context:
        context.prec = 60
        return [*_of_snr(sonar), *_of_no_coherence(), *_of_angle(sonar, rng)]


def _row(case: str, value: float, name: str, found: float, reference: Decimal | None) -> dict[str, Any]:
    row = {"case": case, "value": value, "estimator": name, "estimates": 1, "valid": 1, "found": found, "said": ""}
    if not np.isfinite(found):
        return {**row, "verdict": "fails"}
    if reference is None:
        return {**row, "verdict": "as claimed"}
    error = float(abs(Decimal(found) - reference) / abs(reference)) if reference else abs(found)
    verdict = "exact" if error <= RELATIVE else "fails"
    return {**row, "theory": float(reference), "reference_error": error, "verdict": verdict}


def _of_snr(sonar: Sonar) -> Iterator[dict[str, Any]]:
    for snr in SNRS:
        gamma = float(noise_coherence(snr))
        power = Decimal(10) ** (Decimal(snr) / 10)
        case = "SNR [dB]", snr
        yield _row(*case, "noise-coherence", gamma, power / (1 + power))
        square = Decimal(gamma) ** 2
        phase = ((1 - square) / (2 * LOOKS * square)).sqrt()
        fc, band = Decimal(sonar.centre_frequency), Decimal(sonar.bandwidth)
        group = phase * Decimal(12).sqrt() / (2 * PI * band)
        coherent = phase / (2 * PI * (fc**2 + band**2 / 12).sqrt())
        given = sonar.centre_frequency, sonar.bandwidth
        split = group * Decimal(9).sqrt() / Decimal(8).sqrt()
        yield _row(*case, "phase-crlb", float(bounds.phase_crlb(LOOKS, gamma)), phase)
        yield _row(*case, "group-delay-crlb", float(bounds.group_delay_crlb(LOOKS, gamma, given[1])), group)
        yield _row(*case, "coherent-delay-crlb", float(bounds.coherent_delay_crlb(LOOKS, gamma, *given)), coherent)
        third = bounds.split_spectrum_crlb(LOOKS, gamma, given[1], given[1] / 3)
        yield _row(*case, "split-spectrum-crlb", float(third), split)
        relative = sonar.bandwidth / sonar.centre_frequency
        yield _row(*case, "wrap-error-probability", float(bounds.wrap_error_probability(LOOKS, gamma, relative)), None)
        width = 20 * sonar.wrap
        yield _row(*case, "ziv-zakai", float(bounds.ziv_zakai_delay_std(LOOKS, gamma, *given, width)), None)


def _of_no_coherence() -> Iterator[dict[str, Any]]:
    """The floor of the sample coherence, `sqrt(pi) / 2 Gamma(N) / Gamma(N + 1/2)`, and a phase even over the circle."""
    floor = Decimal(1)
    for n in range(1, LOOKS):
        floor *= Decimal(n) / (Decimal(n) + Decimal("0.5"))
    yield _row("coherence", 0.0, "sample-coherence-mean", float(bounds.sample_coherence_mean(LOOKS, 0.0)), floor)
    yield _row(
        "coherence", 0.0, "multilook-phase-std", float(bounds.multilook_phase_std(LOOKS, 0.0)), PI / Decimal(3).sqrt()
    )
    yield _row("coherence", 1.0, "phase-crlb", float(bounds.phase_crlb(LOOKS, 1.0)), Decimal(0))
    yield _row("coherence", 1.0, "multilook-phase-std", float(bounds.multilook_phase_std(LOOKS, 1.0)), Decimal(0))


def _of_angle(sonar: Sonar, rng: np.random.Generator) -> Iterator[dict[str, Any]]:
    for angle in ANGLES:
        case = "grazing angle [degrees]", angle
        sine, cosine = _sine_cosine(Decimal(angle) * PI / 180)
        time = 2 * sonar.altitude / float(sine) / sonar.sound_speed
        slant = Decimal(time) * Decimal(sonar.sound_speed) / 2
        baseline, altitude = Decimal(sonar.baseline), Decimal(sonar.altitude)
        delay = ((slant**2 + baseline**2 + 2 * baseline * altitude).sqrt() - slant) / Decimal(sonar.sound_speed)
        yield _row(*case, "plane-delay", float(plane_delay(sonar, time)), delay)
        loss = float(reflection_loss(SEDIMENT, angle))
        yield _row(*case, "reflection-loss", loss, _loss(sine, cosine))
        for model in get_args(Model):
            strength = scattering_strength(SEDIMENT, angle, sonar.centre_frequency, model=model)
            yield _row(*case, f"scattering-strength {model}", float(strength), None)
        yield _simulated(case, sonar, rng)


def _simulated(case: tuple[str, float], sonar: Sonar, rng: np.random.Generator) -> dict[str, Any]:
    """A flat seabed a metre below the sonar: as it is registered to the plane, its delay is zero."""
    low = replace(sonar, altitude=1.0)
    ground = max(1.0 / np.tan(np.radians(case[1])), 0.0)
    pair = simulate(Scene((ground, ground + 3.0), sediment=SEDIMENT), low, rng=rng, rows=2)
    assert pair.truth is not None
    there = np.isfinite(pair.truth.delay)
    worst = float(np.abs(pair.truth.delay[there]).max()) / sonar.wrap if there.any() else np.nan
    finite = np.isfinite(pair.primary).all() and np.isfinite(pair.secondary).all()
    return _row(*case, "simulate", worst if finite else np.nan, Decimal(0))


def _loss(sine: Decimal, cosine: Decimal) -> Decimal:
    """`-20 log10 |R|` of a fluid (TR 9407): `R = (Y - 1) / (Y + 1)` with `Y = rho sin / sqrt(kappa^2 - cos^2)`."""
    fluid = SEDIMENTS[SEDIMENT].fluid
    density, speed, loss = (Decimal(x) for x in (fluid.density_ratio, fluid.sound_speed_ratio, fluid.loss_parameter))
    kappa = 1 / speed, loss / speed
    square = kappa[0] ** 2 - kappa[1] ** 2 - cosine**2, 2 * kappa[0] * kappa[1]
    root = _complex_root(square)
    # |Y - 1|^2 / |Y + 1|^2 with Y = rho sin / P, times |P|^2.
    parts = [(density * sine - sign * root[0]) ** 2 + root[1] ** 2 for sign in (1, -1)]
    return -10 * (parts[0] / parts[1]).log10()


def _complex_root(square: Number) -> Number:
    magnitude = (square[0] ** 2 + square[1] ** 2).sqrt()
    real = ((magnitude + square[0]) / 2).sqrt()
    return real, square[1] / (2 * real)


def _sine_cosine(angle: Decimal) -> tuple[Decimal, Decimal]:
    sine = _series(angle, angle)
    return sine, _series(Decimal(1), angle)


def _series(term: Decimal, angle: Decimal) -> Decimal:
    """Taylor's, of the sine from `angle` and of the cosine from 1."""
    total, power = Decimal(0), 0 if term == 1 else 1
    while abs(term) > Decimal(10) ** -58:
        total += term
        term *= -(angle**2) / ((power + 1) * (power + 2))
        power += 2
    return total
