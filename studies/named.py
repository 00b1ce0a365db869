"""Code that a study file names."""

from collections.abc import Callable
from importlib import import_module
from typing import Any, TypeVar

Kind = TypeVar("Kind")


def imported(name: str, key: str) -> Any:
    """What `module:object` names; ValueError with the key that named it where it cannot be imported."""
    module, separator, attribute = name.partition(":")
    if not (module and separator and attribute):
        raise ValueError(f"{key} is {name!r}; it must be module:object")
    try:
        return getattr(import_module(module), attribute)
    except (Exception, SystemExit) as error:  # A user's module may do anything when it is imported.
        raise ValueError(f"{key} is {name!r}; it must be an object that can be imported: {words_of(error)}") from None


def called(key: str, function: Callable[..., Any], kind: type[Kind], *arguments: Any) -> Kind:
    """What a user's function gives; ValueError with the key that named it where it raises or gives something else."""
    try:
        given = function(*arguments)
    except (Exception, SystemExit) as error:
        raise ValueError(f"{key} failed: {words_of(error)}") from None
    if not isinstance(given, kind):
        raise ValueError(f"{key} gives a {type(given).__name__}; it must give a {kind.__name__}")
    return given


def words_of(error: BaseException) -> str:
    """What an exception says, in one line that can be stored."""
    try:
        said = " ".join(str(error).split())
    except Exception:
        said = "(it does not say)"
    return f"{type(error).__name__}: {said}".encode(errors="replace").decode()
