"""A study in parts on several machines, without a scheduler: shards, and how they are joined."""

import re
from collections.abc import Sequence
from pathlib import Path

import pandas as pd

from studies import manifest
from studies.design import methods, points
from studies.engine import Share, store_of
from studies.lock import only_writer
from studies.stopping import standings


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
    joined = [*parts, *([folder] if (folder / manifest.NAME).exists() else [])]
    studies = [manifest.read(part)["study"] for part in joined]
    for part, described in zip(joined, studies, strict=True):
        for key in ("axes", "points", "trials"):
            given, first = described.get(key), studies[0].get(key)
            if given != first:
                raise ValueError(f"{key} of {part} is {given}; all that is joined must have the same, {first}")
    with only_writer(folder):
        for part in parts:
            _take_over(folder, part)
    return missing_blocks(folder)


def _take_over(folder: Path, part: Path) -> None:
    """Add the blocks of a shard to those of a folder, a file for each point."""
    study, seed = manifest.study_of(part)
    if not study.simulates:
        raise ValueError(f"{part} holds a study that has no trials; it has no blocks")
    manifest.begin(study, seed, folder)
    here, there = store_of(study, seed, folder), store_of(study, seed, part)
    for point in points(study):
        here.take_over(point, there)


def missing_blocks(folder: Path) -> pd.DataFrame:
    """A row for each block of a run that is missing: point, its values, block, and the estimators that lack it."""
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
