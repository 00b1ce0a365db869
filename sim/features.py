"""What shapes a seabed: boxes, wedges, slopes, steps and furrows, whose heights add up."""

from dataclasses import dataclass
from functools import cached_property
from typing import Protocol

import numpy as np

from sim import checks
from sim.band import Real

EVERYWHERE = (-np.inf, np.inf)
"""Along-track extent of what has no end there."""

FURROW_SEGMENTS = 16
"""Straight pieces across a trawl mark: they are off its raised cosine by 1 % of its depth at the most."""

Outline = tuple[Real, Real]
"""Ground range [m], not falling, and height [m] of corners; a wall has two corners at one ground range. It is straight
between corners, and level beyond the first and the last."""

FLAT: Outline = (np.zeros(1), np.zeros(1))
"""The outline of nothing."""


class Feature(Protocol):
    """A height over ground range, at every place along track."""

    @property
    def uniform(self) -> bool:
        """Whether it is the same all along the track."""

    @property
    def ends(self) -> tuple[float, float] | None:
        """Ground ranges that must lie within the scene [m]; None for what may reach beyond it."""

    @property
    def heights(self) -> tuple[float, float]:
        """Heights between which it stays, 0 among them [m]."""

    def outline(self, along_track: float, ground_range: tuple[float, float]) -> Outline:
        """Its outline at a place along track [m], over at least these ground ranges [m]."""


@dataclass(frozen=True)
class _Solid:
    start: float
    width: float
    height: float
    along_track: tuple[float, float] = EVERYWHERE

    def __post_init__(self) -> None:
        checks.positive("start", self.start, "m")
        checks.positive("width", self.width, "m")
        checks.positive("height", self.height, "m")
        first, last = checks.ends("along_track", self.along_track, "m")
        if not first < last:
            raise ValueError(f"along_track is ({first:g}, {last:g}) m; it must begin before it ends")

    @property
    def uniform(self) -> bool:
        """Whether it has no end along track."""
        return tuple(self.along_track) == EVERYWHERE

    @property
    def ends(self) -> tuple[float, float]:
        """Its near and far end [m]."""
        return self.start, self.start + self.width

    @property
    def heights(self) -> tuple[float, float]:
        """Floor and top [m]."""
        return 0.0, self.height

    def _is_at(self, along_track: float) -> bool:
        return self.along_track[0] <= along_track < self.along_track[1]


@dataclass(frozen=True)
class Box(_Solid):
    """A rectangular box with vertical walls.

    Parameters
    ----------
    start
        Ground range of its near wall [m].
    width
        Extent in ground range [m].
    height
        Height of its top above what it stands on [m].
    along_track
        Where it begins and ends along track [m]; without end by default.
    """

    def outline(self, along_track: float, ground_range: tuple[float, float]) -> Outline:
        """Foot, edge, edge and foot."""
        if not self._is_at(along_track):
            return FLAT
        return np.repeat(self.ends, 2), np.array([0.0, self.height, self.height, 0.0])


@dataclass(frozen=True)
class Wedge(_Solid):
    """A triangular box: two equal slopes that meet at its crest.

    Parameters
    ----------
    start, width, height, along_track
        As of a `Box` [m], from foot to foot and up to its crest.
    """

    def outline(self, along_track: float, ground_range: tuple[float, float]) -> Outline:
        """Foot, crest and foot."""
        if not self._is_at(along_track):
            return FLAT
        return self.start + self.width * np.array([0.0, 0.5, 1.0]), np.array([0.0, self.height, 0.0])


class _Rise:
    """What lifts the floor by some height, all along the track."""

    rise: float

    @property
    def uniform(self) -> bool:
        """It is."""
        return True

    @property
    def heights(self) -> tuple[float, float]:
        """The lower and the higher side [m]."""
        return min(self.rise, 0.0), max(self.rise, 0.0)


