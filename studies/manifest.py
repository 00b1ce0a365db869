"""What a run is, written down before it starts: the study, what decides its numbers, and where they came from."""

import hashlib
import json
import os
import platform
import subprocess
from collections.abc import Iterable, Mapping
from importlib import metadata
from pathlib import Path
from typing import Any

from studies import seeds
from studies.method import plain_options, sources_of
from studies.section import plain, resolved
from studies.seeds import canonical
from studies.study import Study, made

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
    values = {**_flat("sonar", resolved(study.sonar)), **_flat(study.kind, resolved(getattr(study, study.kind)))}
    chosen = {
        f"estimators.{e.name}": {"method": e.method, "options": plain_options(e.options), "source": sources_of(e)}
        for e in study.estimators
    }
    return {**design(study, seed), **{k: v for k, v in values.items() if k not in axes}, **chosen}


def _flat(section: str, values: Mapping[str, Any]) -> dict[str, Any]:
    return {f"{section}.{key}": value for key, value in values.items()}


def differences(before: Mapping[str, Any], now: Mapping[str, Any], axes: Iterable[str]) -> list[str]:
    """Keys that two runs hold fixed at different values; an estimator or an axis may be in one of them only."""
    varied = set(axes)
    keys = [key for key in {**before, **now} if key not in varied]
    both = [key for key in keys if not key.startswith("estimators.") or (key in before and key in now)]
    return [key for key in both if before.get(key) != now.get(key)]


def begin(study: Study, seed: int, folder: Path) -> None:
    """Write the manifest of a run, or add to that of one of the same design.

    Raises
    ------
    ValueError
        Where the folder holds a run of another design; names what differs.
    OSError
        Where the folder cannot be written.
    """
    now, tree = fixed(study, seed), plain(study)
    path = folder / NAME
    runs = []
    if path.exists():
        before = read(folder)
        known, runs = before["fixed"], before["runs"]
        axes = [key for which in (before["study"], tree) for axis in which.get("axes", []) for key in axis]
        differing = differences(known, now, axes)
        if differing:
            changes = ", ".join(f"{key} was {known.get(key)}, is {now.get(key)}" for key in differing)
            raise ValueError(f"{folder} holds a run of another design: {changes}; take --fresh or another --out")
        if "estimators" in tree:
            tree["estimators"] = _together(before["study"]["estimators"], tree["estimators"])
        now = {**{key: known[key] for key in known if key.startswith("estimators.")}, **now}
    folder.mkdir(parents=True, exist_ok=True)
    here = provenance()
    written = {
        "study": tree,
        "seed": seed,
        "fixed": now,
        "digest": digest(design(study, seed)),
        "runs": [*(run for run in runs if run != here), here],
    }
    beside = path.with_name(f".{NAME}.{os.getpid()}")
    try:
        beside.write_text(json.dumps(written, indent=2) + "\n")
        beside.replace(path)
    finally:
        beside.unlink(missing_ok=True)


def provenance() -> dict[str, Any]:
    """Where numbers made now come from: commit, and whether it was changed; versions; machine."""
    return {
        "commit": _commit(),
        "python": platform.python_version(),
        "machine": f"{platform.machine()}, {os.cpu_count()} processors",
        **{name: metadata.version(name) for name in PACKAGES},
    }


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
    kinds = {"study": dict, "seed": int, "fixed": dict, "runs": list}
    try:
        found: dict[str, Any] = json.loads((folder / NAME).read_text())
        whole = all(isinstance(found[key], kind) for key, kind in kinds.items())
        whole = whole and bool(found["runs"]) and all(isinstance(run, dict) for run in found["runs"])
        of_estimators = (value for key, value in found["fixed"].items() if key.startswith("estimators."))
        whole = whole and all(isinstance(value, dict) and "method" in value for value in of_estimators)
    except (OSError, ValueError, TypeError, KeyError):
        whole = False
    if not whole:
        raise ValueError(f"{folder} is no folder of a run; it must hold a {NAME} that `twinecho run` wrote")
    seeds.check(found["seed"])
    return found


def study_of(folder: Path) -> tuple[Study, int]:
    """Study and seed of an earlier run; ValueError where this version cannot run it."""
    found = read(folder)
    return made(found["study"], str(folder / NAME)), found["seed"]


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
