"""Sections of a study file: checked when made, and complaints about them in one line."""

import json
from collections.abc import Iterable, Iterator, Mapping
from difflib import get_close_matches
from typing import Annotated, Any, get_args

from pydantic import BaseModel, ConfigDict, Field, ValidationError
from pydantic_core import ErrorDetails

Name = Annotated[str, Field(pattern=r"^[a-z0-9][a-z0-9-]*$", description="lower-case letters, digits and hyphens")]
"""Of a folder or file."""


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


KINDS = {
    "bool": "true or false",
    "int": "a whole number",
    "float": "a number",
    "finite": "a finite number",
    "string": "text",
    "str": "text",
    "tuple": "a list",
    "list": "a list",
    "dict": "a table",
    "model": "a table",
    "mapping": "a table",
}
"""What a study file calls the kinds of values that pydantic's errors name."""


def complaint(error: ValidationError, kind: type[BaseModel]) -> str:
    """One thing that pydantic found wrong, as `key = value: what is allowed`, in one line."""
    errors = error.errors(include_url=False)
    # What is missing is often there by another name.
    first = min(errors, key=lambda found: found["type"] != "extra_forbidden")
    place, said = first["loc"], _allowed(first)
    # Where a value may be of several kinds there is an error for each, at a place that ends with its name.
    kinds = [str(found["loc"][-1]) for found in errors if found["loc"] and found["loc"][:-1] == place[:-1]]
    if len(kinds) > 1 and all(name in KINDS for name in kinds):
        place, said = place[:-1], f"it must be {' or '.join(dict.fromkeys(KINDS[name] for name in kinds))}"
    steps, section = _followed(kind, place)
    key, given = _dotted(steps), first["input"]
    if first["type"] == "string_pattern_mismatch":
        said = f"it must be {section.model_fields[str(steps[-1])].description}"
    if first["type"] == "extra_forbidden":
        return f"{key}: there is no such key; it must be {suggestion(str(steps[-1]), section.model_fields)}"
    if first["type"] == "missing":
        return f"{key} is missing; it must be given"
    if first["type"] == "union_tag_not_found":
        return f"{key}.kind is missing; it must be given"
    if first["type"] == "union_tag_invalid":
        tag, tags = first["ctx"]["tag"], first["ctx"]["expected_tags"].replace("'", "").split(", ")
        return f"{key}.kind = {tag!r}: it must be {suggestion(tag, tags)}"
    if isinstance(given, Mapping) or place == ():
        return f"{key}: {said}" if key else said
    return f"{key} = {given!r}: {said}"


def _allowed(error: ErrorDetails) -> str:
    """What may stand where pydantic found something else, in the words of a study file."""
    what, _, how = error["type"].partition("_")
    context = error.get("ctx", {})
    if what in KINDS and how in ("type", "parsing", "parsing_size", "from_float", "number"):
        return f"it must be {KINDS[what]}"
    if error["type"] == "too_short":
        return f"it has {context['actual_length']} values; it must have at least {context['min_length']}"
    said = " ".join(str(error["msg"]).removeprefix("Value error, ").split())
    return said.replace("Input should be", "it must be")


def model_at(kind: type[BaseModel], location: Iterable[str | int]) -> type[BaseModel]:
    """The section at a place within a section."""
    return _followed(kind, location)[1]


def _followed(kind: type[BaseModel], location: Iterable[str | int]) -> tuple[list[str | int], type[BaseModel]]:
    """The steps of a place within a section that a study file has, and the section there.

    Where a section may be of several kinds, a place has a step with the name of the kind, which a study file has not.
    """
    steps: list[str | int] = []
    choices = [kind]
    for step in location:
        of_kind = [choice for choice in choices if len(choices) > 1 and step in _kinds(choice)]
        if of_kind:
            choices = of_kind
            continue
        steps.append(step)
        if isinstance(step, str) and step in choices[0].model_fields:
            choices = list(_models(choices[0].model_fields[step].annotation)) or choices[:1]
    return steps, choices[0]


def _kinds(section: type[BaseModel]) -> tuple[Any, ...]:
    """Names of the kinds that a section may be."""
    field = section.model_fields.get("kind")
    return () if field is None else get_args(field.annotation)


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
