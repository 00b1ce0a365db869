"""How far each estimator has come at a design point, and when it has had enough trials."""

from collections.abc import Iterable, Mapping, Sequence
from itertools import groupby

import numpy as np
from numpy.typing import NDArray

from studies import statistics
from studies.design import Point, blocks, task
from studies.measurement import Measurement
from studies.method import Method
from studies.moments import Moments
from studies.stored import Stored
from studies.study import Study, Until


class Standing:
    """What there is of one estimator at one design point, and how many blocks it needs.

    Without a rule it needs all blocks, or as many as its estimator is limited to. With one, the rule is asked when the
    blocks before 1, 2, 4, 8, ... are complete, and of these alone, so that the answer does not depend on which blocks
    were done first.

    Attributes
    ----------
    there
        Which blocks there are, shape (blocks,).
    target
        How many blocks it needs, as far as is known.
    sums
        Sums over all blocks that there are, by region; with a rule, over those of the `target` before the first gap.
    """

    def __init__(self, study: Study, limit: int | None = None) -> None:
        rule = study.trials.until
        most = blocks(study) if limit is None else min(limit, blocks(study))
        self.there: NDArray[np.bool_] = np.zeros(blocks(study), dtype=np.bool_)
        self.target = most if rule is None else 1
        self.sums: dict[str, Measurement] = {}
        self._rule, self._most, self._next = rule, most, 0

    @property
    def complete(self) -> bool:
        """Whether all blocks that it needs are there."""
        return bool(self.there[: self.target].all())

    @property
    def missing(self) -> NDArray[np.intp]:
        """Numbers of the blocks that it needs and lacks."""
        found: NDArray[np.intp] = np.flatnonzero(~self.there[: self.target])
        return found

    def lacks(self, chosen: NDArray[np.intp]) -> NDArray[np.bool_]:
        """Which of some blocks it needs and lacks."""
        lacking: NDArray[np.bool_] = ~self.there[chosen] & (chosen < self.target)
        return lacking

    def add(self, block: int, measurements: Sequence[Measurement]) -> bool:
        """Take note of a block, in order; whether it counts in the sums."""
        self.there[block] = True
        if block >= self._most:
            return False
        if self._rule is not None and (block != self._next or block >= self.target):
            return False
        for measurement in measurements:
            before = self.sums.get(measurement.region)
            self.sums[measurement.region] = before + measurement if before else measurement
        self._next += 1
        if self._next == self.target < self._most and not self._enough():
            self.target = min(2 * self.target, self._most)
        return True

    def _enough(self) -> bool:
        return self._rule is None or all(met(self._rule, measurement) for measurement in self.sums.values())


def met(rule: Until, measurement: Measurement) -> bool:
    """Whether an estimator has reached every target of a rule."""
    moments = measurement.moments
    rate, spread = statistics.ratio(moments, "wrong", "tried"), statistics.std_in_wrap(moments)
    return (
        (rule.wrap_errors is None or _errors_seen(moments) >= rule.wrap_errors)
        and (rule.wrap_rate_error is None or 0 < rate.error <= rule.wrap_rate_error * rate.value)
        and (rule.std_error is None or 0 < spread.error <= rule.std_error * spread.value)
    )


def _errors_seen(moments: Moments) -> float:
    return statistics.effective_hits(moments, "wrong") if moments.weighted else moments.wrap_errors


def measured_blocks(
    study: Study, point: Point, stored: Iterable[tuple[int, list[Stored]]]
) -> Iterable[tuple[int, dict[tuple[str, str], list[Measurement]]]]:
    """Of what is stored of a point, the whole measurements of blocks that the study asks for, by estimator."""
    most = blocks(study)
    for block, rows in stored:
        if block >= most:
            return
        trials = task(study, point, block).trials
        fitting = sorted(
            (row.measurement for row in rows if row.trials == trials), key=lambda measurement: measurement.labels
        )
        by_method = {labels: list(group) for labels, group in groupby(fitting, key=lambda m: m.labels)}
        yield block, {labels: ms for labels, ms in by_method.items() if len(ms) == ms[0].regions}


def standings(
    study: Study, point: Point, methods: Sequence[Method], stored: Iterable[tuple[int, list[Stored]]]
) -> Mapping[tuple[str, str], Standing]:
    """How far each estimator has come, from what is stored of a point; a block in memory at a time."""
    found = {method.labels: Standing(study, method.section.blocks) for method in methods}
    for block, by_method in measured_blocks(study, point, stored):
        for labels, standing in found.items():
            if labels in by_method:
                standing.add(block, by_method[labels])
    return found
