"""Single scatterers of a scene."""

import numpy as np

from sim.along_track import REACH
from sim.band import Complex
from sim.echoes import echo_spectrum
from sim.geometry import travel_times
from sim.listening import Listening


def add_targets(primary: Complex, secondary: Complex, listening: Listening, rows: range) -> None:
    """Add the echoes of all point targets of a scene to registered series of rows, shape (rows, samples).

    A target of level `L` has the amplitude `10^(L / 20) sinc((x - x0) / dx)` in a row at `x`, up to `REACH` resolutions
    away.
    """
    sonar, band, along_track = listening.sonar, listening.band, listening.plan.along_track
    for target in listening.scene.targets:
        away = (np.array(rows) * along_track.spacing - target.along_track) / along_track.resolution
        near = np.flatnonzero(np.abs(away) < REACH)
        if not near.size:
            continue
        arrivals = travel_times(sonar, [target.ground_range], target.height)
        level = 10 ** (target.level / 20) * listening.floor(arrivals[0])
        amplitudes: Complex = (level * np.sinc(away[near])[:, None]).astype(np.complex128)
        spectra = [
            echo_spectrum(band, arrival, amplitudes * np.exp(-2j * np.pi * sonar.centre_frequency * arrival))
            for arrival in arrivals
        ]
        primary[near] += band.series(spectra[0])
        secondary[near] += listening.registration.series(spectra[1])
