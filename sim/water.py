"""The water a sonar stands in: sound speed and absorption."""

from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np
from numpy.typing import ArrayLike

from sim import checks
from sim.band import Real

AbsorptionModel = Literal["francois-garrison", "ainslie-mccolm"]


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
        checks.within("temperature", self.temperature, -4.0, 40.0, "deg C")
        checks.within("salinity", self.salinity, 0.0, 45.0)
        checks.within("depth", self.depth, 0.0, 11e3, "m")
        checks.within("ph", self.ph, 7.0, 9.0)

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
        checks.one_of("model", model, get_args(AbsorptionModel))
        frequencies = np.asarray(frequency, dtype=float)
        if not (np.isfinite(frequencies) & (frequencies >= 0)).all():
            raise ValueError(f"frequency is {np.min(frequencies):g} Hz; it must be finite and not below 0 Hz")
        formula = francois_garrison if model == "francois-garrison" else ainslie_mccolm
        absorption: Real = formula(self, frequencies / 1e3) / 1e3
        return absorption


def absorption(
    frequency: ArrayLike,
    *,
    temperature: float = 10.0,
    salinity: float = 35.0,
    depth: float = 0.0,
    ph: float = 8.0,
    model: AbsorptionModel = "francois-garrison",
) -> Real:
    """Absorption of sound in sea water, one way [dB/m], against frequency [Hz].

    `Water(temperature=..., ...).absorption(frequency, model=model)`: see there for limits and errors.
    """
    water = Water(temperature=temperature, salinity=salinity, depth=depth, ph=ph)
    return water.absorption(frequency, model=model)


def francois_garrison(water: Water, f: Real) -> Real:
    """Absorption [dB/km] at `f` [kHz] after Francois and Garrison (1982): boric acid, magnesium sulphate, water."""
    t, s, d = water.temperature, water.salinity, water.depth
    kelvin = 273 + t
    c = 1412 + 3.21 * t + 1.19 * s + 0.0167 * d
    a1, f1 = 8.86 / c * 10 ** (0.78 * water.ph - 5), 2.8 * np.sqrt(s / 35) * 10 ** (4 - 1245 / kelvin)
    a2, f2 = 21.44 * s / c * (1 + 0.025 * t), 8.17 * 10 ** (8 - 1990 / kelvin) / (1 + 0.0018 * (s - 35))
    if t <= 20:
        a3 = 4.937e-4 - 2.59e-5 * t + 9.11e-7 * t**2 - 1.5e-8 * t**3
    else:
        a3 = 3.964e-4 - 1.146e-5 * t + 1.45e-7 * t**2 - 6.5e-10 * t**3
    p2, p3 = 1 - 1.37e-4 * d + 6.2e-9 * d**2, 1 - 3.83e-5 * d + 4.9e-10 * d**2
    return a1 * _relaxation(f, f1) + a2 * p2 * _relaxation(f, f2) + a3 * p3 * f**2


def ainslie_mccolm(water: Water, f: Real) -> Real:
    """Absorption [dB/km] at `f` [kHz] after Ainslie and McColm (1998)."""
    t, s, d = water.temperature, water.salinity, water.depth / 1e3
    boric = 0.106 * np.exp((water.ph - 8) / 0.56) * _relaxation(f, 0.78 * np.sqrt(s / 35) * np.exp(t / 26))
    magnesium = 0.52 * (1 + t / 43) * s / 35 * np.exp(-d / 6) * _relaxation(f, 42 * np.exp(t / 17))
    total: Real = boric + magnesium + 0.00049 * np.exp(-(t / 27 + d / 17)) * f**2
    return total


def _relaxation(f: Real, f0: float) -> Real:
    """`f0 f^2 / (f0^2 + f^2)`, 0 at rest."""
    response: Real = f0 * f**2 / np.maximum(f0**2 + f**2, 1e-300)
    return response
