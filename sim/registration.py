"""Registration: the secondary moved onto the primary for the reference plane."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from sim.band import Band, Complex, Real
from sim.geometry import plane_delay
from sim.sonar import Sonar
from sim.transforms import to_series


@dataclass(frozen=True, eq=False)
class Resampling:
    """Reads passband series at other instants than those of their grid, at times `t - delay(t)`.

    The carrier moves along: `exp(-2 pi i fc delay) sum_k S_k exp(2 pi i f_k (t - delay - t_0))`; exact for the band,
    one type-2 non-uniform FFT.

    Attributes
    ----------
    band
        Of the series, on the grid of the instants `t`.
    centre_frequency
        `fc` [Hz].
    delay
        By how much what is read came before [s], shape (samples,).
    accuracy
        Relative accuracy of the transform.
    """

    band: Band
    centre_frequency: float
    delay: Real
    accuracy: float = 1e-12

    @cached_property
    def turn(self) -> Complex:
        """What the carrier does to the envelope, `exp(-2 pi i fc delay)`, shape (samples,)."""
        turn: Complex = np.exp(-2j * np.pi * self.centre_frequency * self.delay)
        return turn

    @cached_property
    def _phase(self) -> Real:
        grid = self.band.grid
        phase: Real = (grid.times - self.delay - grid.start) * (2 * np.pi / grid.period)
        return phase

    def envelope(self, spectrum: Complex) -> Complex:
        """The resampled envelope of spectra, which no carrier turns yet; from shape (rows, bins) to (rows, samples)."""
        return to_series(self._phase, spectrum, self.accuracy)

    def series(self, spectrum: Complex) -> Complex:
        """The resampled series of spectra, from shape (rows, bins) to (rows, samples)."""
        resampled = self.envelope(spectrum)
        resampled *= self.turn
        return resampled


def registration(band: Band, sonar: Sonar, accuracy: float = 1e-12) -> Resampling:
    """Resampling of a secondary so that echoes of the reference plane stand where the primary has them.

    The secondary is read at `t + plane_delay(t)`; what is left is `secondary(t + delay) ~ primary(t) exp(-2 pi i fc
    delay)` with the delay relative to the plane.

    Parameters
    ----------
    band
        Of the secondary, on the time grid of the pair.
    sonar
        Geometry and `fc`.
    accuracy
        Relative accuracy of the transform.
    """
    return Resampling(band, sonar.centre_frequency, -plane_delay(sonar, band.grid.times), accuracy)
