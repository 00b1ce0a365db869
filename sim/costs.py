"""What a simulation takes of time and memory, before it runs."""

from typing import TYPE_CHECKING

import numpy as np

from sim.scene import Scene
from sim.sonar import Sonar

if TYPE_CHECKING:
    from sim.plan import Plan

SAME, DIFFERENT = 16, 4
"""Rows that are transformed together: of one section, and of sections of their own, as many as the cache holds."""

SECONDS: dict[str, float] = {
    "corner": 300e-9,
    "hidden": 50e-9,
    "seen": 5e-9,
    "level": 14e-9,
    "scatterer": 95e-9,
    "registered": 80e-9,
    "drawn": 35e-9,
    "warped": 30e-9,
    "cut": 14e-9,
    "noise": 45e-9,
    "kept": 35e-9,
    "filtered": 0.45e-9,
}
"""Time of one core for a corner of a section; for a sample that may lie in shadow, and a part that may be seen; for its
level; for a scatterer at both receivers; for a sample of secondary and noise registered; for one of a primary drawn, of
a warp of it, and of the band it is cut to; for one of noise in both; for one that is heard and kept; for a sample and
row of the along-track filter. Measured on one core of a shared server at 2.5 GHz, where whole scenes took .8 to 1.6
times as long as they say; others differ."""


def costs(scene: Scene, sonar: Sonar, made: "Plan", rows: int, corners: int) -> dict[str, tuple[float, float]]:
    """Seconds and bytes at once for all rows, of every decision that costs some.

    Parameters
    ----------
    scene, sonar, made
        What is seen, by what, and how it is simulated.
    rows
        How many.
    corners
        Of a section.
    """
    raw, samples = rows + 2 * made.along_track.halo, made.grid.samples
    sections, together = (1, min(raw, SAME)) if made.sections == "one" else (raw, min(raw, DIFFERENT))
    scatterers = float(np.diff(scene.ground_range)[0]) / sonar.range_resolution * made.scatterers_per_resolution
    if made.delays == "scatterers":
        parts = scatterers
        echoes = raw * (scatterers * SECONDS["scatterer"] + samples * SECONDS["registered"])
        # Strengths of the rows of one section, and of each scatterer where it is, when it is heard and how strong.
        held = scatterers * (16.0 * (together if sections == 1 else 1) + 80.0)
    else:
        parts = samples
        echoes = raw * samples * (SECONDS["drawn"] + SECONDS["warped"])
        held = 0.0
    series = 2.0 * raw * samples * (8 if made.single else 16)
    return {
        # The truth of rows, by itself and stacked.
        "sections": (sections * corners * SECONDS["corner"], sections * samples * 52.0),
        "shadow": (sections * (parts * SECONDS["seen"] + samples * SECONDS["hidden"]) if made.shadow else 0.0, 0.0),
        "delays": (echoes, held),
        "baseline": (raw * samples * SECONDS["cut"] if made.baseline and made.delays == "warp" else 0.0, 0.0),
        "level": (sections * parts * SECONDS["level"] if made.level != "even" else 0.0, 0.0),
        "along_track": (rows * samples * (2 * made.along_track.halo + 1) * SECONDS["filtered"], 0.0),
        # What is kept, and echoes and noise of the rows at work.
        "grid": (raw * samples * (SECONDS["noise"] + SECONDS["kept"]), series + together * samples * 96.0),
    }
