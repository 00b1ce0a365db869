"""The sonar equation: signal-to-noise ratio of a pixel of the image over ground range."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from sim.band import Real
from sim.geometry import ground_length
from sim.scattering import Model, scattering_strength
from sim.sediment import Sediment
from sim.sonar import Sonar


@dataclass(frozen=True)
class SonarEquation:
    """The terms of the sonar equation, arrays of one shape or numbers; levels in dB.

    Attributes
    ----------
    slant_range
        From transmitter to seabed and back, one way [m].
    grazing_angle
        Between ray and seabed [degrees].
    source_level, transmit_beam, receive_beam
        Source level [dB re 1 uPa at 1 m] and beams relative to their axes [dB].
    spreading, absorption
        Two-way losses, above 0: `40 log10 r` and `2 alpha r` [dB].
    scattering_strength, area
        Strength of the seabed [dB], and `10 log10` of the area that answers at once [dB re 1 m^2].
    noise_level
        In the band, less the directivity index: `NSL + 10 log10 B - DI` [dB re 1 uPa].
    pulse_gain, aperture_gain
        Of matched filtering, `10 log10(B T)`, and of the synthetic aperture, `10 log10 N_pc` [dB].
    """

    slant_range: Real
    grazing_angle: Real
    source_level: float
    transmit_beam: Real
    receive_beam: Real
    spreading: Real
    absorption: Real
    scattering_strength: Real
    area: Real
    noise_level: float
    pulse_gain: float
    aperture_gain: Real

    @property
    def range_gain(self) -> Real:
        """The terms of `propagation`, gain less losses [dB]."""
        gain: Real = self.aperture_gain - self.spreading - self.absorption
        return gain

    @property
    def snr(self) -> Real:
        """Signal-to-noise ratio of one pixel at one receiver [dB]."""
        echo = self.source_level + self.transmit_beam + self.scattering_strength + self.area + self.receive_beam
        ratio: Real = echo + self.range_gain + self.pulse_gain - self.noise_level
        return ratio


def snr(sonar: Sonar, sediment: Sediment | str, ground_range: ArrayLike, *, model: Model = "small-slope") -> Real:
    """Signal-to-noise ratio of a flat seabed at one receiver: `sonar_equation(...).snr`.

    Parameters
    ----------
    sonar, sediment, ground_range, model
        As for `sonar_equation`; ranges [m] of any shape.

    Returns
    -------
    array
        [dB], of the shape of `ground_range`.

    Raises
    ------
    ValueError
        As `sonar_equation`.
    """
    return sonar_equation(sonar, sediment, ground_range, model=model).snr


def sonar_equation(
    sonar: Sonar, sediment: Sediment | str, ground_range: ArrayLike, *, model: Model = "small-slope"
) -> SonarEquation:
    """The sonar equation of a flat seabed, term by term.

    `SNR = SL + tx + rx - 40 log r - 2 alpha r + S_b + 10 log(dx dy) - [NSL + 10 log B - DI] + 10 log(B T)
    + 10 log N_pc`. The ground length `dy` of a resolution cell is the piece of the plane within `r -/+ c / (4 B)`,
    `c / (2 B cos th)` but for the nadir, where it stays finite. Scattering, absorption, beams and noise are taken at
    the centre frequency.

    Parameters
    ----------
    sonar
        Its geometry, transducers, noise and water.
    sediment
        A sediment, or the name of one in `SEDIMENTS`.
    ground_range
        Ground range, `y` [m], not below 0; any shape.
    model
        Scattering model; by default the one that paper B used.

    Returns
    -------
    SonarEquation
        Terms of the shape of `ground_range`; `.snr` is their sum.

    Raises
    ------
    ValueError
        For an unknown sediment or model, and for a ground range that is below 0 or not finite.
    """
    y = np.asarray(ground_range, dtype=float)
    if not (np.isfinite(y) & (y >= 0)).all():
        raise ValueError(f"ground_range is {np.min(y):g} m at the least; all must be finite and not below 0 m")
    slant = np.hypot(y, sonar.altitude)
    length = ground_length(sonar.altitude, slant, sonar.range_resolution)
    grazing = np.degrees(np.arctan2(sonar.altitude, y))
    return echo_level(sonar, sediment, slant, grazing, grazing, sonar.aperture.resolution * length, model)


def echo_level(
    sonar: Sonar,
    sediment: Sediment | str,
    slant_range: Real,
    depression: Real,
    grazing_angle: Real,
    area: Real,
    model: Model,
) -> SonarEquation:
    """The sonar equation of pieces of seabed anywhere.

    Parameters
    ----------
    sonar, sediment, model
        As for `sonar_equation`.
    slant_range
        Distance from the transmitter [m].
    depression
        Angle of the ray below the horizontal [degrees].
    grazing_angle
        Angle between the ray and the piece [degrees]; 0 and below is not lit.
    area
        Area of the piece [m^2].
    """
    fc = sonar.centre_frequency
    spreading, absorption, aperture_gain = propagation(sonar, slant_range)
    noise_level = sonar.noise.spectral_level(fc) + 10 * np.log10(sonar.bandwidth) - sonar.receiver.directivity_index
    return SonarEquation(
        slant_range=slant_range,
        grazing_angle=grazing_angle,
        source_level=sonar.transmitter.source_level,
        transmit_beam=sonar.transmitter.beam.level(depression, sonar.wavelength),
        receive_beam=sonar.receiver.beam.level(depression, sonar.wavelength),
        spreading=spreading,
        absorption=absorption,
        scattering_strength=scattering_strength(
            sediment, grazing_angle, fc, model=model, sound_speed=sonar.sound_speed
        ),
        area=10 * np.log10(area),
        noise_level=float(noise_level),
        pulse_gain=float(10 * np.log10(sonar.bandwidth * sonar.transmitter.pulse_length)),
        aperture_gain=aperture_gain,
    )


def propagation(sonar: Sonar, slant_range: Real) -> tuple[Real, Real, Real]:
    """The terms that depend on slant range [m] alone: spreading, absorption and the gain of the aperture [dB]."""
    return (
        40 * np.log10(slant_range),
        2 * sonar.water.absorption(sonar.centre_frequency) * slant_range,
        10 * np.log10(sonar.aperture.phase_centres(slant_range, sonar.wavelength)),
    )
