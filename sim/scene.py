"""What the sonar looks at: a floor at height 0, what shapes it, and what it is made of."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import get_args

import numpy as np
from numpy.typing import NDArray

from sim import checks
from sim.band import Real
from sim.catalogue import find
from sim.compiled import compiled
from sim.features import EVERYWHERE, Box, Feature, Wedge
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
        for name in ("ground_range", "along_track"):
            first, last = checks.ends(name, getattr(self, name), "m")
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
        For ends out of order, boxes, slopes or steps that reach beyond the floor, patches beside it, an unknown
        sediment or model, and for patches in a scene without sediment.
    """

    ground_range: tuple[float, float]
    features: Sequence[Feature] = ()
    sediment: Sediment | str | None = None
    scattering: Model = "small-slope"
    patches: Sequence[SedimentPatch] = ()
    targets: Sequence[PointTarget] = ()
    speckle_shape: float = np.inf

    def __post_init__(self) -> None:
        near, far = (
            checks.positive("ground_range", end, "m") for end in checks.ends("ground_range", self.ground_range, "m")
        )
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
        for patch in self.patches:
            first, last = patch.ground_range
            if last <= near or first >= far:
                raise ValueError(
                    f"a patch from {first:g} to {last:g} m leaves the scene; it must lie between {near:g} and {far:g} m"
                )
        if not checks.number("speckle_shape", self.speckle_shape) > 0:
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
        places = np.concatenate([np.array([near, far], dtype=np.float64), *(corners for corners, _ in outlines)])
        of_outline = np.repeat(np.arange(len(outlines) + 1), [2, *(len(corners) for corners, _ in outlines)])
        ground_range = _corners(places, of_outline, float(near), float(far))
        height = np.zeros(len(ground_range))
        for corners, heights in outlines:
            _raise(height, ground_range, corners, heights)
        return Profile(ground_range, height, along_track)


@compiled
def _corners(places: Real, of_outline: NDArray[np.int64], near: float, far: float) -> Real:
    """All places within the ends in their order, once, and twice where an outline has a wall."""
    order = np.argsort(places, kind="mergesort")
    corners, count, last = np.empty(2 * len(places)), 0, -np.inf
    walled = False
    for number in range(len(order)):
        corner = order[number]
        place = places[corner]
        within = min(max(place, near), far)
        if within != last:
            corners[count], last, walled = within, within, False
            count += 1
        wall = corner > 0 and of_outline[corner] == of_outline[corner - 1] and places[corner - 1] == place
        if wall and not walled and near <= place <= far:
            corners[count], walled = within, True
            count += 1
    return corners[:count]


@compiled
def _raise(height: Real, ground_range: Real, corners: Real, heights: Real) -> None:
    """Add the height of an outline at places in their order, on the near side of its walls first, then on the far."""
    for place in range(len(ground_range)):
        far_side = place > 0 and ground_range[place] == ground_range[place - 1]
        # On the far side of a wall its corners lie before, on the near side after.
        after = (
            np.searchsorted(corners, ground_range[place], "right")
            if far_side
            else np.searchsorted(corners, ground_range[place], "left")
        )
        before, after = max(after - 1, 0), min(after, len(corners) - 1)
        length = corners[after] - corners[before]
        share = (ground_range[place] - corners[before]) / length if length > 0 else 0.0
        height[place] += heights[before] + share * (heights[after] - heights[before])
