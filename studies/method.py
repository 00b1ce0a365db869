"""The estimators of a study: which classes, with which windows and options."""

import hashlib
import inspect
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated, Any

import numpy as np
from pydantic import Field

from estimators import Estimator, FixedWindow
from estimators.windows import WindowPolicy
from studies.estimator_names import estimator_class
from studies.named import words_of
from studies.section import Section, suggestion
from studies.window_section import PolicySection, WindowSection
from studies.world import World

Option = bool | int | float | str


class EstimatorSection(Section):
    """One estimator with its windows.

    Parameters
    ----------
    name
        What the tables call it.
    method
        A class of `estimators`, the entry point of an installed package, or `module:object` of one's own: anything that
        is called with a window and the options and gives an estimator. If it takes `rng`, it gets a random generator of
        its own.
    windows
        Each [rows, samples], "record" for all of a patch's record, or a policy (`PolicySection`); it is tried with
        every one of them.
    options
        What else it is called with.
    blocks
        In how many blocks of a design point it is tried, from the first on; in all by default. For what takes long.
    """

    name: Annotated[
        str,
        Field(pattern=r"^[A-Za-z0-9][A-Za-z0-9 ._+-]*$", description="letters, digits, spaces and any of . _ + -"),
    ]
    method: str
    windows: Annotated[tuple[WindowSection, ...], Field(min_length=1)] = ("record",)
    options: Mapping[str, Option] = {}
    blocks: Annotated[int, Field(ge=1)] | None = None


@dataclass(frozen=True)
class Method:
    """An estimator of a study with one of its windows."""

    section: EstimatorSection
    window: WindowPolicy

    @property
    def labels(self) -> tuple[str, str]:
        """Name and window: what tells it from the others of the study."""
        return self.section.name, str(self.window)

    def stream(self) -> int:
        """Number of the stream of random numbers that it may draw from; the echoes have 0."""
        digest = hashlib.sha256("\n".join(self.labels).encode()).digest()
        return int.from_bytes(digest[:4], "big") | 1

    def build(self, rng: np.random.Generator) -> Estimator:
        """The estimator; ValueError where it cannot be made so."""
        make = estimator_class(self.section.method)
        given: dict[str, Any] = dict(self.section.options)
        takes = _parameters(make)
        if takes is not None:
            unknown = [option for option in given if option not in takes]
            if unknown:
                known = suggestion(unknown[0], [name for name in takes if name not in ("window", "rng")])
                raise ValueError(f"option {unknown[0]} is not one of {self.section.method}; it must be {known}")
            if "rng" in takes:
                given["rng"] = rng
        try:
            made = make(self.window, **given)
        except (Exception, SystemExit) as error:  # A user's class may do anything.
            options = {name: value for name, value in given.items() if name != "rng"}
            raise ValueError(f"{self.section.method} cannot be made with {options}: {words_of(error)}") from None
        if not isinstance(made, Estimator):
            raise ValueError(f"{self.section.method} gives {made!r}; it must have a method estimate(pair)")
        return made


def methods_of(sections: tuple[EstimatorSection, ...], world: World) -> list[Method]:
    """Every estimator with each of its windows, for a world that says how long a record is."""
    return [Method(section, _policy(window, world)) for section in sections for window in section.windows]


def _policy(window: WindowSection, world: World) -> WindowPolicy:
    if isinstance(window, PolicySection):
        return window.window()
    return FixedWindow(*(world.record() if window == "record" else window))


def _parameters(make: Any) -> list[str] | None:
    """Names of what it can be called with; None where it takes anything."""
    try:
        parameters = inspect.signature(make).parameters.values()
    except (TypeError, ValueError):
        return None
    if any(parameter.kind is parameter.VAR_KEYWORD for parameter in parameters):
        return None
    return [parameter.name for parameter in parameters]
