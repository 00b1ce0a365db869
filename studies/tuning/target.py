"""What a study file says of where an estimator is to work."""

from dataclasses import dataclass

import numpy as np

from estimators import FixedWindow
from sim import EchoPair, Sonar, expected_coherence
from sim.band import Real
from studies.design import points
from studies.patch import Patch
from studies.study import Study
from studies.swath import Swath
from studies.tuning.condition import Condition

RANGES = 201
"""At how many ground ranges the coherence of a scene is asked for."""


@dataclass(frozen=True)
class Target:
    """A sonar, looks, coherence and delays as of `Condition`, as far as they are known, and where they come from."""

    sonar: Sonar
    looks: int | None = None
    coherence: float | None = None
    delay: float = 0.5
    source: str = "a sonar"

    def condition(self, looks: int | None, coherence: float | None, delay: float | None) -> Condition:
        """With what is given in place of what is known; ValueError for what is neither."""
        given = looks if looks is not None else self.looks
        level = coherence if coherence is not None else self.coherence
        for name, value in (("looks", given), ("coherence", level)):
            if value is None:
                raise ValueError(f"{name} is missing; it must be given for {self.source}")
        assert given is not None
        assert level is not None
        return Condition(self.sonar, given, level, self.delay if delay is None else delay)


def target_of(study: Study) -> Target:
    """That of the only design point of a study.

    Of a patch its looks, coherence and delays. Of a scene the looks of the first fixed window, if there is one, and the
    lowest coherence of the flat floor over range, its patches included; delays are within half a wrap, as of a patch.

    Raises
    ------
    ValueError
        For a study of several points, or without echoes.
    """
    found = list(points(study)) if study.simulates else []
    if len(found) != 1:
        raise ValueError(f"{study.name} has {len(found)} design points; it must have one patch or scene (see --set)")
    sonar, world = found[0].sonar, found[0].world
    if isinstance(world, Patch):
        return Target(sonar, world.looks, world.true_coherence, world.delay, f"the patch of {study.name}")
    ground_range, coherence = _floor(sonar, world)
    worst = int(np.argmin(coherence))
    at = f"the floor of {study.name} at {ground_range[worst]:.4g} m, where its coherence is lowest"
    return Target(sonar, _looks(study, sonar, world), float(coherence[worst]), 0.5, at)


def _floor(sonar: Sonar, scene: Swath) -> tuple[Real, Real]:
    """Ground ranges [m], and the lowest coherence of any sediment there."""
    y = np.linspace(*scene.ground_range, RANGES)
    if scene.sediment is None:
        return y, 1 / (1 + 10 ** (-scene.snr_at(sonar, y) / 10))
    coherence = expected_coherence(sonar, scene.sediment, y, model=scene.scattering)
    for patch in scene.patches:
        near, far = patch.ground_range
        of_patch = expected_coherence(sonar, patch.sediment, y, model=scene.scattering)
        coherence = np.where((y >= near) & (y <= far), np.minimum(coherence, of_patch), coherence)
    return y, coherence


def _looks(study: Study, sonar: Sonar, scene: Swath) -> int | None:
    """Whole looks of the first fixed window of a study."""
    windows = (window for section in study.estimators for window in section.windows if isinstance(window, tuple))
    size = next(windows, None)
    if size is None:
        return None
    required = scene.required(sonar, 1)
    silence = np.zeros((size[0], size[1] + 1), dtype=complex)
    pair = EchoPair(
        silence,
        silence,
        required.grid.sample_rate,
        sonar.centre_frequency,
        sonar.bandwidth,
        row_spacing=required.along_track.spacing,
        row_looks=required.along_track.looks,
    )
    return int(FixedWindow(*size).looks(pair))
