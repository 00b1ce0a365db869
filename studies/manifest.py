"""What a run is, written down before it starts: the design that decides its numbers, and where they came from."""

import hashlib
import json
import os
import platform
import subprocess
from collections.abc import Mapping
from dataclasses import fields
from importlib import metadata
from pathlib import Path
from typing import Any, get_origin, get_type_hints

from studies.seeds import canonical
from studies.study import Study

NAME = "manifest.json"


def design(study: Study, seed: int) -> dict[str, Any]:
    """What decides the numbers of every block: the study but for its axes and trials, the seed, the version."""
    return {
        "study": study.name,
        "twinecho": metadata.version("twinecho"),
        "seed": seed,
        **{field.name: getattr(study, field.name) for field in fields(study) if field.name not in study.axes},
    }


def digest(made: Mapping[str, Any]) -> str:
    """SHA-256 of a design's canonical JSON."""
    return hashlib.sha256(canonical(made)).hexdigest()


def begin(study: Study, seed: int, methods: tuple[str, ...], folder: Path) -> None:
    """Write the manifest of a run, or renew that of one of the same design.

    Raises
    ------
    ValueError
        Where the folder holds a run of another design; names what differs.
    OSError
        Where the folder cannot be written.
    """
    made = _as_json(design(study, seed))
    path = folder / NAME
    known: list[str] = []
    if path.exists():
        before = read(folder)
        differing = [key for key in {**before["design"], **made} if before["design"].get(key) != made.get(key)]
        if differing:
            changes = ", ".join(f"{key} was {before['design'].get(key)}, is {made.get(key)}" for key in differing)
            raise ValueError(f"{folder} holds a run of another design: {changes}; take --fresh or another --out")
        known = before["methods"]
    folder.mkdir(parents=True, exist_ok=True)
    written = {
        "design": made,
        "question": study.question,
        "parameters": {field.name: getattr(study, field.name) for field in fields(study)},
        "methods": [name for name in study.methods() if name in {*known, *methods}],
        "commit": _commit(),
        "versions": {name: metadata.version(name) for name in ("numpy", "scipy", "finufft", "joblib", "pyarrow")},
        "python": platform.python_version(),
        "machine": f"{platform.machine()}, {os.cpu_count()} processors",
    }
    beside = path.with_name(f".{NAME}.{os.getpid()}")
    beside.write_text(json.dumps(written, indent=2) + "\n")
    beside.replace(path)


def read(folder: Path) -> dict[str, Any]:
    """The manifest of a run; ValueError where the folder holds none that can be read."""
    try:
        found: dict[str, Any] = json.loads((folder / NAME).read_text())
        whole = {"design", "parameters", "methods"} <= set(found) and "study" in found["design"]
    except (OSError, ValueError, TypeError):
        whole = False
    if not whole:
        raise ValueError(f"{folder} is no folder of a run; it must hold a {NAME} that `twinecho run` wrote")
    return found


def restored(kind: type[Study], parameters: Mapping[str, Any]) -> Study:
    """The study of a manifest; ValueError where its parameters are not those of this version."""
    types = get_type_hints(kind)
    if set(parameters) != {field.name for field in fields(kind)}:
        raise ValueError(f"the manifest's parameters are {', '.join(parameters)}; they are not those of {kind.name}")
    return kind(**{k: tuple(v) if get_origin(types[k]) is tuple else v for k, v in parameters.items()})


def _as_json(made: Mapping[str, Any]) -> dict[str, Any]:
    same: dict[str, Any] = json.loads(json.dumps(made))
    return same


def _commit() -> str | None:
    """Commit of the checkout that runs, with a mark where it was changed; None outside a checkout."""
    here = Path(__file__).parent
    found = [
        subprocess.run(["git", "-C", str(here), *arguments], capture_output=True, text=True, check=False)
        for arguments in (["rev-parse", "HEAD"], ["status", "--porcelain", "--", "."])
    ]
    if any(answer.returncode for answer in found):
        return None
    return found[0].stdout.strip() + ("-dirty" if found[1].stdout.strip() else "")
