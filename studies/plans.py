"""What the simulation of scenes leaves out, saves and costs, as a study asks for it."""

from collections.abc import Mapping
from typing import Annotated, Any

import numpy as np
import pandas as pd
from pydantic import Field

from sim import Sonar
from studies.section import Section
from studies.shortcut import STATISTICS, Comparison, Timed, compare
from studies.swath import Swath

DECISIONS = ("delays", "baseline", "shadow", "sections")

COLUMNS = (
    "scene",
    *DECISIONS,
    "planned_seconds",
    "full_seconds",
    "ratio",
    "near",
    "far",
    *(f"{name}_{of}" for name in STATISTICS for of in ("difference", "se", "tolerance")),
    "agrees",
)
"""Of the table."""


class Plans(Section):
    """Scenes that are simulated as planned and in full.

    Parameters
    ----------
    scenes
        By name.
    rows
        Rows of a simulation.
    repeats
        How often each is done; times are the medians.
    parts
        Equal stretches of ground range in which the two are compared.
    seed
        Of speckle and noise.
    """

    scenes: Annotated[Mapping[str, Swath], Field(min_length=1)]
    rows: Annotated[int, Field(ge=1)] = 60
    repeats: Annotated[int, Field(ge=2)] = 5
    parts: Annotated[int, Field(ge=1)] = 3
    seed: Annotated[int, Field(ge=0)] = 2026

    def columns(self, sonar: Sonar) -> list[str]:
        """Columns of its table; ValueError where this sonar cannot see a scene."""
        for swath in self.scenes.values():
            swath.check(sonar)
        return list(COLUMNS)

    def table(self, sonar: Sonar) -> pd.DataFrame:
        """Decisions, processor seconds a row and differences with standard errors, a row for each stretch of a scene.

        The seconds count what rows beyond the ends cost. It `agrees` where no difference is beyond its
        tolerance by more than two of its standard errors.
        """
        rng = np.random.default_rng(self.seed)
        rows: list[dict[str, Any]] = []
        for name, swath in self.scenes.items():
            timed, found = compare(swath, sonar, rows=self.rows, repeats=self.repeats, parts=self.parts, rng=rng)
            plan = swath.required(sonar, self.rows)
            decided = {decision: getattr(plan, decision) for decision in DECISIONS}
            rows += [{"scene": name, **decided, **_row(timed, comparison)} for comparison in found]
        return pd.DataFrame(rows, columns=list(COLUMNS))


def _row(timed: Timed, found: Comparison) -> dict[str, Any]:
    planned, full = float(np.median(timed.planned)), float(np.median(timed.full))
    row: dict[str, Any] = {"planned_seconds": planned, "full_seconds": full, "ratio": full / planned}
    row |= dict(zip(("near", "far"), found.ground_range, strict=True))
    for name, difference, error, tolerance in zip(
        STATISTICS, found.difference, found.error, found.tolerance, strict=True
    ):
        row |= {f"{name}_difference": difference, f"{name}_se": error, f"{name}_tolerance": tolerance}
    beyond = np.abs(found.difference) - found.tolerance
    return {**row, "agrees": bool((beyond <= 2 * found.error).all())}
