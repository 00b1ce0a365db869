"""Echoes of scatterers that lie anywhere: from places and strengths to band-limited series."""

import finufft
import numpy as np

from sim.band import Band, Complex, Real, circular_gaussian
from sim.geometry import travel_times
from sim.levels import scatterer_power
from sim.scene import Scene
from sim.sonar import Sonar
from sim.visibility import SeabedPoints, position, sees

ACCURACY = 1e-12
"""Relative accuracy asked of the non-uniform FFT; a coarser one saves at most a third of its time."""


def place_scatterers(scene: Scene, spacing: float, rng: np.random.Generator) -> tuple[SeabedPoints, Real]:
    """Points along the whole outline of the seabed, walls included, one at random in each cell of its length.

    Parameters
    ----------
    scene
        The scene.
    spacing
        Largest length of a cell [m].
    rng
        Source of the places.

    Returns
    -------
    points, length
        The points, and the length of the cell that each stands for [m]; shape (scatterer,).
    """
    lengths = np.hypot(*np.diff(scene.profile, axis=0).T)
    cells = np.maximum(np.ceil(lengths / spacing), 1).astype(np.int64)
    segment = np.repeat(np.arange(len(cells)), cells)
    cell = np.arange(len(segment)) - np.repeat(np.cumsum(cells) - cells, cells)
    share = (cell + rng.random(len(segment))) / cells[segment]
    return SeabedPoints(segment, share), (lengths / cells)[segment]


def echo_spectrum(band: Band, centre_frequency: float, times: Real, amplitudes: Complex) -> Complex:
    """Spectrum of the sum of the echoes of all scatterers.

    `p(t) = sum_j a_j h(t - t_j) exp(-2 pi i fc t_j)` with the pulse `h(t) = sum_k v_k exp(2 pi i f_k t)` of the
    band, `v_k = sqrt(w_k) / sum w`. So `P_k = v_k sum_j a_j exp(-2 pi i fc t_j - 2 pi i f_k (t_j - t_0))`: one type-1
    non-uniform FFT.

    Parameters
    ----------
    band
        The band, on a time grid that starts at `t_0`.
    centre_frequency
        `fc` [Hz].
    times
        Arrival of each scatterer's echo, `t_j` [s], shape (scatterer,).
    amplitudes
        Complex strength of each scatterer, `a_j`, shape (rows, scatterer).

    Returns
    -------
    array
        Shape (rows, bins).
    """
    phase = np.mod((times - band.grid.start) * (2 * np.pi / band.grid.period), 2 * np.pi)
    carried = amplitudes * np.exp(-2j * np.pi * centre_frequency * times)
    bins = finufft.nufft1d1(phase, carried, band.harmonics.size, eps=ACCURACY, isign=-1, nthreads=1)
    spectrum: Complex = np.atleast_2d(bins) * (np.sqrt(band.weights) / band.weights.sum())
    return spectrum


def scene_spectra(
    scene: Scene, sonar: Sonar, band: Band, rows: int, per_resolution: float, rng: np.random.Generator
) -> tuple[Complex, Complex]:
    """Noise-free spectra of a scene at both receivers, shape (rows, bins) each.

    Each scatterer has a circular Gaussian strength of its own in every row, so that the speckle is Gaussian at any
    density; rows share the places. A scatterer is heard where the transmitter and that receiver see it.

    Parameters
    ----------
    scene, sonar, band
        What is seen, by what, in which band.
    rows
        Independent rows.
    per_resolution
        Scatterers in a length `c / (2 B)` of seabed.
    rng
        Source of places and strengths.
    """
    points, length = place_scatterers(scene, sonar.range_resolution / per_resolution, rng)
    seen = sees(scene, points, sonar.altitude)
    points, length = SeabedPoints(points.segment[seen], points.share[seen]), length[seen]
    times = travel_times(sonar, *position(scene, points))
    amplitudes = circular_gaussian((rows, len(length)), rng) * np.sqrt(scatterer_power(scene, sonar, points, length))
    seen_above = sees(scene, points, sonar.altitude + sonar.baseline)
    primary = echo_spectrum(band, sonar.centre_frequency, times[0], amplitudes)
    secondary = echo_spectrum(band, sonar.centre_frequency, times[1], amplitudes * seen_above)
    return primary, secondary
