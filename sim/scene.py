"""What the sonar looks at: a flat floor with things on it, in the plane of ground range and height."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Protocol, get_args

import numpy as np

from sim import checks
from sim.band import Real
from sim.catalogue import find
from sim.scattering import Model
from sim.sediment import Sediment


class Feature(Protocol):
    """Something that stands on the floor."""

    @property
    def start(self) -> float:
        """Ground range at which it begins [m]."""

    @property
    def width(self) -> float:
        """How far it reaches in ground range [m]."""

    @property
    def outline(self) -> tuple[tuple[float, float], ...]:
        """Corners (ground range, height) [m] from its near to its far foot."""


@dataclass(frozen=True)
class Box:
    """A rectangular box with vertical walls.

    Parameters
    ----------
    start
        Ground range of its near wall [m].
    width
        Extent in ground range [m].
    height
        Height of its top above the floor [m].
    """

    start: float
    width: float
    height: float

    def __post_init__(self) -> None:
        _check_feature(self.start, self.width, self.height)

    @property
    def outline(self) -> tuple[tuple[float, float], ...]:
        """Corners (ground range, height) [m]."""
        end = self.start + self.width
        return (self.start, 0.0), (self.start, self.height), (end, self.height), (end, 0.0)


@dataclass(frozen=True)
class Wedge:
    """A triangular box: two equal slopes that meet at its crest.

    Parameters
    ----------
    start
        Ground range of its near foot [m].
    width
        Extent in ground range [m].
    height
        Height of its crest above the floor [m].
    """

    start: float
    width: float
    height: float

    def __post_init__(self) -> None:
        _check_feature(self.start, self.width, self.height)

    @property
    def outline(self) -> tuple[tuple[float, float], ...]:
        """Corners (ground range, height) [m]."""
        return (self.start, 0.0), (self.start + self.width / 2, self.height), (self.start + self.width, 0.0)


def _check_feature(start: float, width: float, height: float) -> None:
    checks.positive("start", start, "m")
    checks.positive("width", width, "m")
    checks.positive("height", height, "m")


@dataclass(frozen=True)
class Scene:
    """A seabed seen from ground range 0: a floor at height 0, and features that stand side by side on it.

    Parameters
    ----------
    ground_range
        Near and far end of the floor [m].
    features
        What stands on it, in any order.
    sediment
        What floor and features are made of, a sediment or the name of one in `SEDIMENTS`: levels then follow from the
        sonar equation. None for a seabed without absolute level, that scatters alike at every angle.
    scattering
        The scattering model of the sediment; by default the one that paper B used.

    Raises
    ------
    ValueError
        For ends out of order, features that overlap or reach beyond the floor, and an unknown sediment or model.
    """

    ground_range: tuple[float, float]
    features: Sequence[Feature] = ()
    sediment: Sediment | str | None = None
    scattering: Model = "small-slope"

    def __post_init__(self) -> None:
        near, far = (checks.positive("ground_range", end, "m") for end in self.ground_range)
        if near >= far:
            raise ValueError(f"ground_range is ({near:g}, {far:g}) m; its near end must come before its far end")
        ordered = tuple(sorted(self.features, key=lambda feature: feature.start))
        object.__setattr__(self, "features", ordered)
        for feature in ordered:
            if feature.start <= near or feature.start + feature.width >= far:
                raise ValueError(f"{feature} leaves the scene; it must stand between {near:g} and {far:g} m")
        for left, right in pairwise(ordered):
            if left.start + left.width > right.start:
                raise ValueError(f"{left} and {right} overlap; features must stand side by side")
        checks.one_of("scattering", self.scattering, get_args(Model))
        if self.sediment is not None:
            object.__setattr__(self, "sediment", find(self.sediment))

    @property
    def profile(self) -> Real:
        """Corners of the seabed (ground range, height) [m] in the order of the outline, shape (corner, 2)."""
        near, far = self.ground_range
        corners = [corner for feature in self.features for corner in feature.outline]
        return np.array([(near, 0.0), *corners, (far, 0.0)])

    @property
    def highest(self) -> float:
        """Height of the highest corner [m]."""
        return float(self.profile[:, 1].max())
