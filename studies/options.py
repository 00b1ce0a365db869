"""What an estimator of a study is called with: numbers and words, windows, and estimators that it is made of."""

from collections.abc import Iterator, Mapping
from types import MappingProxyType
from typing import Annotated, Any

from pydantic import BeforeValidator, ValidationError

from studies.section import Section, complaint

Scalar = bool | int | float | str
Size = tuple[int, int]

MADE_OF: Mapping[str, tuple[str, str]] = MappingProxyType(
    {"TwoWindow": ("wrap", "CrossCorrelation"), "CombinedNeighbours": ("estimator", "FullBandPhaseSlope")}
)
"""Shipped estimators that have no window but another estimator: what they call it, and its class where none is given.

The windows of a study are those of that one.
"""


class PartSection(Section):
    """An estimator that another one is made of.

    Parameters
    ----------
    method
        A class of `estimators`, or `module:object`, as of the estimators of a study.
    window
        [rows, samples]; that of the estimator that it is a part of where it is not given.
    options
        What else it is called with.
    """

    method: str
    window: "OwnSize | None" = None
    options: Mapping[str, "Option"] = {}


def _size(value: Any) -> Any:
    if not _is_size(value):
        raise ValueError("it must be [rows, samples], both whole numbers of at least 1")
    return tuple(value)


def _is_size(value: Any) -> bool:
    return isinstance(value, list | tuple) and len(value) == 2 and all(type(n) is int and n >= 1 for n in value)


def _option(value: Any) -> Any:
    if isinstance(value, Mapping):
        try:
            return PartSection.model_validate(value)
        except ValidationError as error:
            raise ValueError(complaint(error, PartSection)) from None
    if isinstance(value, Scalar | PartSection):
        return value
    if _is_size(value):
        return tuple(value)
    if isinstance(value, list | tuple) and value and all(_is_size(size) for size in value):
        return tuple(tuple(size) for size in value)
    raise ValueError("it must be a number, text, true, false, [rows, samples], a list of these, or a table of a method")


OwnSize = Annotated[Size, BeforeValidator(_size)]
Option = Annotated[Scalar | Size | tuple[Size, ...] | PartSection, BeforeValidator(_option)]
Options = Mapping[str, Option]
"""Of a study file, by name."""

PartSection.model_rebuild()


def searching_to(method: str, search: float | None) -> dict[str, Option]:
    """Options that give an estimator a search range [s], or the one that it is made of."""
    if search is None:
        return {}
    if method not in MADE_OF:
        return {"search": search}
    name, part = MADE_OF[method]
    return {name: PartSection(method=part, options={"search": search})}


def rows_in(options: Options) -> Iterator[int]:
    """Rows of every window that options have, those of estimators in them too."""
    for value in options.values():
        if isinstance(value, PartSection):
            yield from () if value.window is None else (value.window[0],)
            yield from rows_in(value.options)
        elif isinstance(value, tuple):
            yield from (size[0] for size in (value if isinstance(value[0], tuple) else (value,)))


def methods_in(options: Options) -> Iterator[str]:
    """Every method that options name."""
    for value in options.values():
        if isinstance(value, PartSection):
            yield value.method
            yield from methods_in(value.options)
