"""What one block of trials tells of one estimator."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

from sim.band import Real
from studies.drawing import Traces
from studies.moments import Moments


class Failure(NamedTuple):
    """A trial in which an estimator gave no number, and what it said."""

    trial: int
    error: str


@dataclass(frozen=True, eq=False)
class Measurement:
    """Errors of one estimator in one block of trials, summed.

    Attributes
    ----------
    estimator, window, region
        What tells this measurement from others of the same block.
    regions
        How many regions the estimate was read in.
    facts
        Numbers that belong to it: looks, bounds, predictions. The same in every block but for what follows from a
        window or coherence that each block measures; of these the mean over clusters.
    moments
        Sums over the errors.
    batches
        Sums over parts of the block of what is compared between estimators, shape (batch, 3).
    failures
        Estimates that gave no number.
    failed
        The trials in which they did.
    flagged
        Estimates that the estimator itself called invalid.
    seconds_per_pixel
        Time of the estimate over the number of pixels; the mean over clusters.
    """

    estimator: str
    window: str
    region: str
    regions: int
    facts: Mapping[str, float]
    moments: Moments
    batches: Real
    failures: int
    failed: Sequence[Failure]
    flagged: int
    seconds_per_pixel: float

    @property
    def labels(self) -> tuple[str, str]:
        """Of the method that made it."""
        return self.estimator, self.window

    def __add__(self, other: "Measurement") -> "Measurement":
        """The same estimator over this block and a later one; batches and failed trials are those of the later."""
        clusters = self.moments.clusters, other.moments.clusters
        seconds = clusters[0] * self.seconds_per_pixel + clusters[1] * other.seconds_per_pixel
        return replace(
            other,
            facts={name: _mean((self.facts[name], fact), clusters) for name, fact in other.facts.items()},
            moments=self.moments + other.moments,
            failures=self.failures + other.failures,
            flagged=self.flagged + other.flagged,
            seconds_per_pixel=seconds / sum(clusters),
        )


def _mean(values: tuple[float, float], clusters: tuple[int, int]) -> float:
    """Mean over clusters of a fact; itself, to the last bit, where it is the same."""
    if values[0] == values[1]:
        return values[0]
    return (values[0] * clusters[0] + values[1] * clusters[1]) / sum(clusters)


@dataclass(frozen=True, eq=False)
class Block:
    """What one block of trials of one design point measured, and an example of it."""

    measurements: Sequence[Measurement]
    traces: Traces
