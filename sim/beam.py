"""Vertical beam patterns."""

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from sim import checks
from sim.band import Real


class Beam(Protocol):
    """A vertical beam pattern."""

    def level(self, depression: Real, wavelength: float) -> Real:
        """One-way level relative to the axis [dB] at depression angles [degrees] and a wavelength [m]."""


@dataclass(frozen=True, kw_only=True)
class SincBeam:
    """The beam of an evenly driven aperture, `20 log10 |sinc(h / lambda sin(phi - phi0))|`; -inf at its nulls.

    Parameters
    ----------
    height
        Height of the aperture across its axis, `h` [m].
    depression
        Depression of the axis, `phi0` [degrees], -90 to 90.

    Raises
    ------
    ValueError
        For a value outside these limits.
    """

    height: float
    depression: float

    def __post_init__(self) -> None:
        checks.positive("height", self.height, "m")
        checks.within("depression", self.depression, -90.0, 90.0, "degrees")

    def level(self, depression: Real, wavelength: float) -> Real:
        """One-way level relative to the axis [dB]."""
        off_axis = np.sin(np.radians(depression - self.depression))
        with np.errstate(divide="ignore"):
            level: Real = 20 * np.log10(np.abs(np.sinc(self.height / wavelength * off_axis)))
        return level


@dataclass(frozen=True, kw_only=True)
class GaussianBeam:
    """A beam without side lobes, `-3.01 ((phi - phi0) / (width / 2))^2`, alike at all wavelengths.

    Parameters
    ----------
    width
        Angle between the half-power directions [degrees].
    depression
        Depression of the axis, `phi0` [degrees], -90 to 90.

    Raises
    ------
    ValueError
        For a value outside these limits.
    """

    width: float
    depression: float

    def __post_init__(self) -> None:
        checks.positive("width", self.width, "degrees")
        checks.within("depression", self.depression, -90.0, 90.0, "degrees")

    def level(self, depression: Real, wavelength: float) -> Real:
        """One-way level relative to the axis [dB]; the wavelength does not matter."""
        level: Real = -10 * np.log10(2) * (2 * (depression - self.depression) / self.width) ** 2
        return level
