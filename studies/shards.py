"""A study in parts on several machines, without a scheduler: shards, and how they are joined."""

import re
from collections.abc import Sequence
from pathlib import Path

import pandas as pd

from studies import manifest
from studies.design import methods, points, task
from studies.engine import Share, store_of
from studies.measurement import Block
from studies.stopping import measured_blocks, standings


def parsed(text: str) -> Share:
    """A share from text such as `3/10`; ValueError for what is none."""
    found = re.fullmatch(r"(\d+)/(\d+)", text.strip())
    if not found:
        raise ValueError(f"shard is {text!r}; it must be K/N, such as 3/10")
    return Share(int(found[1]), int(found[2]))


def merge(folder: Path, parts: Sequence[Path]) -> pd.DataFrame:
    """Join the blocks of runs of one design into a folder, with those that are there.

    Parameters
    ----------
    folder
        Of the whole run; made where it does not exist.
    parts
        Folders of its shards.

    Returns
    -------
    DataFrame
        A row for each block that is missing: point, its values, block, and the estimators that lack it.

    Raises
    ------
    ValueError
        Where a folder holds no run, or one of another design.
    OSError
        Where the folder cannot be written.
    """
    for part in parts:
        study, seed = manifest.study_of(part)
        manifest.begin(study, seed, folder)
        here, there = store_of(study, seed, folder), store_of(study, seed, part)
        for point in points(study):
            for number, by_method in measured_blocks(study, point, there.read(point)):
                traces = there.read_traces(point) if number == 0 else {}
                together = [measurement for group in by_method.values() for measurement in group]
                if together:
                    here.write(task(study, point, number), Block(together, traces))
            here.compact(point)
    study, seed = manifest.study_of(folder)
    store, rows = store_of(study, seed, folder), []
    for point in points(study):
        found = standings(study, point, methods(study, point), store.read(point))
        lacking: dict[int, list[str]] = {}
        for labels, standing in found.items():
            for block in standing.missing.tolist():
                lacking.setdefault(block, []).append(" ".join(labels))
        rows += [
            {"point": point.number, **point.columns, "block": block, "estimators": ", ".join(names)}
            for block, names in sorted(lacking.items())
        ]
    return pd.DataFrame(rows)
