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
from studies.estimator_names import estimator_class, source_of
from studies.named import words_of
from studies.options import MADE_OF, Option, Options, PartSection, methods_in
from studies.section import Section, plain, suggestion
from studies.window_section import PolicySection, WindowSection
from studies.world import World


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
        What else it is called with: numbers, text, true or false, [rows, samples] for a window and a list of these for
        several, or for another estimator a table (`studies.options.PartSection`).
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
        return _made(self.section.method, self.window, self.section.options, rng)


def _made(method: str, window: WindowPolicy, options: Options, rng: np.random.Generator) -> Estimator:
    make = estimator_class(method)
    takes = _parameters(make)
    if takes is not None:
        unknown = [option for option in options if option not in takes]
        if unknown:
            known = suggestion(unknown[0], [name for name in takes if name not in ("window", "rng")])
            raise ValueError(f"option {unknown[0]} is not one of {method}; it must be {known}")
    given = {name: _value(value, window, rng) for name, value in options.items()}
    if method in MADE_OF:
        name, part = MADE_OF[method]
        given[name] = given[name] if name in given else _made(part, window, {}, rng)
    if takes is not None and "rng" in takes:
        given["rng"] = rng
    try:
        made = make(**given) if method in MADE_OF else make(window, **given)
    except (Exception, SystemExit) as error:  # A user's class may do anything.
        raise ValueError(f"{method} cannot be made with {plain_options(options)}: {words_of(error)}") from None
    if not isinstance(made, Estimator):
        raise ValueError(f"{method} gives {made!r}; it must have a method estimate(pair)")
    return made


def _value(option: Any, window: WindowPolicy, rng: np.random.Generator) -> Any:
    """What an option stands for: an estimator, with the window of the one that it is a part of, windows, or itself."""
    if isinstance(option, PartSection):
        own = window if option.window is None else FixedWindow(*option.window)
        return _made(option.method, own, option.options, rng)
    if isinstance(option, tuple):
        return tuple(FixedWindow(*size) for size in option) if isinstance(option[0], tuple) else FixedWindow(*option)
    return option


def plain_options(options: Options) -> dict[str, Any]:
    """As JSON can hold them."""
    return {name: plain(value) if isinstance(value, PartSection) else value for name, value in options.items()}


def methods_of(sections: tuple[EstimatorSection, ...], world: World) -> list[Method]:
    """Every estimator with each of its windows, for a world that says how long a record is."""
    return [Method(section, _policy(window, world)) for section in sections for window in section.windows]


def _policy(window: WindowSection, world: World) -> WindowPolicy:
    if isinstance(window, PolicySection):
        return window.window()
    return FixedWindow(*(world.record() if window == "record" else window))


def sources_of(section: EstimatorSection) -> str:
    """Where what is not shipped comes from, of the estimator and of those that it is made of (`source_of`)."""
    return " ".join(filter(None, map(source_of, (section.method, *methods_in(section.options)))))


def _parameters(make: Any) -> list[str] | None:
    """Names of what it can be called with; None where it takes anything."""
    try:
        parameters = inspect.signature(make).parameters.values()
    except (TypeError, ValueError):
        return None
    if any(parameter.kind is parameter.VAR_KEYWORD for parameter in parameters):
        return None
    return [parameter.name for parameter in parameters]
