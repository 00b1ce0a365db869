"""The design of a study: its points, and the blocks of trials at each."""

import hashlib
from collections.abc import Iterator, Mapping
from dataclasses import asdict, dataclass
from functools import cached_property
from itertools import product
from typing import Any, NamedTuple

from pydantic import ValidationError

from estimators import FixedWindow
from sim import Sonar
from studies.experiment import Experiment
from studies.levels import Levels
from studies.method import Method, methods_of
from studies.patch import Patch
from studies.plans import Plans
from studies.section import Section, complaint, resolved
from studies.seeds import canonical
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
        """What varies, by column of the table."""
        return columns_of(self.varied)


@dataclass(frozen=True, eq=False)
class Task:
    """One block of trials of one design point."""

    point: Point
    block: int
    trials: int


def points(study: Study) -> Iterator[Point]:
    """The design points of a study that simulates: all combinations of its axes, then the further ones, each once.

    Raises
    ------
    ValueError
        For a point whose values cannot be; names the key, the value and what is allowed.
    """
    for number, found in enumerate(_resolved(study)):
        world = found.section
        assert isinstance(world, Patch | Swath)
        try:
            world.check(found.sonar)
        except ValueError as error:
            raise ValueError(f"{study.name}: {study.kind}: {error}") from None
        yield Point(number, found.varied, found.sonar, world, found.plain)


def computed(study: Study) -> Iterator[tuple[Mapping[str, Any], Levels | Plans | Experiment, Sonar]]:
    """Of a study without trials, what varies at each design point, by column, and what makes a table for a sonar."""
    for found in _resolved(study):
        assert isinstance(found.section, Levels | Plans | Experiment)
        yield columns_of(found.varied), found.section, found.sonar


def columns_of(varied: Mapping[str, Any]) -> dict[str, Any]:
    """What varies, by the last part of its key where that is enough to tell it."""
    short = [key.rpartition(".")[2] for key in varied]
    names = [name if short.count(name) == 1 else key for name, key in zip(short, varied, strict=True)]
    return dict(zip(names, varied.values(), strict=True))


class _Resolved(NamedTuple):
    varied: Mapping[str, Any]
    sonar: Sonar
    section: Section
    plain: Mapping[str, Any]


def _resolved(study: Study) -> Iterator[_Resolved]:
    """Sonar and section of every design point, in order and without repeats."""
    seen: set[bytes] = set()
    for varied in _varied(study):
        found = _with_values(study, varied)
        identity = canonical(found.plain)
        if identity not in seen:
            seen.add(identity)
            yield found


def _varied(study: Study) -> Iterator[dict[str, Any]]:
    groups = [
        [dict(zip(axis, values, strict=True)) for values in zip(*axis.values(), strict=True)] for axis in study.axes
    ]
    if groups or not study.points:
        for chosen in product(*groups):
            yield {key: value for group in chosen for key, value in group.items()}
    yield from (dict(point) for point in study.points)


def _with_values(study: Study, varied: Mapping[str, Any]) -> _Resolved:
    """The sections of a study with some values replaced; ValueError in one line where they cannot be."""
    sections = {"sonar": study.sonar, study.kind: getattr(study, study.kind)}
    trees = {name: given.model_dump(exclude_none=True, exclude_unset=True) for name, given in sections.items()}
    for key, value in varied.items():
        name, _, field = key.partition(".")
        trees[name][field] = value
    # One of two ways to say the same replaces the other.
    for key, other in (("patch.snr", "coherence"), ("patch.coherence", "snr")):
        if key in varied and f"patch.{other}" not in varied:
            trees["patch"].pop(other, None)
    found: dict[str, Any] = {}
    name = ""
    try:
        for name, tree in trees.items():
            found[name] = type(sections[name]).model_validate(tree)
        name = "sonar"
        sonar = found[name].sonar()
    except ValidationError as error:
        raise ValueError(f"{study.name}: {name}.{complaint(error, type(sections[name]))}") from None
    except ValueError as error:
        raise ValueError(f"{study.name}: {name}: {error}") from None
    values = {key: getattr(found[key.partition(".")[0]], key.partition(".")[2]) for key in varied}
    echoes = {"sonar": numbers_of(sonar), study.kind: resolved(found[study.kind])}
    return _Resolved(values, sonar, found[study.kind], echoes)


def numbers_of(sonar: Sonar) -> dict[str, Any]:
    """All that decides what a sonar hears, however it was given."""
    described = asdict(sonar)
    del described["assumed"]
    return described


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
        if not isinstance(method.window, FixedWindow):
            if study.kind != "scene":
                raise ValueError(
                    f"{study.name}: a window of {method.section.name} is a policy, which needs ranges; "
                    f"in a {study.kind} it must be 'record' or [rows, samples]"
                )
            continue
        for name, size, most in (("rows", method.window.rows, rows), ("samples", method.window.samples, samples)):
            if size > most:
                raise ValueError(
                    f"{study.name}: a window of {method.section.name} has {size} {name}; "
                    f"a block of the echoes has {most}, and it must not have more"
                )
    return found
