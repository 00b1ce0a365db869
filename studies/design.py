"""The design of a study: its points, and the blocks of trials at each."""

import hashlib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from itertools import product
from typing import Any

from pydantic import ValidationError

from sim import Sonar
from studies.method import Method, methods_of
from studies.patch import Patch
from studies.section import complaint, plain
from studies.seeds import canonical
from studies.sonar_section import SonarSection
from studies.study import Study
from studies.swath import Swath


@dataclass(frozen=True, eq=False)
class Point:
    """One design point.

    Attributes
    ----------
    number
        Its place in the design, from 0.
    varied
        What tells it from the others of the study, by key.
    sonar, world
        What is simulated.
    echoes
        All that decides its echoes, as plain values: the seed of its random numbers, and its identity.
    """

    number: int
    varied: Mapping[str, Any]
    sonar: Sonar
    world: Patch | Swath
    echoes: Mapping[str, Any]

    @cached_property
    def key(self) -> str:
        """Name of the point in file names, the same for the same echoes."""
        return hashlib.sha256(canonical(self.echoes)).hexdigest()[:16]

    @cached_property
    def columns(self) -> dict[str, Any]:
        """What varies, by the last part of its key where that is enough to tell it."""
        short = [key.rpartition(".")[2] for key in self.varied]
        names = [name if short.count(name) == 1 else key for name, key in zip(short, self.varied, strict=True)]
        return dict(zip(names, self.varied.values(), strict=True))


@dataclass(frozen=True, eq=False)
class Task:
    """One block of trials of one design point."""

    point: Point
    block: int
    trials: int


def points(study: Study) -> Iterator[Point]:
    """The design points of a study: all combinations of its axes, then the further ones; those that differ.

    Raises
    ------
    ValueError
        For a point whose values cannot be; names the key, the value and what is allowed.
    """
    seen: set[str] = set()
    number = 0
    for varied in _varied(study):
        point = _point(study, number, varied)
        if point.key not in seen:
            seen.add(point.key)
            number += 1
            yield point


def _varied(study: Study) -> Iterator[dict[str, Any]]:
    groups = [
        [dict(zip(axis, values, strict=True)) for values in zip(*axis.values(), strict=True)] for axis in study.axes
    ]
    if groups or not study.points:
        for chosen in product(*groups):
            yield {key: value for group in chosen for key, value in group.items()}
    yield from (dict(point) for point in study.points)


def _point(study: Study, number: int, varied: Mapping[str, Any]) -> Point:
    name, kind = ("patch", Patch) if study.patch is not None else ("scene", Swath)
    tree = {
        "sonar": study.sonar.model_dump(exclude_none=True, exclude_unset=True),
        name: getattr(study, name).model_dump(exclude_none=True, exclude_unset=True),
    }
    for key, value in varied.items():
        section, _, field = key.partition(".")
        tree[section][field] = value
    # One of two ways to say the same replaces the other.
    if "patch.snr" in varied:
        tree[name].pop("coherence", None)
    if "patch.coherence" in varied:
        tree[name].pop("snr", None)
    section = "sonar"
    try:
        sonar_section = SonarSection.model_validate(tree["sonar"])
        sonar = sonar_section.sonar()
        section = name
        world = kind.model_validate(tree[name])
        world.check(sonar)
    except ValidationError as error:
        model = SonarSection if section == "sonar" else kind
        raise ValueError(f"{study.name}: {section}.{complaint(error, model)}") from None
    except ValueError as error:
        raise ValueError(f"{study.name}: {section}: {error}") from None
    sections = {"sonar": sonar_section, name: world}
    echoes = {part: plain(model) for part, model in sections.items()}
    values = {key: getattr(sections[key.partition(".")[0]], key.partition(".")[2]) for key in varied}
    return Point(number, values, sonar, world, echoes)


def blocks(study: Study) -> int:
    """Blocks of a design point, at the most."""
    return -(-study.trials.count // study.trials.block)


def task(study: Study, point: Point, block: int) -> Task:
    """A block of a design point; the last one may be short."""
    return Task(point, block, min(study.trials.block, study.trials.count - block * study.trials.block))


def methods(study: Study, point: Point) -> list[Method]:
    """Every estimator with each of its windows at a point.

    Raises
    ------
    ValueError
        For a window that the echoes cannot hold.
    """
    found = methods_of(study.estimators, point.world)
    rows, samples = point.world.shape(point.sonar, min(study.trials.block, study.trials.count))
    for method in found:
        for name, size, most in (("rows", method.window.rows, rows), ("samples", method.window.samples, samples)):
            if size > most:
                raise ValueError(
                    f"{study.name}: a window of {method.section.name} has {size} {name}; "
                    f"a block of the echoes has {most}, and it must not have more"
                )
    return found
