"""Sections of a study file: checked when made, and complaints about them in one line."""

import json
from collections.abc import Iterable, Iterator, Mapping
from difflib import get_close_matches
from typing import Any, get_args

from pydantic import BaseModel, ConfigDict, ValidationError


class Section(BaseModel):
    """What a table of a study file holds: known keys only, and never changed."""

    model_config = ConfigDict(extra="forbid", frozen=True, ser_json_inf_nan="constants")


def plain(section: BaseModel) -> dict[str, Any]:
    """What was given of a section, as JSON can hold it: infinite numbers as words."""
    return _as_json(section.model_dump(mode="json", exclude_none=True, exclude_unset=True))


def resolved(section: BaseModel) -> dict[str, Any]:
    """A section with all its values, those by default too, as JSON can hold it."""
    return _as_json(section.model_dump(mode="json", exclude_none=True))


def _as_json(values: dict[str, Any]) -> dict[str, Any]:
    tree: dict[str, Any] = json.loads(json.dumps(values), parse_constant=str)
    return tree


def suggestion(given: str, known: Iterable[str]) -> str:
    """`one of a, b, c`, and the nearest of them where one is near."""
    names = list(known)
    near = get_close_matches(given, names, n=1)
    hint = f"; did you mean {near[0]}?" if near else ""
    return f"one of {', '.join(names)}{hint}"


def complaint(error: ValidationError, kind: type[BaseModel]) -> str:
    """One thing that pydantic found wrong, as `key = value: what is allowed`, in one line."""
    # What is missing is often there by another name.
    first = min(error.errors(include_url=False), key=lambda found: found["type"] != "extra_forbidden")
    key, given, said = _dotted(first["loc"]), first["input"], str(first["msg"])
    if first["type"] == "extra_forbidden":
        known = model_at(kind, first["loc"][:-1]).model_fields
        return f"{key}: there is no such key; it must be {suggestion(str(first['loc'][-1]), known)}"
    if first["type"] == "missing":
        return f"{key} is missing; it must be given"
    said = said.removeprefix("Value error, ")
    if isinstance(given, Mapping) or first["loc"] == ():
        return f"{key}: {said}" if key else said
    said = said.replace("Input should be", "it must be")
    return f"{key} = {given!r}: {' '.join(said.split())}"


def model_at(kind: type[BaseModel], location: Iterable[str | int]) -> type[BaseModel]:
    """The section at a place within a section."""
    for step in location:
        if isinstance(step, str) and step in kind.model_fields:
            kind = next(_models(kind.model_fields[step].annotation), kind)
    return kind


def _models(annotation: Any) -> Iterator[type[BaseModel]]:
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        yield annotation
    for part in get_args(annotation):
        yield from _models(part)


def _dotted(location: Iterable[str | int]) -> str:
    key = ""
    for step in location:
        key += f"[{step}]" if isinstance(step, int) else f".{step}" if key else str(step)
    return key
