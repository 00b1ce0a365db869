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
    """Sums of the paired quantities of every two estimators of a design point, over groups of the same trials.

    The difference of two wrap rates has the standard error of `sum_g (a_g - p_a n_g) / N - (b_g - p_b n_g) / N` over
    groups `g` of trials: what both estimators suffer alike cancels (batch means of common random numbers).
    """

    def __init__(self) -> None:
        self.pairs: dict[tuple[Labels, Labels], _Pair] = {}

    def add(self, measurements: Sequence[Measurement]) -> None:
        """Add a block: every two estimators that have measured it in the same region."""
        for first, second in combinations([m for m in measurements if len(m.batches)], 2):
            if first.region == second.region:
                both = (first.estimator, first.window, first.region), (second.estimator, second.window, second.region)
                self.pairs.setdefault(both, _Pair()).add(first.batches, second.batches)

    def rows(self) -> list[dict[str, Any]]:
        """Differences of every two estimators of a region, over the blocks that both have: first less second."""
        return [
            {
                "region": first[2],
                "estimator": first[0],
                "window": first[1],
                "other": second[0],
                "other_window": second[1],
                **pair.difference(),
            }
            for (first, second), pair in self.pairs.items()
        ]


class _Pair:
    """Sums over groups of trials of the paired quantities of two estimators."""

    def __init__(self) -> None:
        self.groups = 0
        self.totals: Real = np.zeros(2 * len(PAIRED))
        self.products: Real = np.zeros((2 * len(PAIRED),) * 2)

    def add(self, first: Real, second: Real) -> None:
        sums = np.concatenate([first, second], axis=1)
        tried = PAIRED.index("tried")
        used = sums[(sums[:, tried] > 0) | (sums[:, len(PAIRED) + tried] > 0)]
        self.groups += len(used)
        self.totals = self.totals + used.sum(axis=0)
        self.products = self.products + used.T @ used

    def difference(self) -> dict[str, Any]:
        """Differences of wrap rate and RMSE [wraps], each with its standard error, and of how many trials."""
        columns: dict[str, Any] = {"trials": self.totals[PAIRED.index("tried")]}
        for name, root in (("wrong", False), ("square", True)):
            weights, values = np.zeros(self.totals.size), []
            for place, sign in ((0, 1.0), (1, -1.0)):
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
