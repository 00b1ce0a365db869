"""The instants at which a scene is recorded."""

import numpy as np
import scipy.fft

from sim.band import TimeGrid
from sim.geometry import travel_times
from sim.scene import Scene
from sim.sonar import Sonar

GUARD = 64
"""Empty resolution cells before and after the scene, so that its ends do not meet on the circular grid."""


def time_grid(scene: Scene, sonar: Sonar, sample_rate: float) -> TimeGrid:
    """The circular grid that holds all echoes of a scene at both receivers, targets too, with a guard on either side.

    Its length is rounded up to one that the FFT likes, and its period follows.

    Parameters
    ----------
    scene, sonar
        What is heard, wherever along track, and by what.
    sample_rate
        Samples per second [Hz].
    """
    lowest, highest = scene.heights
    near, far = scene.ground_range
    places = [(near, highest), (far, lowest), *((target.ground_range, target.height) for target in scene.targets)]
    first, last = travel_times(sonar, *np.array(places).T)
    guard = GUARD / sonar.bandwidth
    start = max(float(first.min()) - guard, 0.0)
    samples = scipy.fft.next_fast_len(int(np.ceil((float(last.max()) + guard - start) * sample_rate)))
    return TimeGrid(samples, sample_rate, start)
