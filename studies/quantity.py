"""Numbers with units, as a study file may give them."""

import re
from collections.abc import Mapping
from typing import Annotated, Any

from pydantic import BeforeValidator

UNITS: Mapping[str, Mapping[str, float]] = {
    "Hz": {"Hz": 1.0, "kHz": 1e3, "MHz": 1e6},
    "m": {"m": 1.0, "mm": 1e-3, "cm": 1e-2, "km": 1e3},
    "m/s": {"m/s": 1.0},
    "s": {"s": 1.0, "ms": 1e-3, "us": 1e-6, "µs": 1e-6, "ns": 1e-9},
    "dB": {"dB": 1.0},
    "wraps": {"wraps": 1.0, "wrap": 1.0},
    "degrees": {"degrees": 1.0, "degree": 1.0, "deg": 1.0},
}
"""Units of each kind of quantity, in that which a bare number has."""

_NUMBER_AND_UNIT = re.compile(
    r"\s*([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?|[-+]?inf(?:inity)?)\s*(\S*)\s*", re.IGNORECASE
)


def number_in(value: Any, unit: str) -> float:
    """A number in `unit` from a bare number, or from text such as `"30 kHz"`.

    Raises
    ------
    ValueError
        For what is neither, and for the unit of another quantity.
    """
    allowed = ", ".join(UNITS[unit])
    if isinstance(value, bool) or not isinstance(value, int | float | str):
        raise ValueError(f"it must be a number in {unit}, or text with a unit of {allowed}")
    if not isinstance(value, str):
        return float(value)
    found = _NUMBER_AND_UNIT.fullmatch(value)
    if not found:
        raise ValueError(f"it must be a number in {unit}, or text with a unit of {allowed}")
    number, given = found.groups()
    if given and given not in UNITS[unit]:
        raise ValueError(f"its unit is {given!r}; it must be one of {allowed}")
    return float(number) * UNITS[unit].get(given, 1.0)


def _parser(unit: str) -> BeforeValidator:
    def parse(value: Any) -> float:
        return number_in(value, unit)

    return BeforeValidator(parse)


Hertz = Annotated[float, _parser("Hz")]
Metres = Annotated[float, _parser("m")]
MetresPerSecond = Annotated[float, _parser("m/s")]
Seconds = Annotated[float, _parser("s")]
Decibels = Annotated[float, _parser("dB")]
Wraps = Annotated[float, _parser("wraps")]
Degrees = Annotated[float, _parser("degrees")]
