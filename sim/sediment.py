"""Sediments: what the seabed is made of, by name, from grain size, or adjusted."""

from dataclasses import dataclass, fields, replace
from functools import cached_property
from typing import Any

import numpy as np

from sim import checks

LARGEST_OFFSET = 200.0
"""Largest `level_offset` in either direction [dB]."""


@dataclass(frozen=True, kw_only=True)
class FluidBed:
    """A sediment as a fluid with a rough surface: the parameters of APL-UW TR 9407, table 2.

    Parameters
    ----------
    density_ratio, sound_speed_ratio
        Sediment over water, `rho` and `nu`.
    loss_parameter
        Imaginary over real part of the wavenumber, `delta`, above 0.
    volume_parameter
        Volume scattering cross section over attenuation, `sigma2`.
    spectral_exponent
        `gamma` of the roughness spectrum `W(K) = w2 (h0 K)^-gamma`, 2.1 to 3.99.
    spectral_strength_cm4
        `w2` with `h0` = 1 cm [cm^4].
    grain_size_phi
        Mean grain size [phi], `-log2` of the diameter in mm; None where it is unknown. No model reads it.

    Raises
    ------
    ValueError
        For a value outside these limits.
    """

    density_ratio: float
    sound_speed_ratio: float
    loss_parameter: float
    volume_parameter: float
    spectral_exponent: float
    spectral_strength_cm4: float
    grain_size_phi: float | None = None

    def __post_init__(self) -> None:
        for name in ("density_ratio", "sound_speed_ratio", "loss_parameter", "spectral_strength_cm4"):
            checks.positive(name, getattr(self, name))
        _check_not_negative("volume_parameter", self.volume_parameter)
        _check_exponent(self.spectral_exponent)

    @property
    def spectral_strength_si(self) -> float:
        """`w` of `W(K) = w K^-gamma` in SI units [m^(4 - gamma)]: `w2 1e-8 0.01^-gamma`."""
        return float(self.spectral_strength_cm4 * 1e-8 * 0.01**-self.spectral_exponent)


@dataclass(frozen=True, kw_only=True)
class ElasticBed:
    """A sediment as an elastic solid with a rough surface and inhomogeneities, after APL-UW TM 2-00.

    Parameters
    ----------
    density_ratio, compressional_speed_ratio
        Sediment over water, `rho` and `nu_p`.
    compressional_loss
        Loss parameter of the compressional wave, above 0.
    shear_speed_ratio, shear_loss
        `nu_t`, 0 for a fluid, and the loss parameter of the shear wave, above 0 where there is one.
    spectral_exponent
        `gamma` of the roughness spectrum `W(K) = w K^-gamma`, 2.1 to 3.99.
    spectral_strength_si
        `w` [m^(4 - gamma)].
    volume_exponent, volume_strength
        `g3` and `w3` of the spectrum of the relative fluctuations, `w3 K^-g3`, for K in 1/m.
    density_fluctuation, compressional_speed_fluctuation, shear_speed_fluctuation
        Relative fluctuations, fully correlated, in units of the one that `w3` describes.

    Raises
    ------
    ValueError
        For a value outside these limits.
    """

    density_ratio: float
    compressional_speed_ratio: float
    compressional_loss: float
    shear_speed_ratio: float
    shear_loss: float
    spectral_exponent: float
    spectral_strength_si: float
    volume_exponent: float
    volume_strength: float
    density_fluctuation: float = 1.0
    compressional_speed_fluctuation: float = 0.0
    shear_speed_fluctuation: float = 0.0

    def __post_init__(self) -> None:
        for name in ("density_ratio", "compressional_speed_ratio", "compressional_loss", "spectral_strength_si"):
            checks.positive(name, getattr(self, name))
        for name in ("shear_speed_ratio", "shear_loss", "volume_strength"):
            _check_not_negative(name, getattr(self, name))
        if self.shear_speed_ratio > 0:
            checks.positive("shear_loss", self.shear_loss)
        _check_exponent(self.spectral_exponent)
        checks.positive("volume_exponent", self.volume_exponent)
        for name in ("density_fluctuation", "compressional_speed_fluctuation", "shear_speed_fluctuation"):
            checks.finite(name, getattr(self, name))

    @classmethod
    def of_fluid(cls, bed: FluidBed) -> "ElasticBed":
        """The fluid `bed` without shear: its volume strength is `80 delta sigma2 / (pi ln 10)` at the exponent 3.

        With this strength the perturbation volume scattering equals that of TR 9407 from 10 degrees above the critical
        angle, to 0.05 dB; below it, it is lower by `30 log10(nu cos th)`: 3.5 dB for very coarse sand near grazing.
        """
        return cls(
            density_ratio=bed.density_ratio,
            compressional_speed_ratio=bed.sound_speed_ratio,
            compressional_loss=bed.loss_parameter,
            shear_speed_ratio=0.0,
            shear_loss=0.0,
            spectral_exponent=bed.spectral_exponent,
            spectral_strength_si=bed.spectral_strength_si,
            volume_exponent=3.0,
            volume_strength=80 * bed.loss_parameter * bed.volume_parameter / (np.pi * np.log(10)),
        )


