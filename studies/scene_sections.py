"""What stands in a scene and how it is modelled, as a study file says it."""

import hashlib
from functools import lru_cache
from pathlib import Path
from typing import Annotated, Any, ClassVar, Literal, Self

from pydantic import Field, SerializationInfo, SerializerFunctionWrapHandler, model_serializer, model_validator

from sim import Box, Feature, HeightMap, PointTarget, Roughness, SedimentPatch, Slope, Step, TrawlMark, Wedge
from sim.features import EVERYWHERE
from sim.levels import Level
from sim.plan import Delays
from studies.quantity import Decibels, Degrees, Metres
from studies.section import Section

Stretch = tuple[Metres, Metres]


class _Of(Section):
    """A table whose keys are the parameters of something that the simulator knows, which checks them."""

    makes: ClassVar[type[Any]]

    @model_validator(mode="after")
    def _can_be(self) -> Self:
        self.made()
        return self

    def made(self) -> Any:
        """As the simulator knows it."""
        return self.makes(**{name: getattr(self, name) for name in type(self).model_fields if name != "kind"})


class _Solid(_Of):
    start: Metres
    width: Metres
    height: Metres
    along_track: Stretch = EVERYWHERE


class BoxSection(_Solid):
    """`sim.Box`."""

    makes: ClassVar[type[Any]] = Box
    kind: Literal["box"]


class WedgeSection(_Solid):
    """`sim.Wedge`."""

    makes: ClassVar[type[Any]] = Wedge
    kind: Literal["wedge"]


class SlopeSection(_Of):
    """`sim.Slope`."""

    makes: ClassVar[type[Any]] = Slope
    kind: Literal["slope"]
    start: Metres
    width: Metres
    rise: Metres


class StepSection(_Of):
    """`sim.Step`."""

    makes: ClassVar[type[Any]] = Step
    kind: Literal["step"]
    ground_range: Metres
    rise: Metres


class TrawlMarkSection(_Of):
    """`sim.TrawlMark`."""

    makes: ClassVar[type[Any]] = TrawlMark
    kind: Literal["trawl-mark"]
    ground_range: Metres
    direction: Degrees = TrawlMark.direction
    depth: Metres = TrawlMark.depth
    width: Metres = TrawlMark.width


class RoughnessSection(_Of):
    """`sim.Roughness`."""

    makes: ClassVar[type[Any]] = Roughness
    kind: Literal["roughness"]
    rms: Metres
    seed: int
    exponent: float = Roughness.exponent
    period: Metres = Roughness.period
    spacing: Metres = Roughness.spacing


class HeightMapSection(Section):
    """`sim.HeightMap`, from a file.

    Parameters
    ----------
    file
        As of `HeightMap.read`; a relative path is that from the study file (`studies.load`).
    digest
        SHA-256 of the file, found when the study is read; where it is given, the file must have it. What the file holds
        decides the echoes, not where it lies.
    """

    kind: Literal["height-map"]
    file: str
    digest: str = ""

    @model_validator(mode="before")
    @classmethod
    def _with_digest(cls, given: Any) -> Any:
        if not (isinstance(given, dict) and isinstance(given.get("file"), str)):
            return given
        file = Path(given["file"]).absolute()
        try:
            found = hashlib.sha256(file.read_bytes()).hexdigest()
        except OSError as error:
            raise ValueError(f"file is {given['file']!r}; it must be one that can be read: {error.strerror}") from None
        if given.get("digest", found) != found:
            raise ValueError(f"file is {given['file']!r} of digest {found}; it must have {given['digest']}")
        return {**given, "file": str(file), "digest": found}

    @model_validator(mode="after")
    def _can_be(self) -> Self:
        self.made()
        return self

    @model_serializer(mode="wrap")
    def _told(self, told: SerializerFunctionWrapHandler, info: SerializationInfo) -> dict[str, Any]:
        values: dict[str, Any] = told(self)
        return values if info.exclude_unset else {name: values[name] for name in ("kind", "digest")}

    def made(self) -> Feature:
        """As the simulator knows it."""
        return _height_map(self.file, self.digest)


@lru_cache(maxsize=8)
def _height_map(file: str, digest: str) -> HeightMap:
    """The height map of a file that had a digest."""
    found = HeightMap.read(file)
    if hashlib.sha256(Path(file).read_bytes()).hexdigest() != digest:
        raise ValueError(f"{file} has changed since the study was read; it must have the digest {digest}")
    return found


FeatureSection = Annotated[
    BoxSection | WedgeSection | SlopeSection | StepSection | TrawlMarkSection | RoughnessSection | HeightMapSection,
    Field(discriminator="kind"),
]
"""Something that shapes the seabed; its `kind` says what."""


class PatchSection(_Of):
    """`sim.SedimentPatch`, its sediment by name."""

    makes: ClassVar[type[Any]] = SedimentPatch
    ground_range: Stretch
    sediment: str
    along_track: Stretch = EVERYWHERE


class TargetSection(_Of):
    """`sim.PointTarget`."""

    makes: ClassVar[type[Any]] = PointTarget
    ground_range: Metres
    height: Metres = PointTarget.height
    level: Decibels = PointTarget.level
    along_track: Metres = PointTarget.along_track


class PlanSection(Section):
    """What `sim.plan` shall not decide by itself.

    Parameters
    ----------
    tolerance
        Relative error of the spread of an estimate that may go without being modelled.
    sections, shadow, delays, baseline, level, scatterers_per_resolution, accuracy, single
        As of `sim.Plan`; what is not given is decided by what the scene requires.
    """

    tolerance: Annotated[float, Field(ge=1e-6, le=0.5)] = 0.02
    sections: Literal["one", "each"] | None = None
    shadow: bool | None = None
    delays: Delays | None = None
    baseline: bool | None = None
    level: Level | None = None
    scatterers_per_resolution: Annotated[float, Field(ge=1)] | None = None
    accuracy: Annotated[float, Field(ge=1e-14, le=1e-2)] | None = None
    single: bool | None = None

    @property
    def chosen(self) -> dict[str, Any]:
        """What is given of a plan."""
        return self.model_dump(exclude_none=True, exclude={"tolerance"})
