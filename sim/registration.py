"""Registration: the secondary moved onto the primary for the reference plane."""

import finufft
import numpy as np

from sim.band import Band, Complex
from sim.echoes import ACCURACY
from sim.geometry import plane_delay
from sim.sonar import Sonar


def register(spectrum: Complex, band: Band, sonar: Sonar) -> Complex:
    """Resample a secondary series so that echoes of the reference plane stand where the primary has them.

    The passband signal is resampled, so that the carrier moves along: at the instants `t` of the grid
    `exp(2 pi i fc tau) sum_k S_k exp(2 pi i f_k (t + tau - t_0))` with `tau = plane_delay(t)`; exact for the band, one
    type-2 non-uniform FFT. What is left is `secondary(t + delay) ~ primary(t) exp(-2 pi i fc delay)` with the delay
    relative to the plane.

    Parameters
    ----------
    spectrum
        Spectrum of the secondary, `S_k`, shape (rows, bins).
    band
        Its band, on the time grid of the pair.
    sonar
        Geometry and `fc`.

    Returns
    -------
    array
        The registered series, shape (rows, samples).
    """
    times = band.grid.times
    delay = plane_delay(sonar, times)
    phase = np.mod((times + delay - band.grid.start) * (2 * np.pi / band.grid.period), 2 * np.pi)
    series = finufft.nufft1d2(phase, spectrum, eps=ACCURACY, isign=1, nthreads=1)
    registered: Complex = np.atleast_2d(series) * np.exp(2j * np.pi * sonar.centre_frequency * delay)
    return registered
