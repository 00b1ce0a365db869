"""The shipped studies: a study file each, and for some a small module that draws a figure."""

from importlib import resources
from pathlib import Path

from studies import manifest
from studies.section import suggestion
from studies.study import Study, load

NAMES = tuple(
    sorted(
        entry.name.removesuffix(".toml")
        for entry in resources.files(__name__).iterdir()
        if entry.name.endswith(".toml")
    )
)
"""Names of the shipped studies."""


def path_of(name: str) -> Path:
    """The study file of a shipped study; ValueError for an unknown name."""
    if name not in NAMES:
        raise ValueError(f"study is {name!r}; it must be a study file, or {suggestion(name, NAMES)}")
    return Path(str(resources.files(__name__) / f"{name}.toml"))


def study(name: str) -> Study:
    """A shipped study by its name, a study file by its path, or the study of a run by that of its manifest.

    Raises
    ------
    ValueError
        For a name that is neither, and for what is wrong in a file.
    OSError
        Where the file cannot be read.
    """
    path = Path(name)
    if path.name == manifest.NAME:
        return manifest.study_of(path.parent)[0]
    return load(path if path.suffix == ".toml" else path_of(name))
