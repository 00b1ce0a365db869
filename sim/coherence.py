"""The coherence to expect of a flat seabed: channel noise, baseline decorrelation and footprint shift."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike
from scipy.special import expit

from sim.band import Real
from sim.scattering import Model
from sim.sediment import Sediment
from sim.sonar import Sonar
from sim.sonar_equation import snr


@dataclass(frozen=True)
class CoherenceTerms:
    """Factors of the coherence magnitude, 0 to 1, and their product.

    Attributes
    ----------
    noise
        Of equal noise in both channels, `rho / (1 + rho)`.
    baseline
        Of the two angles of view, `1 - df / B`.
    footprint
        Of echoes that stand a delay `dtau` apart after registration, `sinc(B dtau)`.
    """

    noise: Real
    baseline: Real
    footprint: Real

    @property
    def product(self) -> Real:
        """The coherence to expect at zero lag of a registered pair."""
        coherence: Real = self.noise * self.baseline * self.footprint
        return coherence


def expected_coherence(
    sonar: Sonar,
    sediment: Sediment | str,
    ground_range: ArrayLike,
    *,
    height: ArrayLike = 0.0,
    model: Model = "small-slope",
) -> Real:
    """Coherence magnitude to expect at zero lag of a registered pair: `coherence_terms(...).product`.

    Parameters
    ----------
    sonar, sediment, ground_range, height, model
        As for `coherence_terms`; ranges and heights [m] broadcast.

    Returns
    -------
    array
        0 to 1, of the broadcast shape.

    Raises
    ------
    ValueError
        As `sonar_equation`.
    """
    return coherence_terms(sonar, sediment, ground_range, height=height, model=model).product


def coherence_terms(
    sonar: Sonar,
    sediment: Sediment | str,
    ground_range: ArrayLike,
    *,
    height: ArrayLike = 0.0,
    model: Model = "small-slope",
) -> CoherenceTerms:
    """Coherence to expect of a flat seabed over ground range, factor by factor.

    Parameters
    ----------
    sonar, sediment, ground_range, model
        As for `sonar_equation`.
    height
        Height of the seabed above the plane of registration [m]; broadcasts with the ground range. It shifts the
        footprints alone: range and angles are taken on the plane. An estimator that finds the lag regains that factor.

    Returns
    -------
    CoherenceTerms
        Arrays.

    Raises
    ------
    ValueError
        As `sonar_equation`.
    """
    ratio = snr(sonar, sediment, ground_range, model=model)
    slant = np.hypot(np.asarray(ground_range, dtype=float), sonar.altitude)
    return CoherenceTerms(
        noise=noise_coherence(ratio),
        baseline=baseline_coherence(sonar, slant),
        footprint=footprint_coherence(sonar, slant, height),
    )


def noise_coherence(snr: ArrayLike) -> Real:
    """Coherence of two channels of equal signal-to-noise ratio [dB], `rho / (1 + rho)`."""
    coherence: Real = expit(np.asarray(snr, dtype=float) * np.log(10) / 10)
    return coherence


def baseline_coherence(sonar: Sonar, slant_range: ArrayLike) -> Real:
    """Coherence that the two angles of view leave on the plane, `1 - df / B`, not below 0.

    Registration stretches the secondary by `dtau / dt`, and with it the band moves by `df = fc |dtau / dt|`;
    `df = (fc / 2) (1 - r / r_s)` with `r_s^2 = r^2 + D^2 + 2 D H`, about `fc D H / (2 r^2)`. Flat band.

    Parameters
    ----------
    sonar
        `fc`, `B`, `D` and `H`.
    slant_range
        `r` [m], any shape.
    """
    slant = np.asarray(slant_range, dtype=float)
    excess = sonar.baseline * (sonar.baseline + 2 * sonar.altitude)
    beyond = np.sqrt(slant**2 + excess)
    shift = sonar.centre_frequency / 2 * excess / (beyond * (beyond + slant))
    coherence: Real = np.maximum(1 - shift / sonar.bandwidth, 0.0)
    return coherence


def footprint_coherence(sonar: Sonar, slant_range: ArrayLike, height: ArrayLike) -> Real:
    """Coherence at zero lag of a seabed `dz` above the plane of registration, `|sinc(B D dz / (c r))|`.

    Parameters
    ----------
    sonar
        `B`, `D` and `c`.
    slant_range, height
        `r` and `dz` [m]; they broadcast.
    """
    delay = (
        sonar.baseline * np.asarray(height, dtype=float) / (sonar.sound_speed * np.asarray(slant_range, dtype=float))
    )
    coherence: Real = np.abs(np.sinc(sonar.bandwidth * delay))
    return coherence
