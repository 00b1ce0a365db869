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
    """The circular grid that holds all echoes of a scene at both receivers, with a guard on either side.

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
    first, _ = travel_times(sonar, near, highest)
    _, last = travel_times(sonar, far, lowest)
    guard = GUARD / sonar.bandwidth
    start = max(float(first) - guard, 0.0)
    samples = scipy.fft.next_fast_len(int(np.ceil((float(last) + guard - start) * sample_rate)))
    return TimeGrid(samples, sample_rate, start)
