"""Echoes of scatterers that lie anywhere: from places and strengths to band-limited series."""

import numpy as np
from numpy.typing import NDArray

from sim.band import Band, Complex, Real
from sim.compiled import compiled
from sim.geometry import travel_times
from sim.levels import scatterer_power
from sim.listening import Listening
from sim.passes import turn
from sim.profile import Profile, SeabedPoints
from sim.sonar import Sonar
from sim.streams import Streams, Use
from sim.texture import scattered, texture_shape
from sim.transforms import to_spectrum
from sim.visibility import sees


def place_scatterers(profile: Profile, spacing: float, rng: np.random.Generator) -> tuple[SeabedPoints, Real]:
    """Points along the whole outline of the seabed, walls included, one at random in each cell of its length.

    Parameters
    ----------
    profile
        A section of the seabed.
    spacing
        Largest length of a cell [m].
    rng
        Source of the places.

    Returns
    -------
    points, length
        The points, and the length of the cell that each stands for [m]; shape (scatterer,).
    """
    cells = np.maximum(np.ceil(profile.lengths / spacing), 1).astype(np.int64)
    segment, share, length = _cells(cells, profile.lengths / cells, rng.random(cells.sum()))
    return SeabedPoints(segment, share), length


@compiled
def _cells(cells: NDArray[np.int64], lengths: Real, within: Real) -> tuple[NDArray[np.int64], Real, Real]:
    """Segment, share along it and length of every cell, from how many of which length each segment has."""
    segments, shares, of_cell = np.empty(len(within), np.int64), np.empty(len(within)), np.empty(len(within))
    point = 0
    for segment in range(len(cells)):
        for cell in range(cells[segment]):
            segments[point], of_cell[point] = segment, lengths[segment]
            shares[point] = (cell + within[point]) / cells[segment]
            point += 1
    return segments, shares, of_cell


def echo_spectrum(band: Band, times: Real, amplitudes: Complex, accuracy: float = 1e-12) -> Complex:
    """Spectrum of the sum of the echoes of all scatterers.

    `p(t) = sum_j a_j h(t - t_j)` with the pulse `h(t) = sum_k v_k exp(2 pi i f_k t)` of the band, `v_k = sqrt(w_k) /
    sum w`. So `P_k = v_k sum_j a_j exp(-2 pi i f_k (t_j - t_0))`: one type-1 non-uniform FFT.

    Parameters
    ----------
    band
        The band, on a time grid that starts at `t_0`.
    times
        Arrival of each scatterer's echo, `t_j` [s], shape (scatterer,).
    amplitudes
        Complex strength of each scatterer as it is heard, the phase of the carrier included, shape (rows, scatterer).
    accuracy
        Relative accuracy of the transform.

    Returns
    -------
    array
        Shape (rows, bins).
    """
    phase = (times - band.grid.start) * (2 * np.pi / band.grid.period)
    spectrum = to_spectrum(phase, amplitudes, band.harmonics.size, accuracy)
    spectrum *= np.sqrt(band.weights) / band.weights.sum()
    return spectrum


def scatterer_spectra(listening: Listening, profile: Profile, rows: range, streams: Streams) -> tuple[Complex, Complex]:
    """Noise-free spectra of rows with one section at both receivers, shape (rows, bins) each.

    Each scatterer has a circular Gaussian strength of its own in every row, so that the speckle is Gaussian at any
    density; the rows share the places. As the phase of a strength is any, it is drawn as the primary hears it; the
    secondary hears it later, and turned by `exp(-2 pi i fc tau)`. A scatterer is heard where the transmitter and that
    receiver see it.

    Parameters
    ----------
    listening
        What is seen, by what, and how many scatterers at which accuracy and level.
    profile
        The section.
    rows
        Numbers of the rows.
    streams
        Source of places and strengths.
    """
    scene, sonar, plan = listening.scene, listening.sonar, listening.plan
    # Sections that differ have places of their own.
    places = streams.of(Use.PLACES, 0 if plan.sections == "one" else rows.start)
    points, length = place_scatterers(profile, sonar.range_resolution / plan.scatterers_per_resolution, places)
    if plan.shadow:
        seen = sees(profile, points, sonar.altitude)
        points, length = points.chosen(seen), length[seen]
    times = travel_times(sonar, *profile.position(points))
    power = scatterer_power(scene, sonar, profile, points, length, plan.level)
    amplitudes = streams.gaussian(Use.SPECKLE, rows, np.sqrt(power))
    if np.isfinite(scene.speckle_shape):
        in_range = scattered(_heard_together(profile, points, length, sonar))
        shape = texture_shape(scene.speckle_shape, in_range, plan.along_track)
        amplitudes *= np.sqrt(streams.texture(rows, len(length), shape))
    primary = echo_spectrum(listening.band, times[0], amplitudes, plan.accuracy)
    turns = -sonar.centre_frequency * (times[1] - times[0])
    above = (
        sees(profile, points, sonar.altitude + sonar.baseline).astype(np.float64)
        if plan.shadow
        else np.ones(turns.size)
    )
    for row in amplitudes:
        turn(row, turns, above)
    return primary, echo_spectrum(listening.band, times[1], amplitudes, plan.accuracy)


def _heard_together(profile: Profile, points: SeabedPoints, length: Real, sonar: Sonar) -> Real:
    """Scatterers within `c / (2 B)` of slant range around each, along its own piece of seabed.

    Where the piece faces the sonar, `dr / dl` is that of the end of what is heard within `c / (4 B)`, in the mean.
    """
    slant = travel_times(sonar, *profile.position(points))[0] * sonar.sound_speed / 2
    closing = np.abs(profile.closing(points, sonar.altitude))
    together: Real = sonar.range_resolution / (
        length * np.maximum(closing, np.sqrt(sonar.range_resolution / (8 * slant)))
    )
    return together
