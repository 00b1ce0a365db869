"""What a study is: a question, its design points, and what one block of trials measures."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import Field, dataclass, replace
from typing import Any, ClassVar, Protocol, Self

import numpy as np
import pandas as pd
from matplotlib.figure import Figure as Drawing

from estimators import Estimator, FixedWindow
from sim.band import Real
from studies.moments import Moments

Point = Mapping[str, Any]
"""Parameters of one design point; what JSON can hold."""

Traces = Mapping[str, Real]
"""Arrays of one example, by name, for figures."""


@dataclass(frozen=True, eq=False)
class Measurement:
    """Errors of one estimator in one block of trials, summed.

    Attributes
    ----------
    labels
        What tells this measurement from others of the same design point: estimator, window, region.
    facts
        Numbers that belong to it: looks, bounds, predictions; the same in every block.
    moments
        Sums over the errors.
    failures
        Estimates that gave no number.
    failure
        What the first of them said, and the trial; empty where none failed.
    seconds_per_pixel
        Time of the estimate over the number of pixels; the mean over clusters.
    """

    labels: Mapping[str, str]
    facts: Mapping[str, float]
    moments: Moments
    failures: int
    failure: str
    seconds_per_pixel: float

    def __add__(self, other: "Measurement") -> "Measurement":
        """The same estimator over this block and a later one."""
        clusters = self.moments.clusters, other.moments.clusters
        return replace(
            self,
            moments=self.moments + other.moments,
            failures=self.failures + other.failures,
            failure=self.failure or other.failure,
            seconds_per_pixel=(clusters[0] * self.seconds_per_pixel + clusters[1] * other.seconds_per_pixel)
            / sum(clusters),
        )


@dataclass(frozen=True, eq=False)
class Block:
    """What one block of trials of one design point measured, and an example of it."""

    measurements: Sequence[Measurement]
    traces: Traces


class Study(Protocol):
    """A question that a sweep of simulations answers; its fields are the parameters that a user may set."""

    __dataclass_fields__: ClassVar[dict[str, Field[Any]]]
    name: ClassVar[str]
    question: ClassVar[str]
    axes: ClassVar[frozenset[str]]
    """Parameters that only add or leave out design points or trials, and change the numbers of none."""

    @property
    def trials(self) -> int:
        """Trials at each design point."""

    @property
    def block_trials(self) -> int:
        """Trials in one block."""

    def quick(self) -> Self:
        """A smaller study of the same question, for a first look."""

    def points(self) -> Sequence[Point]:
        """The design points."""

    def methods(self) -> Mapping[str, Callable[[FixedWindow], Estimator]]:
        """The estimators that it compares, by name."""

    def measure(self, point: Point, methods: Sequence[str], trials: int, rng: np.random.Generator) -> Block:
        """Simulate trials of a point and apply the named methods to the same echoes."""

    def summary(self, table: pd.DataFrame) -> pd.DataFrame:
        """The few columns and rows that answer the question on a terminal."""

    def figures(self, table: pd.DataFrame, traces: Sequence[tuple[Point, Traces]]) -> Mapping[str, Drawing]:
        """Draw the results, by file name without its ending."""
