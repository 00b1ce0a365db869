"""Scattering strength and reflection loss of a sediment, by either model."""

from typing import Literal, get_args

import numpy as np
from numpy.typing import ArrayLike

from sim import checks
from sim.band import Real
from sim.catalogue import find
from sim.scattering import apl_uw, small_slope
from sim.scattering.validity import check_validity
from sim.sediment import Sediment

Model = Literal["apl-uw", "small-slope"]
Component = Literal["total", "roughness", "volume"]

LEAST_ANGLE = np.radians(1e-6)
"""Grazing angles above 0 count as this at the least [rad]: strengths are below -250 dB there."""


def scattering_strength(
    sediment: Sediment | str,
    grazing_angle: ArrayLike,
    frequency: ArrayLike,
    *,
    model: Model = "apl-uw",
    component: Component = "total",
    sound_speed: float = 1500.0,
) -> Real:
    """Backscattering strength of the seabed, per square metre and steradian [dB].

    `apl-uw` (`sim.scattering.apl_uw`) is stated for 10 to 100 kHz, `small-slope` (`sim.scattering.small_slope`) was
    checked from 20 to 300 kHz; outside these, or the stated ranges of parameters, a `ValidityWarning` is issued once.
    The handbook states errors of about 3 dB for sand and silt above 5 degrees and about 10 dB for gravel and rock.
    Below about 3 degrees `apl-uw` blends into its law of large roughness, where a rougher seabed may be weaker: coarse
    sand at 100 kHz and 1 degree falls from -46.7 to -51.1 dB as its spectral strength rises from .0026 to .0036 cm^4.

    Parameters
    ----------
    sediment
        A sediment, or the name of one in `SEDIMENTS`.
    grazing_angle
        Angle between ray and seabed [degrees]. 0 and below, where the seabed is not lit, give -inf; above 90 the ray
        comes from beyond the normal, and 180 less the angle counts.
    frequency
        Frequency [Hz]; broadcasts with the angle.
    model
        `"apl-uw"`: TR 9407, the sediment a fluid (`Sediment.fluid`). `"small-slope"`: TM 2-00, elastic
        (`Sediment.solid`).
    component
        `"roughness"` of the surface, `"volume"` below it, or `"total"`, their sum.
    sound_speed
        In the water [m/s].

    Returns
    -------
    array
        Strength [dB] of the broadcast shape; NaN where the angle is NaN.

    Raises
    ------
    ValueError
        For an unknown sediment, model or component, and for a frequency or sound speed that is not above 0.
    """
    found = find(sediment)
    checks.one_of("model", model, get_args(Model))
    checks.one_of("component", component, get_args(Component))
    frequencies = np.asarray(frequency, dtype=float)
    if not (np.isfinite(frequencies) & (frequencies > 0)).all():
        raise ValueError(f"frequency is {np.nanmin(frequencies):g} Hz at the least; all must be finite and above 0 Hz")
    k = 2 * np.pi * frequencies / checks.positive("sound_speed", sound_speed, "m/s")
    angle, k = np.broadcast_arrays(_folded(grazing_angle), k)
    lit = np.where(angle > 0, np.maximum(angle, LEAST_ANGLE), np.pi / 4)
    roughness, volume = _sections(found, model, lit, k, frequencies)
    section = {"total": roughness + volume, "roughness": roughness, "volume": volume}[component]
    with np.errstate(divide="ignore"):
        level = 10 * np.log10(section) + found.level_offset
    strength: Real = np.where(angle > 0, level, np.where(np.isnan(angle), np.nan, -np.inf))
    return strength


def reflection_loss(sediment: Sediment | str, grazing_angle: ArrayLike, *, model: Model = "apl-uw") -> Real:
    """Loss of a plane wave that a flat seabed reflects, `-20 log10 |R|` [dB].

    Parameters
    ----------
    sediment
        A sediment, or the name of one in `SEDIMENTS`.
    grazing_angle
        Angle between ray and seabed [degrees], folded at 90; 0 and below give NaN, since nothing is reflected there.
    model
        `"apl-uw"` for a fluid, `"small-slope"` for an elastic sediment. Neither depends on frequency.

    Returns
    -------
    array
        Loss [dB], of the shape of the angle.

    Raises
    ------
    ValueError
        For an unknown sediment or model.
    """
    found = find(sediment)
    checks.one_of("model", model, get_args(Model))
    angle = _folded(grazing_angle)
    lit = np.where(angle > 0, np.maximum(angle, LEAST_ANGLE), np.pi / 4)
    fluid = model == "apl-uw"
    coefficient = apl_uw.reflection(found.fluid, lit) if fluid else small_slope.reflection(found.solid, lit)
    loss: Real = np.where(angle > 0, -20 * np.log10(np.abs(coefficient)), np.nan)
    return loss


def _sections(sediment: Sediment, model: Model, angle: Real, k: Real, frequency: Real) -> tuple[Real, Real]:
    """Cross sections of roughness and volume."""
    if model == "apl-uw":
        fluid = sediment.fluid
        check_validity(model, fluid, frequency, apl_uw.FREQUENCIES, apl_uw.LIMITS)
        return apl_uw.roughness(fluid, angle, k), apl_uw.volume(fluid, angle, k)
    solid = sediment.solid
    check_validity(model, solid, frequency, small_slope.FREQUENCIES, small_slope.LIMITS)
    return small_slope.roughness(solid, angle, k), small_slope.volume(solid, angle, k)


def _folded(grazing_angle: ArrayLike) -> Real:
    """Grazing angle [rad], at most pi / 2."""
    degrees = np.asarray(grazing_angle, dtype=float)
    angle: Real = np.radians(np.minimum(degrees, 180 - degrees))
    return angle
