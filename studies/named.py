"""Code that a study file names."""

from importlib import import_module
from typing import Any


def imported(name: str, key: str) -> Any:
    """What `module:object` names; ValueError with the key that named it where it cannot be imported."""
    module, separator, attribute = name.partition(":")
    if not (module and separator and attribute):
        raise ValueError(f"{key} is {name!r}; it must be module:object")
    try:
        return getattr(import_module(module), attribute)
    except (ImportError, AttributeError) as error:
        raise ValueError(f"{key} is {name!r}; it must be an object that can be imported: {error}") from None
