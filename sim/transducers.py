"""What sends and what listens: transmitter, receivers, synthetic aperture and noise.

None of these figures is published for the HISAS sonars. The defaults are assumptions of plausible size.
"""

from dataclasses import dataclass, field

import numpy as np

from sim import checks
from sim.band import Real
from sim.beam import Beam, GaussianBeam, SincBeam


@dataclass(frozen=True, kw_only=True)
class Transmitter:
    """The transmitter.

    Parameters
    ----------
    source_level
        On the axis of the beam [dB re 1 uPa at 1 m].
    pulse_length
        Length of the transmitted pulse, `T` [s]; matched filtering gains `B T`.
    beam
        Vertical beam; by default, 3 dB down 13 degrees off an axis 20 degrees down, its null near 50 at 122 kHz.

    Raises
    ------
    ValueError
        For a value outside these limits, or not finite.
    """

    source_level: float = 200.0
    pulse_length: float = 10e-3
    beam: Beam = field(default_factory=lambda: SincBeam(height=0.024, depression=20.0))

    def __post_init__(self) -> None:
        checks.finite("source_level", self.source_level, "dB")
        checks.positive("pulse_length", self.pulse_length, "s")


@dataclass(frozen=True, kw_only=True)
class Receiver:
    """Both receivers, alike.

    Parameters
    ----------
    beam
        Vertical beam; by default Gaussian, 60 degrees wide, 20 degrees down.
    directivity_index
        Gain against isotropic noise of one element [dB]; the default is that of 3.75 by 2.4 cm at 122 kHz,
        `10 log10(4 pi area / lambda^2)`.

    Raises
    ------
    ValueError
        For a value outside these limits, or not finite.
    """

    beam: Beam = field(default_factory=lambda: GaussianBeam(width=60.0, depression=20.0))
    directivity_index: float = 19.0

    def __post_init__(self) -> None:
        checks.finite("directivity_index", self.directivity_index, "dB")


@dataclass(frozen=True, kw_only=True)
class SyntheticAperture:
    """Coherent combination of pings along track.

    Parameters
    ----------
    resolution
        Along-track resolution, `dx` [m], the same at all ranges.
    phase_centre_spacing
        Along-track distance of the phase centres [m], by default half of an element of 3.75 cm.

    Raises
    ------
    ValueError
        For a value outside these limits.
    """

    resolution: float = 0.03
    phase_centre_spacing: float = 0.01875

    def __post_init__(self) -> None:
        checks.positive("resolution", self.resolution, "m")
        checks.positive("phase_centre_spacing", self.phase_centre_spacing, "m")

    def phase_centres(self, slant_range: Real, wavelength: float) -> Real:
        """How many are combined at a slant range [m] and wavelength [m]; a real number, shape of the former.

        `lambda r / (2 dx)` over their spacing, and 1 at least.
        """
        centres: Real = np.maximum(wavelength * slant_range / (2 * self.resolution * self.phase_centre_spacing), 1.0)
        return centres


@dataclass(frozen=True, kw_only=True)
class Noise:
    """Noise at a receiver: thermal, and that of the wind at the surface.

    Parameters
    ----------
    wind_speed
        Wind at the surface [m/s]; 0 leaves the ambient noise of a calm sea.
    excess
        Noise of the vehicle and its electronics above these [dB].

    Raises
    ------
    ValueError
        For a value outside these limits.
    """

    wind_speed: float = 5.0
    excess: float = 0.0

    def __post_init__(self) -> None:
        checks.within("wind_speed", self.wind_speed, 0.0, 60.0, "m/s")
        checks.finite("excess", self.excess, "dB")

    def spectral_level(self, frequency: float) -> float:
        """Spectral level of isotropic noise [dB re 1 uPa^2 / Hz] at a frequency `f` [Hz].

        The power sum of thermal noise, `-15 + 20 log10 f_kHz` (Mellen 1952), and wind noise,
        `50 + 7.5 sqrt(w) + 20 log10 f_kHz - 40 log10(f_kHz + 0.4)` (Coates 1990, after Wenz 1962), plus the excess.
        """
        khz = frequency / 1e3
        thermal = -15 + 20 * np.log10(khz)
        wind = 50 + 7.5 * np.sqrt(self.wind_speed) + 20 * np.log10(khz) - 40 * np.log10(khz + 0.4)
        return float(10 * np.log10(10 ** (thermal / 10) + 10 ** (wind / 10)) + self.excess)
