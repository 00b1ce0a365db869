"""What a run is, written down before it starts: the study, what decides its numbers, and where they came from."""

import hashlib
import json
import os
import platform
import subprocess
from collections.abc import Mapping
from importlib import metadata
from pathlib import Path
from typing import Any

from studies.section import plain
from studies.seeds import canonical
from studies.study import KINDS, Study, made

NAME = "manifest.json"

PACKAGES = ("numpy", "scipy", "finufft", "joblib", "pyarrow", "pandas")


def design(study: Study, seed: int) -> dict[str, Any]:
    """What decides the numbers of every block beside its point: study, version, seed, trials in a block."""
    return {
        "study": study.name,
        "twinecho": metadata.version("twinecho"),
        "seed": seed,
        "trials.block": study.trials.block,
    }


def digest(made: Mapping[str, Any]) -> str:
    """SHA-256 of a design's canonical JSON."""
    return hashlib.sha256(canonical(made)).hexdigest()


def fixed(study: Study, seed: int) -> dict[str, Any]:
    """All that a run holds fixed, by key: the design, the values that are no axis, and each estimator."""
    axes = {key for axis in study.axes for key in axis}
    tree = plain(study)
    values = {
        f"{section}.{key}": value
        for section in ("sonar", *KINDS)
        for key, value in tree.get(section, {}).items()
        if f"{section}.{key}" not in axes
    }
    chosen = {f"estimators.{e.name}": {"method": e.method, "options": dict(e.options)} for e in study.estimators}
    return {**design(study, seed), **values, **chosen}


def begin(study: Study, seed: int, folder: Path) -> None:
    """Write the manifest of a run, or renew that of one of the same design.

    Raises
    ------
    ValueError
        Where the folder holds a run of another design; names what differs.
    OSError
        Where the folder cannot be written.
    """
    now, tree = fixed(study, seed), plain(study)
    path = folder / NAME
    if path.exists():
        before = read(folder)
        known = before["fixed"]
        differing = [key for key in known if key in now and known[key] != now[key]]
        if differing:
            changes = ", ".join(f"{key} was {known[key]}, is {now[key]}" for key in differing)
            raise ValueError(f"{folder} holds a run of another design: {changes}; take --fresh or another --out")
        if "estimators" in tree:
            tree["estimators"] = _together(before["study"]["estimators"], tree["estimators"])
        now = {**{key: known[key] for key in known if key.startswith("estimators.")}, **now}
    folder.mkdir(parents=True, exist_ok=True)
    written = {
        "study": tree,
        "seed": seed,
        "fixed": now,
        "digest": digest(design(study, seed)),
        "commit": _commit(),
        "versions": {name: metadata.version(name) for name in PACKAGES},
        "python": platform.python_version(),
        "machine": f"{platform.machine()}, {os.cpu_count()} processors",
    }
    beside = path.with_name(f".{NAME}.{os.getpid()}")
    try:
        beside.write_text(json.dumps(written, indent=2) + "\n")
        beside.replace(path)
    finally:
        beside.unlink(missing_ok=True)


def _together(before: list[dict[str, Any]], now: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """Estimators of an earlier run and of this one, with the windows of both."""
    by_name = {section["name"]: dict(section) for section in before}
    for section in now:
        known = by_name.get(section["name"], {})
        windows = [*known.get("windows", []), *section.get("windows", [])]
        by_name[section["name"]] = {**known, **section}
        if windows:
            by_name[section["name"]]["windows"] = [w for i, w in enumerate(windows) if w not in windows[:i]]
    return list(by_name.values())


def read(folder: Path) -> dict[str, Any]:
    """The manifest of a run; ValueError where the folder holds none that can be read."""
    try:
        found: dict[str, Any] = json.loads((folder / NAME).read_text())
        whole = {"study", "seed", "fixed"} <= set(found)
    except (OSError, ValueError, TypeError):
        whole = False
    if not whole:
        raise ValueError(f"{folder} is no folder of a run; it must hold a {NAME} that `twinecho run` wrote")
    return found


def study_of(folder: Path) -> tuple[Study, int]:
    """Study and seed of an earlier run; ValueError where this version cannot run it."""
    found = read(folder)
    return made(found["study"], str(folder / NAME)), int(found["seed"])


def _commit() -> str | None:
    """Commit of the checkout that runs, with a mark where it was changed; None outside a checkout."""
    here = Path(__file__).parent
    try:
        found = [
            subprocess.run(["git", "-C", str(here), *arguments], capture_output=True, text=True, check=False)
            for arguments in (["rev-parse", "HEAD"], ["status", "--porcelain", "--", ".", "../sim", "../estimators"])
        ]
    except OSError:
        return None
    if any(answer.returncode for answer in found):
        return None
    return found[0].stdout.strip() + ("-dirty" if found[1].stdout.strip() else "")
