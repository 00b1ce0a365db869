"""What a study simulates: something that gives echoes, and tells which estimates are to be held against which truth."""

from collections.abc import Mapping
from types import MappingProxyType
from typing import Any, NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from estimators import DelayEstimate
from estimators.windows import Window
from sim import EchoPair, Sonar
from sim.band import Real

RANGED = ("ground_range", "depth_per_delay", "window_rows", "sample_coherence")
"""Facts that a region of one range has besides `looks`, `coherence` and `snr_db` there: its middle [m], the depth that
a delay stands for, `r c / D` [m/s], and means over its estimates."""

EVERY = np.ones((1, 1), dtype=np.bool_)
"""All estimates, where each counts."""


class Reading(NamedTuple):
    """Errors of an estimate in one region of the echoes.

    Attributes
    ----------
    region
        Its name; empty where there is only one.
    errors
        Delay errors [s], shape (cluster, trial): clusters are independent, the trials of one need not be.
    rows, samples
        Which estimates these are.
    counted
        Which of them belong to the region; broadcasts to their shape.
    facts
        Of a region of one range: what is known of it there, and was measured besides (`RANGED`).
    """

    region: str
    errors: Real
    rows: slice
    samples: slice | NDArray[np.bool_]
    counted: NDArray[np.bool_] = EVERY
    facts: Mapping[str, float] = MappingProxyType({})

    def of(self, array: NDArray[Any]) -> NDArray[Any]:
        """The same estimates in another array of the shape of the pair."""
        chosen: NDArray[Any] = array[self.rows][:, self.samples]
        return chosen


class World(Protocol):
    """A patch or a scene, of as many rows along track as trials."""

    @property
    def true_coherence(self) -> float:
        """Coherence that noise leaves between the two series; NaN where there is not one number."""

    @property
    def snr_db(self) -> float:
        """Signal-to-noise ratio of either receiver that gives this coherence [dB]; NaN likewise."""

    @property
    def ranged(self) -> bool:
        """Whether errors are read range by range, in regions that have the facts `RANGED`."""

    @property
    def onward(self) -> bool:
        """Whether each block goes on along track where the one before ends; otherwise all are of the same place."""

    def record(self) -> tuple[int, int]:
        """Rows and samples of the window that is asked for as `record`; ValueError where there is none."""

    def check(self, sonar: Sonar) -> None:
        """ValueError where this sonar cannot see it."""

    def shape(self, sonar: Sonar, trials: int) -> tuple[int, int]:
        """Shape of these echoes, (rows, samples)."""

    def simulate(self, sonar: Sonar, trials: int, rng: np.random.Generator, first: int = 0) -> EchoPair:
        """Echoes of some trials, of which the first has a number; where blocks go on, one `rng` stands for them all."""

    def read(self, pair: EchoPair, window: Window, estimate: DelayEstimate) -> list[Reading]:
        """Errors of an estimate, by region."""

    def traces(self, pair: EchoPair) -> dict[str, Real]:
        """What figures show of the first row, by name; of blocks that go on, small images (row, column) beside it."""

    def trace(self, pair: EchoPair, estimate: DelayEstimate) -> Real:
        """What figures show of an estimate."""
