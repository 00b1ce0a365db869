"""Estimators by name: those of this package, those that installed packages add, and `module:object` of one's own."""

import hashlib
import inspect
import sys
from collections.abc import Mapping, Sequence
from functools import lru_cache
from importlib import metadata
from pathlib import Path
from typing import Any

import estimators
from studies.named import imported, words_of
from studies.section import suggestion

GROUP = "twinecho.estimators"
"""Entry-point group in which a package names its estimators."""

SHIPPED = tuple(
    name for name in estimators.__all__ if hasattr(getattr(estimators, name), "estimate") and name != "Estimator"
)
"""Names of the estimator classes of this package."""


def estimator_class(name: str) -> Any:
    """What a name stands for: anything that is called with a window and options and gives an estimator.

    Raises
    ------
    ValueError
        In one line, for a name that is not known, that two packages have, or whose code cannot be imported; names the
        package.
    """
    if ":" in name:
        return imported(name, "method")
    added = installed().get(name, ())
    owners = ["twinecho"] * (name in SHIPPED) + [_package(entry) for entry in added]
    if not owners:
        known = suggestion(name, [*SHIPPED, *installed()])
        raise ValueError(f"method is {name!r}; it must be module:object, or {known}")
    if len(owners) > 1:
        raise ValueError(f"method is {name!r}, of {' and of '.join(owners)}; it must be of one package alone")
    if not added:
        return getattr(estimators, name)
    try:
        return added[0].load()
    except (Exception, SystemExit) as error:  # A package may do anything when it is imported.
        raise ValueError(f"method is {name!r} of {owners[0]}, which cannot be imported: {words_of(error)}") from None


def source_of(name: str) -> str:
    """Digest of the file that an estimator comes from, after its package if it is of one.

    Empty for what is shipped; without digest where there is no file.
    """
    if name in SHIPPED:
        return ""
    package = [] if ":" in name else [_package(entry) for entry in installed().get(name, ())]
    try:
        file = inspect.getsourcefile(inspect.unwrap(estimator_class(name)))
    except TypeError:
        file = None
    try:
        digest = [hashlib.sha256(Path(file).read_bytes()).hexdigest()[:16]] if file else []
    except OSError:
        digest = []
    return " ".join([*package, *digest])


def installed() -> Mapping[str, Sequence[metadata.EntryPoint]]:
    """Estimators that installed packages name in the entry-point group `twinecho.estimators`, by name."""
    return _on(tuple(sys.path))


@lru_cache(maxsize=8)
def _on(path: tuple[str, ...]) -> Mapping[str, Sequence[metadata.EntryPoint]]:
    found: dict[str, list[metadata.EntryPoint]] = {}
    for entry in metadata.entry_points(group=GROUP):
        found.setdefault(entry.name, []).append(entry)
    return found


def _package(entry: metadata.EntryPoint) -> str:
    return "a package without name" if entry.dist is None else f"{entry.dist.name} {entry.dist.version}"
