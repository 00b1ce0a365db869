"""What a study simulates: something that gives echoes, and tells which estimates are to be held against which truth."""

from typing import Any, NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from estimators import DelayEstimate
from estimators.windows import Window
from sim import EchoPair, Sonar
from sim.band import Real


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
    """

    region: str
    errors: Real
    rows: slice
    samples: slice | NDArray[np.bool_]

    def of(self, array: NDArray[Any]) -> NDArray[Any]:
        """The same estimates in another array of the shape of the pair."""
        chosen: NDArray[Any] = array[self.rows][:, self.samples]
        return chosen


class World(Protocol):
    """A patch or a scene. Its rows along track are independent: as many as trials."""

    @property
    def true_coherence(self) -> float:
        """Coherence that noise leaves between the two series."""

    @property
    def snr_db(self) -> float:
        """Signal-to-noise ratio of either receiver that gives this coherence [dB]."""

    def record(self) -> tuple[int, int]:
        """Rows and samples of the window that is asked for as `record`; ValueError where there is none."""

    def check(self, sonar: Sonar) -> None:
        """ValueError where this sonar cannot see it."""

    def shape(self, sonar: Sonar, trials: int) -> tuple[int, int]:
        """Shape of these echoes, (rows, samples)."""

    def simulate(self, sonar: Sonar, trials: int, rng: np.random.Generator) -> EchoPair:
        """Echoes of some trials."""

    def read(self, pair: EchoPair, window: Window, estimate: DelayEstimate) -> list[Reading]:
        """Errors of an estimate, by region."""

    def traces(self, pair: EchoPair) -> dict[str, Real]:
        """What figures show of the first row, by name."""