@dataclass(frozen=True)
class Slope(_Rise):
    """A ramp: level up to its start, level again beyond its end.

    Parameters
    ----------
    start
        Ground range at which it starts [m].
    width
        Extent in ground range [m].
    rise
        How much higher its end lies than its start [m]; below 0 where it falls.

    Raises
    ------
    ValueError
        For a value outside these limits, or not finite.
    """

    start: float
    width: float
    rise: float

    def __post_init__(self) -> None:
        checks.positive("start", self.start, "m")
        checks.positive("width", self.width, "m")
        checks.finite("rise", self.rise, "m")

    @property
    def ends(self) -> tuple[float, float]:
        """Where it starts and ends [m]."""
        return self.start, self.start + self.width

    def outline(self, along_track: float, ground_range: tuple[float, float]) -> Outline:
        """Start and end."""
        return np.array(self.ends), np.array([0.0, self.rise])


@dataclass(frozen=True)
class Step(_Rise):
    """A vertical step, level before and behind.

    Parameters
    ----------
    ground_range
        Where it stands [m].
    rise
        How much higher the far side lies [m]; below 0 where it falls.

    Raises
    ------
    ValueError
        For a place at or before 0 m, and numbers that are not finite.
    """

    ground_range: float
    rise: float

    def __post_init__(self) -> None:
        checks.positive("ground_range", self.ground_range, "m")
        checks.finite("rise", self.rise, "m")

    @property
    def ends(self) -> tuple[float, float]:
        """Where it stands [m]."""
        return self.ground_range, self.ground_range

    def outline(self, along_track: float, ground_range: tuple[float, float]) -> Outline:
        """Foot and edge."""
        return np.repeat(self.ground_range, 2), np.array([0.0, self.rise])


@dataclass(frozen=True)
class TrawlMark:
    """A straight furrow without end: `-(d / 2) (1 + cos(2 pi u / w))` at a distance `u` of up to `w / 2` from its axis.

    Parameters
    ----------
    ground_range
        Where its axis crosses along-track place 0 [m].
    direction
        Angle from the track to its axis [degrees], -90 to 90: 0 runs along the track, above 0 the ground range grows
        along it.
    depth
        `d` [m].
    width
        `w` [m].

    Raises
    ------
    ValueError
        For a value outside these limits.
    """

    ground_range: float
    direction: float = 0.0
    depth: float = 0.15
    width: float = 2.0

    def __post_init__(self) -> None:
        checks.finite("ground_range", self.ground_range, "m")
        checks.within("direction", self.direction, -90.0, 90.0, "degrees")
        checks.positive("depth", self.depth, "m")
        checks.positive("width", self.width, "m")

    @property
    def uniform(self) -> bool:
        """Whether it runs along the track."""
        return self.direction == 0

    @property
    def ends(self) -> None:
        """It may leave the scene."""
        return

    @property
    def heights(self) -> tuple[float, float]:
        """Its axis and the floor [m]."""
        return -self.depth, 0.0

    def outline(self, along_track: float, ground_range: tuple[float, float]) -> Outline:
        """Its section at a place along track: `u = (y - y0) cos(direction) - x sin(direction)`."""
        across, along = self._axis
        if abs(self.direction) == 90:
            inside = np.clip(along_track * along / self.width, -0.5, 0.5)
            return np.zeros(1), self._section(np.array([inside]))
        share, heights = self._corners
        return self.ground_range + (share * self.width + along_track * along) / across, heights

    @cached_property
    def _axis(self) -> tuple[float, float]:
        return float(np.cos(np.radians(self.direction))), float(np.sin(np.radians(self.direction)))

    @cached_property
    def _corners(self) -> tuple[Real, Real]:
        """Places across, in widths from the axis, and heights there."""
        share = np.linspace(-0.5, 0.5, FURROW_SEGMENTS + 1)
        return share, self._section(share)

    def _section(self, share: Real) -> Real:
        section: Real = -self.depth * np.cos(np.pi * share) ** 2
        return section