@dataclass(frozen=True)
class Sediment:
    """What the seabed is made of, for both scattering models.

    Parameters
    ----------
    name
        What it is called.
    fluid
        What the model `apl-uw` reads.
    elastic
        What the model `small-slope` reads; None where no elastic set is known, and it then reads `fluid` as a medium
        without shear (`ElasticBed.of_fluid`).
    level_offset
        Added to every scattering strength [dB]. Handbook strengths of rock and gravel may be 10 dB off.

    Raises
    ------
    ValueError
        For a parameter outside its limits.
    """

    name: str
    fluid: FluidBed
    elastic: ElasticBed | None = None
    level_offset: float = 0.0

    def __post_init__(self) -> None:
        checks.within("level_offset", self.level_offset, -LARGEST_OFFSET, LARGEST_OFFSET, "dB")

    @cached_property
    def solid(self) -> ElasticBed:
        """`elastic`, or the fluid as one without shear."""
        return ElasticBed.of_fluid(self.fluid) if self.elastic is None else self.elastic

    def adjusted(self, *, level_offset: float | None = None, **parameters: Any) -> "Sediment":
        """A copy with other parameters.

        Parameters
        ----------
        level_offset
            The new offset [dB]; None leaves it.
        **parameters
            Fields of `FluidBed` and `ElasticBed` by name. One that both have (`density_ratio`, `spectral_exponent`)
            is set in both; one that only one model has changes that model alone, except that a sediment without an
            elastic set follows its fluid one in both.

        Raises
        ------
        ValueError
            For an unknown name, and for a value outside its limits.
        """
        of_fluid = {field.name for field in fields(FluidBed)}
        of_elastic = {field.name for field in fields(ElasticBed)} if self.elastic else set()
        for name in parameters:
            if name not in of_fluid | of_elastic:
                allowed = ", ".join(sorted({"level_offset"} | of_fluid | of_elastic))
                raise ValueError(f"{self.name} has no parameter {name!r}; it has {allowed}")
        return replace(
            self,
            fluid=replace(self.fluid, **{name: value for name, value in parameters.items() if name in of_fluid}),
            elastic=self.elastic
            and replace(self.elastic, **{name: value for name, value in parameters.items() if name in of_elastic}),
            level_offset=self.level_offset if level_offset is None else level_offset,
        )

    @classmethod
    def from_grain_size(cls, grain_size: float, *, name: str = "") -> "Sediment":
        """The sediment of a mean grain size by the regressions of APL-UW TR 9407, section IV.A.

        They reproduce the handbook's table from sandy gravel (-1) to clay (9); sound speeds refer to water of
        1528 m/s. There is no elastic set, so that the small-slope model takes the sediment for a fluid.

        Parameters
        ----------
        grain_size
            Mean grain size [phi], -1 to 9.
        name
            What to call it; by default its grain size.

        Raises
        ------
        ValueError
            For a grain size outside these limits.
        """
        phi = checks.within("grain_size", grain_size, -1.0, 9.0, "phi")
        return cls(name or f"grain size {phi:g} phi", fluid_of_grain_size(phi))


def fluid_of_grain_size(phi: float) -> FluidBed:
    """Density, speed, attenuation and roughness against mean grain size, -1 to 9 phi (TR 9407, section IV.A).

    The attenuation is a polynomial in dB per m and kHz; `delta` is that times `nu c ln 10 / (40 pi)` with c in km/s,
    1.528. The roughness is that of an rms height `h` over 1 m [cm]: `w2 = 0.00207 h^2`.
    """
    density: tuple[float, ...]
    speed: tuple[float, ...]
    if phi < 1:
        density, speed = (2.3139, -0.17057, 0.007797), (1.2778, -0.056452, 0.002709)
    elif phi < 5.3:
        density = (3.0455, -1.1069031, 0.2290201, -0.0165406)
        speed = (1.3425, -0.1382798, 0.0213937, -0.0014881)
    else:
        density, speed = (1.1565, -0.0012973), (1.0019, -0.0024324)
    ratio = _polynomial(speed, phi)
    height = (2.03846 - 0.26923 * phi) / (1 + 0.076923 * phi) if phi < 5 else 0.5
    return FluidBed(
        density_ratio=_polynomial(density, phi),
        sound_speed_ratio=ratio,
        loss_parameter=_attenuation(phi) * ratio * 1.528 * np.log(10) / (40 * np.pi),
        volume_parameter=0.002 if phi < 5.5 else 0.001,
        spectral_exponent=3.25,
        spectral_strength_cm4=0.00207 * height**2,
        grain_size_phi=phi,
    )


def _attenuation(phi: float) -> float:
    if phi < 0:
        return 0.4556
    if phi < 2.6:
        return 0.4556 + 0.0245 * phi
    if phi < 4.5:
        return 0.1978 + 0.1245 * phi
    if phi < 6:
        return _polynomial((8.0399, -2.5228, 0.20098), phi)
    return _polynomial((0.9431, -0.2041, 0.0117), phi)


def _polynomial(coefficients: tuple[float, ...], x: float) -> float:
    return sum(coefficient * x**power for power, coefficient in enumerate(coefficients))


def _check_not_negative(name: str, value: float) -> None:
    if checks.finite(name, value) < 0:
        raise ValueError(f"{name} is {value:g}; it must not be below 0")


def _check_exponent(value: float) -> None:
    checks.within("spectral_exponent", value, 2.1, 3.99)
