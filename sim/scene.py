"""What the sonar looks at: a floor at height 0, what shapes it, and what it is made of."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import get_args

import numpy as np
from numpy.typing import NDArray

from sim import checks
from sim.band import Real
from sim.catalogue import find
from sim.features import EVERYWHERE, Box, Feature, Outline, Wedge
from sim.profile import Profile
from sim.scattering import Model
from sim.sediment import Sediment


@dataclass(frozen=True)
class SedimentPatch:
    """A rectangle of seabed of another sediment.

    Parameters
    ----------
    ground_range
        Its near and far end [m].
    sediment
        A sediment, or the name of one in `SEDIMENTS`.
    along_track
        Where it begins and ends along track [m]; without end by default.

    Raises
    ------
    ValueError
        For an unknown sediment, and where it ends before it begins.
    """

    ground_range: tuple[float, float]
    sediment: Sediment | str
    along_track: tuple[float, float] = EVERYWHERE

    def __post_init__(self) -> None:
        object.__setattr__(self, "sediment", find(self.sediment))
        for name, (first, last) in (("ground_range", self.ground_range), ("along_track", self.along_track)):
            if not first < last:
                raise ValueError(f"{name} is ({first:g}, {last:g}) m; it must begin before it ends")

    def is_at(self, along_track: float) -> bool:
        """Whether it reaches to a place along track [m]."""
        return self.along_track[0] <= along_track < self.along_track[1]


@dataclass(frozen=True)
class PointTarget:
    """A single scatterer, the same to both receivers, that hides nothing.

    Parameters
    ----------
    ground_range, height
        Where it lies [m].
    level
        Power at its peak, over that of the flat floor (a scene without sediment) or of the noise (one with) [dB].
    along_track
        Where it lies along track [m].

    Raises
    ------
    ValueError
        For a place at or before 0 m, and numbers that are not finite.
    """

    ground_range: float
    height: float = 0.0
    level: float = 20.0
    along_track: float = 0.0

    def __post_init__(self) -> None:
        checks.positive("ground_range", self.ground_range, "m")
        for name, unit in (("height", "m"), ("level", "dB"), ("along_track", "m")):
            checks.finite(name, getattr(self, name), unit)


@dataclass(frozen=True)
class Scene:
    """A seabed seen from ground range 0: a floor at height 0, and features whose heights add up on it.

    Parameters
    ----------
    ground_range
        Near and far end of the floor [m].
    features
        What shapes it, in any order.
    sediment
        What all is made of, a sediment or the name of one in `SEDIMENTS`: levels then follow from the sonar equation.
        None for a seabed without absolute level, that scatters alike at every angle.
    scattering
        The scattering model of the sediment; by default the one that paper B used.
    patches
        Where it is of another sediment; the last that reaches to a place decides.
    targets
        Single scatterers.
    speckle_shape
        Shape of K-distributed speckle, above 0: the intensity of a single look has the second moment
        `2 (1 + 1 / shape)` of its squared mean. Infinite for fully developed speckle.

    Raises
    ------
    ValueError
        For ends out of order, boxes, slopes or steps that reach beyond the floor, an unknown sediment or model, and
        for patches in a scene without sediment.
    """

    ground_range: tuple[float, float]
    features: Sequence[Feature] = ()
    sediment: Sediment | str | None = None
    scattering: Model = "small-slope"
    patches: Sequence[SedimentPatch] = ()
    targets: Sequence[PointTarget] = ()
    speckle_shape: float = np.inf

    def __post_init__(self) -> None:
        near, far = (checks.positive("ground_range", end, "m") for end in self.ground_range)
        if near >= far:
            raise ValueError(f"ground_range is ({near:g}, {far:g}) m; its near end must come before its far end")
        for name in ("features", "patches", "targets"):
            object.__setattr__(self, name, tuple(getattr(self, name)))
        for feature in self.features:
            if feature.ends and not (near < feature.ends[0] and feature.ends[1] < far):
                raise ValueError(f"{feature} leaves the scene; it must stand between {near:g} and {far:g} m")
        for target in self.targets:
            if not near <= target.ground_range <= far:
                raise ValueError(f"{target} leaves the scene; it must lie between {near:g} and {far:g} m")
        checks.one_of("scattering", self.scattering, get_args(Model))
        if self.sediment is not None:
            object.__setattr__(self, "sediment", find(self.sediment))
        elif self.patches:
            raise ValueError("a scene without sediment has patches; it must have a sediment around them")
        if not self.speckle_shape > 0:
            raise ValueError(f"speckle_shape is {self.speckle_shape:g}; it must be above 0")

    @property
    def uniform(self) -> bool:
        """Whether relief and sediment are the same all along the track."""
        return all(f.uniform for f in self.features) and all(tuple(p.along_track) == EVERYWHERE for p in self.patches)

    @property
    def heights(self) -> tuple[float, float]:
        """Heights between which it stays [m]: its own, or bounds where it varies along track."""
        endless = [feature for feature in self.features if feature.uniform]
        short = [feature for feature in self.features if not feature.uniform and isinstance(feature, Box | Wedge)]
        varying = [feature for feature in self.features if not feature.uniform and feature not in short]
        # Solids that end along track raise the seabed where they stand, and lower it nowhere.
        raised = [*endless, *(replace(solid, along_track=EVERYWHERE) for solid in short)]
        low, high = (replace(self, features=some, patches=()).profile().height for some in (endless, raised))
        below, above = (sum(feature.heights[end] for feature in varying) for end in (0, 1))
        return float(low.min() + below), float(high.max() + above)

    def profile(self, along_track: float = 0.0) -> Profile:
        """Its section at a place along track [m]."""
        near, far = self.ground_range
        outlines = [feature.outline(along_track, self.ground_range) for feature in self.features]
        corners = [np.array([near, far], dtype=float), *(ground_range for ground_range, _ in outlines)]
        walls = [ground_range[1:][np.diff(ground_range) == 0] for ground_range, _ in outlines]
        once = np.unique(np.clip(np.concatenate(corners), near, far))
        twice = np.unique(np.concatenate([once[:0], *walls]))
        twice = twice[(twice >= near) & (twice <= far)]
        ground_range = np.sort(np.concatenate([once, twice]))
        # The first corner at a wall is its near side.
        far_side = np.append(False, np.diff(ground_range) == 0)
        height = np.zeros(len(ground_range))
        for outline in outlines:
            height += _height(outline, ground_range, far_side)
        return Profile(ground_range, height, along_track)


def _height(outline: Outline, ground_range: Real, far_side: NDArray[np.bool_]) -> Real:
    """Height of an outline, on the near or the far side of its walls."""
    corners, heights = outline
    after = np.where(
        far_side, np.searchsorted(corners, ground_range, "right"), np.searchsorted(corners, ground_range, "left")
    )
    before, after = np.maximum(after - 1, 0), np.minimum(after, len(corners) - 1)
    length = corners[after] - corners[before]
    share = np.divide(ground_range - corners[before], length, out=np.zeros_like(ground_range), where=length > 0)
    height: Real = heights[before] + share * (heights[after] - heights[before])
    return height
