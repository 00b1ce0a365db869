"""Estimators against each other on the same echoes: differences with their standard errors."""

from collections.abc import Sequence
from itertools import combinations
from typing import Any

import numpy as np

from sim.band import Real
from studies.measurement import Measurement
from studies.moments import PAIRED
from studies.statistics import spread_of_sum

Labels = tuple[str, str, str]


class Comparison:
    """Sums of the paired quantities of all estimators of a design point, over groups of the same trials.

    The difference of two wrap rates has the standard error of `sum_g (a_g - p_a n_g) / N - (b_g - p_b n_g) / N` over
    groups `g` of trials: what both estimators suffer alike cancels (batch means of common random numbers).
    """

    def __init__(self) -> None:
        self.labels: list[Labels] = []
        self.groups = 0
        self.totals: Real = np.zeros(0)
        self.products: Real = np.zeros((0, 0))

    def add(self, measurements: Sequence[Measurement]) -> None:
        """Add a block that all estimators have measured, always in the same order; others are left out."""
        labels = [(m.estimator, m.window, m.region) for m in measurements]
        if not self.labels:
            self.labels = labels
            self.totals = np.zeros(len(PAIRED) * len(labels))
            self.products = np.zeros((self.totals.size, self.totals.size))
        groups = {len(m.batches) for m in measurements}
        if labels != self.labels:
            return
        most = max(groups)
        sums = np.zeros((most, self.totals.size))
        for place, m in enumerate(measurements):
            sums[: len(m.batches), len(PAIRED) * place : len(PAIRED) * (place + 1)] = m.batches
        self.groups += most
        self.totals = self.totals + sums.sum(axis=0)
        self.products = self.products + sums.T @ sums

    def rows(self) -> list[dict[str, Any]]:
        """Differences of every two estimators of a region: the first less the second."""
        found = []
        for (i, first), (j, second) in combinations(enumerate(self.labels), 2):
            if first[2] == second[2]:
                found.append(
                    {
                        "region": first[2],
                        "estimator": first[0],
                        "window": first[1],
                        "other": second[0],
                        "other_window": second[1],
                        **self._difference(i, j),
                    }
                )
        return found

    def _difference(self, first: int, second: int) -> dict[str, float]:
        columns = {}
        for name, root in (("wrong", False), ("square", True)):
            weights, values = np.zeros(self.totals.size), []
            for place, sign in ((first, 1.0), (second, -1.0)):
                tried, hit = (len(PAIRED) * place + PAIRED.index(quantity) for quantity in ("tried", name))
                whole = self.totals[tried]
                value = self.totals[hit] / whole if whole > 0 else np.nan
                slope = 0.5 / np.sqrt(value) if root and value > 0 else 1.0
                weights[hit] += sign * slope / whole if whole > 0 else np.nan
                weights[tried] -= sign * slope * value / whole if whole > 0 else np.nan
                values.append(np.sqrt(value) if root else value)
            label = "rmse_difference" if root else "wrap_rate_difference"
            columns[label] = float(values[0] - values[1])
            columns[f"{label}_se"] = spread_of_sum(weights, self.products, self.groups)
        return columns
