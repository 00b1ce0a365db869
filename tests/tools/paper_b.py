"""The sonar of paper B, and what it hears."""

import numpy as np

from sim import SONARS, EchoPair, Geometry, speckle_pair

SONAR = SONARS["hisas-1032"]
FC, B, C, D, H = 122e3, 30e3, 1480.0, 0.3, 42.0

GEOMETRY = Geometry(SONAR, 2 * 300.0 / C)
"""Of what is heard from a slant range of 300 m on."""


def pair_at(ground_range, shape=(61, 64), sample_rate=40e3):
    """Silence, heard from a ground range on."""
    start = 2 * np.hypot(ground_range, H) / C
    nothing = np.zeros(shape, dtype=complex)
    return EchoPair(nothing, nothing, sample_rate, FC, B, geometry=Geometry(SONAR, start))


def patch(coherence, rows=81, samples=2048, seed=1):
    """Speckle without a geometry."""
    return speckle_pair(
        (rows, samples),
        coherence=coherence,
        delay=0.0,
        centre_frequency=FC,
        bandwidth=B,
        sample_rate=4 / 3 * B,
        rng=np.random.default_rng(seed),
    )
