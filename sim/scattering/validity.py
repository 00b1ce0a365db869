"""Where a model was stated or checked to hold: beyond, it computes all the same and says so once."""

import warnings
from collections.abc import Mapping
from functools import cache

import numpy as np

from sim.band import Real
from sim.sediment import ElasticBed, FluidBed


class ValidityWarning(UserWarning):
    """A model is used beyond the range for which it was stated or checked."""


def check_validity(
    model: str,
    bed: FluidBed | ElasticBed,
    frequency: Real,
    frequencies: tuple[float, float],
    limits: Mapping[str, tuple[float, float]],
) -> None:
    """Warn once, for each model and quantity in a process, where a frequency or a parameter is beyond its range."""
    if frequency.size and (frequency.min() < frequencies[0] or frequency.max() > frequencies[1]):
        low, high = np.divide(frequencies, 1e3)
        warn_once(
            f"{model} is used outside {low:g} to {high:g} kHz, the frequencies for which it was stated or checked"
        )
    for name, (low, high) in limits.items():
        if not low <= getattr(bed, name) <= high:
            warn_once(f"{model} is used with a {name} outside {low:g} to {high:g}, the range for which it was stated")


@cache
def warn_once(message: str) -> None:
    """Issue a ValidityWarning, the first time only."""
    warnings.warn(message, ValidityWarning, stacklevel=5)
