"""The water a sonar stands in: sound speed and absorption."""

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Literal, get_args

import numpy as np
from numpy.typing import ArrayLike

from sim import checks
from sim.band import Real

AbsorptionModel = Literal["francois-garrison", "ainslie-mccolm"]


LIMITS: Mapping[str, tuple[float, float, str]] = MappingProxyType(
    {
        "temperature": (-4.0, 40.0, "deg C"),
        "salinity": (0.0, 45.0, ""),
        "depth": (0.0, 11e3, "m"),
        "ph": (7.0, 9.0, ""),
    }
)
"""Least and largest value of each property of the water, and its unit."""


@dataclass(frozen=True, kw_only=True)
class Water:
    """Sea water at the sonar.

    Parameters
    ----------
    temperature
        Temperature, `T` [deg C], -4 to 40.
    salinity
        Practical salinity, `S`, 0 to 45.
    depth
        Depth, `D` [m], 0 to 11,000.
    ph
        Acidity on the scale of the absorption models, 7 to 9.

    Raises
    ------
    ValueError
        For a value outside these limits.
    """

    temperature: float = 10.0
    salinity: float = 35.0
    depth: float = 0.0
    ph: float = 8.0

    def __post_init__(self) -> None:
        for name, limits in LIMITS.items():
            checks.within(name, getattr(self, name), *limits)

    @property
    def sound_speed(self) -> float:
        """Sound speed [m/s] after Mackenzie (1981), nine terms.

        It was fitted from 2 to 30 deg C, salinities 25 to 40 and down to 8,000 m, where its standard error is 0.07 m/s.
        """
        t, s, d = self.temperature, self.salinity - 35, self.depth
        return (
            1448.96
            + 4.591 * t
            - 5.304e-2 * t**2
            + 2.374e-4 * t**3
            + 1.340 * s
            + 1.630e-2 * d
            + 1.675e-7 * d**2
            - 1.025e-2 * t * s
            - 7.139e-13 * t * d**3
        )

    def absorption(self, frequency: ArrayLike, *, model: AbsorptionModel = "francois-garrison") -> Real:
        """Absorption of sound, one way [dB/m].

        Parameters
        ----------
        frequency
            Frequency, `f` [Hz], not below 0; any shape.
        model
            `"francois-garrison"` (1982), stated for 0.2 to 1000 kHz, or the simpler `"ainslie-mccolm"` (1998).

        Returns
        -------
        array
            Of the shape of `frequency`.

        Raises
        ------
        ValueError
            For an unknown model, and for a frequency below 0 or not finite.
        """
        return absorption(
            frequency,
            temperature=self.temperature,
            salinity=self.salinity,
            depth=self.depth,
            ph=self.ph,
            model=model,
        )


def absorption(
    frequency: ArrayLike,
    *,
    temperature: ArrayLike = 10.0,
    salinity: ArrayLike = 35.0,
    depth: ArrayLike = 0.0,
    ph: ArrayLike = 8.0,
    model: AbsorptionModel = "francois-garrison",
) -> Real:
    """Absorption of sound in sea water, one way; that of `Water.absorption` over arrays.

    Parameters
    ----------
    frequency
        Frequency, `f` [Hz], not below 0.
    temperature, salinity, depth, ph
        As of `Water`: [deg C], practical salinity, [m] and pH, within the same limits. All broadcast.
    model
        As of `Water.absorption`.

    Returns
    -------
    array
        [dB/m], of the broadcast shape.

    Raises
    ------
    ValueError
        For an unknown model, a frequency that is below 0 or not finite, and water outside the limits.
    """
    checks.one_of("model", model, get_args(AbsorptionModel))
    frequencies = np.asarray(frequency, dtype=float)
    bad = ~(np.isfinite(frequencies) & (frequencies >= 0))
    if bad.any():
        raise ValueError(f"frequency is {frequencies[bad].flat[0]:g} Hz; it must be finite and not below 0 Hz")
    water = {"temperature": temperature, "salinity": salinity, "depth": depth, "ph": ph}
    for name, values in water.items():
        for value in np.unique(np.asarray(values, dtype=float)):
            checks.within(name, value, *LIMITS[name])
    formula = francois_garrison if model == "francois-garrison" else ainslie_mccolm
    per_kilometre = formula(frequencies / 1e3, *(np.asarray(values, dtype=float) for values in water.values()))
    found: Real = per_kilometre / 1e3
    return found


def francois_garrison(f: Real, t: Real, s: Real, d: Real, ph: Real) -> Real:
    """Absorption [dB/km] at `f` [kHz] after Francois and Garrison (1982): boric acid, magnesium sulphate, water."""
    kelvin = 273 + t
    c = 1412 + 3.21 * t + 1.19 * s + 0.0167 * d
    a1, f1 = 8.86 / c * 10 ** (0.78 * ph - 5), 2.8 * np.sqrt(s / 35) * 10 ** (4 - 1245 / kelvin)
    a2, f2 = 21.44 * s / c * (1 + 0.025 * t), 8.17 * 10 ** (8 - 1990 / kelvin) / (1 + 0.0018 * (s - 35))
    cold = 4.937e-4 - 2.59e-5 * t + 9.11e-7 * t**2 - 1.5e-8 * t**3
    a3 = np.where(t <= 20, cold, 3.964e-4 - 1.146e-5 * t + 1.45e-7 * t**2 - 6.5e-10 * t**3)
    p2, p3 = 1 - 1.37e-4 * d + 6.2e-9 * d**2, 1 - 3.83e-5 * d + 4.9e-10 * d**2
    total: Real = a1 * _relaxation(f, f1) + a2 * p2 * _relaxation(f, f2) + a3 * p3 * f**2
    return total


def ainslie_mccolm(f: Real, t: Real, s: Real, depth: Real, ph: Real) -> Real:
    """Absorption [dB/km] at `f` [kHz] after Ainslie and McColm (1998)."""
    d = depth / 1e3
    boric = 0.106 * np.exp((ph - 8) / 0.56) * _relaxation(f, 0.78 * np.sqrt(s / 35) * np.exp(t / 26))
    magnesium = 0.52 * (1 + t / 43) * s / 35 * np.exp(-d / 6) * _relaxation(f, 42 * np.exp(t / 17))
    total: Real = boric + magnesium + 0.00049 * np.exp(-(t / 27 + d / 17)) * f**2
    return total


def _relaxation(f: Real, f0: Real) -> Real:
    """`f0 f^2 / (f0^2 + f^2)`, 0 at rest."""
    response: Real = f0 * f**2 / np.maximum(f0**2 + f**2, 1e-300)
    return response
