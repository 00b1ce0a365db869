"""What there is of a run."""

from pathlib import Path
from typing import Any

import pandas as pd

from studies.design import methods, points
from studies.engine import store_of
from studies.stopping import Standing, measured_blocks
from studies.study import Study


def status(study: Study, seed: int, folder: Path) -> pd.DataFrame:
    """Blocks of each design point that are there with all estimators, that are missing, and that hold failures."""
    if not study.simulates:
        raise ValueError(f"{folder} holds a study that has no trials; it has no blocks")
    store, rows = store_of(study, seed, folder), []
    for point in points(study):
        found = {method.labels: Standing(study, method.section.blocks) for method in methods(study, point)}
        failed = 0
        for block, by_method in measured_blocks(study, point, store.read(point)):
            failed += any(measurement.failures for group in by_method.values() for measurement in group)
            for labels, standing in found.items():
                if labels in by_method:
                    standing.add(block, by_method[labels])
        wanted = max(standing.target for standing in found.values())
        lacking = {block for standing in found.values() for block in standing.missing.tolist()}
        row: dict[str, Any] = {"point": point.number, **point.columns}
        rows.append({**row, "there": wanted - len(lacking), "missing": len(lacking), "failed": failed})
    return pd.DataFrame(rows)
