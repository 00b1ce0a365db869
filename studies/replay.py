"""One block of a run again, and one trial of it."""

import numpy as np
import pandas as pd

from studies.design import Task, blocks, methods, points, task
from studies.measure import apply, echoes, measure
from studies.study import Study
from studies.table import row


def one_block(study: Study, seed: int, point: int, block: int) -> pd.DataFrame:
    """Statistics of one block, and the first error of each estimator that failed.

    Raises
    ------
    ValueError
        For a point or block that the study does not have.
    """
    again = _task(study, point, block)
    measured = measure(again, methods(study, again.point), study.trials.block, seed).measurements
    table = pd.DataFrame([row(again.point, measurement) for measurement in measured])
    columns = ["estimator", "window", "region", "trials", "failures", "wrap_errors", "delay_bias", "delay_std_in_wrap"]
    shown = table[[*columns, "rmse"]]
    errors = [f"trial {m.failed[0].trial}: {m.failed[0].error}" if m.failed else "" for m in measured]
    return shown.assign(error=errors) if any(errors) else shown


def one_trial(study: Study, seed: int, point: int, block: int, trial: int) -> pd.DataFrame:
    """What each estimator makes of one trial: its estimates beside their errors, one row for each.

    Raises
    ------
    ValueError
        For a point, block or trial that the study does not have.
    """
    again = _task(study, point, block)
    _check("trial", trial, again.trials)
    pair = echoes(again, study.trials.block, seed)
    rows: list[pd.DataFrame] = []
    for method in methods(study, again.point):
        _, made = apply(method, pair, again, seed)
        said = {failure.trial: failure.error for failure in made.raised}.get(trial, "")
        for reading in again.point.world.read(pair, method.window.on(pair), made.estimate):
            of_rows = np.arange(pair.shape[0])[reading.rows]
            if trial not in of_rows:
                continue
            here = int(np.flatnonzero(of_rows == trial)[0])
            values = {
                name: reading.of(getattr(made.estimate, name))[here]
                for name in (
                    "delay",
                    "coherence",
                    "debiased_coherence",
                    "delay_std",
                    "wrap_error_probability",
                    "quality",
                    "valid",
                )
            }
            counted = np.broadcast_to(reading.counted, reading.errors.shape)[here]
            shown = pd.DataFrame({"delay_error": reading.errors[here], **values}).loc[counted]
            shown.insert(0, "region", reading.region)
            shown.insert(0, "window", str(method.window))
            shown.insert(0, "estimator", method.section.name)
            rows.append(shown.assign(error=said) if said else shown)
    return pd.concat(rows, ignore_index=True)


def _task(study: Study, point: int, block: int) -> Task:
    if not study.simulates:
        raise ValueError(f"{study.name} has no trials; it has no blocks")
    design = list(points(study))
    _check("point", point, len(design))
    _check("block", block, blocks(study))
    return task(study, design[point], block)


def _check(name: str, number: int, available: int) -> None:
    if not 0 <= number < available:
        raise ValueError(f"{name} is {number}; it must lie between 0 and {available - 1}")
