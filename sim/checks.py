"""One-line complaints about values that cannot be."""

import math
from collections.abc import Iterable
from typing import Any

import numpy as np


def finite(name: str, value: float, unit: str = "") -> float:
    """Return `value` as a float; ValueError unless it is a finite real number."""
    given = number(name, value, unit)
    if not math.isfinite(given):
        raise ValueError(f"{name} is {given:g}; it must be finite")
    return given


def number(name: str, value: float, unit: str = "") -> float:
    """Return `value` as a float, which may be infinite; ValueError unless it is a real number."""
    try:
        return float(value)
    except (TypeError, ValueError):
        raise ValueError(f"{name} is {value!r}; it must be a number{_in(unit)}") from None


def ends(name: str, value: Iterable[float], unit: str = "") -> tuple[float, float]:
    """Return `value` as two floats, which may be infinite; ValueError unless it is two real numbers."""
    try:
        first, last = (float(end) for end in value)
    except (TypeError, ValueError):
        raise ValueError(f"{name} is {value!r}; it must be two numbers{_in(unit)}") from None
    return first, last


def positive(name: str, value: float, unit: str = "") -> float:
    """Return `value` as a float; ValueError unless it is finite and above zero."""
    given = finite(name, value, unit)
    if given <= 0:
        raise ValueError(f"{name} is {given:g}{_of(unit)}; it must be above 0{_of(unit)}")
    return given


def within(name: str, value: float, low: float, high: float, unit: str = "") -> float:
    """Return `value` as a float; ValueError unless low <= value <= high."""
    given = finite(name, value, unit)
    if not low <= given <= high:
        raise ValueError(f"{name} is {given:g}{_of(unit)}; it must lie between {low:g} and {high:g}{_of(unit)}")
    return given


def flag(name: str, value: bool) -> None:
    """ValueError unless it is true or false: text is true too, whatever it says."""
    if not isinstance(value, bool | np.bool_):
        raise ValueError(f"{name} is {value!r}; it must be true or false")


def count(name: str, value: int, least: int = 1) -> int:
    """Return `value` as an int; ValueError unless it is a whole number of at least `least`."""
    try:
        whole = not isinstance(value, bool) and int(value) == value
    except (TypeError, ValueError, OverflowError):
        whole = False
    if not whole or value < least:
        raise ValueError(f"{name} is {value!r}; it must be a whole number of at least {least}")
    return int(value)


def one_of(name: str, value: object, allowed: Iterable[str]) -> None:
    """ValueError unless `value` is one of the allowed words."""
    words = tuple(allowed)
    if value not in words:
        raise ValueError(f"{name} is {value!r}; it must be {' or '.join(words)}")


def generator(rng: object) -> np.random.Generator:
    """Return `rng`; TypeError unless it is a numpy.random.Generator."""
    if not isinstance(rng, np.random.Generator):
        raise TypeError(f"rng is {rng!r}; it must be a numpy.random.Generator, as from numpy.random.default_rng(seed)")
    return rng


def finite_samples(name: str, array: np.ndarray[Any, Any]) -> None:
    """ValueError unless every sample is finite; it says how many are not, and where the first stands."""
    bad = ~np.isfinite(array)
    if bad.any():
        first = tuple(int(i) for i in np.argwhere(bad)[0])
        raise ValueError(
            f"{name} has {int(bad.sum())} samples that are not finite, the first at {first}; all must be finite"
        )


def _in(unit: str) -> str:
    return f" in {unit}" if unit else ""


def _of(unit: str) -> str:
    return f" {unit}" if unit else ""
