"""What a study is: a question, what is simulated, the estimators that are compared, the axes, how many trials."""

import tomllib
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Annotated, Any, Self

from pydantic import Field, ValidationError, model_validator

from studies.drawing import FigureSection, SummarySection, check_columns
from studies.experiment import Experiment
from studies.levels import Levels
from studies.method import EstimatorSection
from studies.patch import Patch
from studies.plans import Plans
from studies.section import Name, Section, complaint, model_at, suggestion
from studies.sonar_section import SonarSection
from studies.swath import Swath


class Until(Section):
    """When a point has had enough trials: every target that is given must be met, by each estimator for itself.

    Parameters
    ----------
    wrap_errors
        So many wrap errors were seen; where trials have weights, as many of equal weight.
    wrap_rate_error
        The standard error of the wrap-error rate is at most this share of it.
    std_error
        The standard error of the in-wrap standard deviation is at most this share of it.
    """

    wrap_errors: Annotated[int, Field(ge=1)] | None = None
    wrap_rate_error: Annotated[float, Field(gt=0, lt=1)] | None = None
    std_error: Annotated[float, Field(gt=0, lt=1)] | None = None

    @model_validator(mode="after")
    def _asks_something(self) -> Self:
        if not self.model_dump(exclude_none=True):
            raise ValueError(f"no target is given; it must be some of {', '.join(type(self).model_fields)}")
        return self


class Trials(Section):
    """How many trials a design point has.

    Parameters
    ----------
    count
        Trials at each design point; the most, where `until` may end it sooner.
    block
        Trials in one block: what is simulated at once, stored at once, and lost at most. Best so many that a block
        takes 0.2 s or more. It decides which random numbers a trial has.
    until
        A rule that stops a point; it is asked after 1, 2, 4, 8, ... blocks, so that it does not depend on speed.
    """

    count: Annotated[int, Field(ge=1)]
    block: Annotated[int, Field(ge=1)]
    until: Until | None = None


KINDS = ("patch", "scene", "levels", "plans", "experiment")
"""Sections of which a study has one."""

Axis = Annotated[Mapping[str, Annotated[tuple[Any, ...], Field(min_length=1)]], Field(min_length=1)]


class Study(Section):
    """A question that a sweep of simulations answers.

    Parameters
    ----------
    name
        Lower-case letters, digits and hyphens; the folder of its results.
    question
        What it asks, in a sentence.
    sonar
        The sonar.
    patch, scene, levels, plans, experiment
        What is simulated trial by trial, only computed, or measured by a function of one's own: one of the five.
    estimators
        What is compared, all on the same echoes; none where there are no trials.
    axes
        What is varied. Each is a table of keys with lists of values; keys of one table vary together and their lists
        are as long as each other, and the design points are all combinations of the tables. A key is written with its
        section, such as `patch.looks`.
    points
        Further design points, one table of keys and values each.
    trials
        How many.
    answer
        `module:function` that says the answer in a sentence, from the table; from what to what the main results go
        where there is none.
    summary, figures
        What is shown of the results.
    quick
        Values that replace others for a first look, as with `--set`: `"trials.count" = 2000`, or those of an axis.
    """

    name: Name
    question: str
    sonar: SonarSection
    patch: Patch | None = None
    scene: Swath | None = None
    levels: Levels | None = None
    plans: Plans | None = None
    experiment: Experiment | None = None
    estimators: tuple[EstimatorSection, ...] = ()
    axes: tuple[Axis, ...] = ()
    points: tuple[Mapping[str, Any], ...] = ()
    trials: Trials = Trials(count=1, block=1)
    answer: str | None = None
    summary: SummarySection = SummarySection()
    figures: tuple[FigureSection, ...] = ()
    quick: Mapping[str, Any] = {}

    @model_validator(mode="after")
    def _fits_together(self) -> Self:
        self._check_what()
        for key, sections in (("estimators", self.estimators), ("figures", self.figures)):
            names = [section.name for section in sections]
            for name in names:
                if names.count(name) > 1:
                    raise ValueError(f"{key} has two of the name {name!r}; each must have its own")
        seen: set[str] = set()
        for axis in self.axes:
            lengths = {key: len(values) for key, values in axis.items()}
            if len(set(lengths.values())) > 1:
                raise ValueError(f"axes has {lengths} values; keys that vary together must have as many as each other")
            for key in axis:
                self._check_axis(key)
                if key in seen:
                    raise ValueError(f"axes has {key} twice; it must be in one table")
                seen.add(key)
        for point in self.points:
            for key in point:
                self._check_axis(key)
        return self

    @property
    def kind(self) -> str:
        """Name of the section that says what is simulated or computed."""
        return next(name for name in KINDS if getattr(self, name) is not None)

    @property
    def simulates(self) -> bool:
        """Whether it has trials, in blocks that are stored."""
        return self.kind in ("patch", "scene")

    def _check_what(self) -> None:
        """ValueError unless one thing is simulated or computed, with what that needs."""
        given = [name for name in KINDS if getattr(self, name) is not None]
        if len(given) != 1:
            raise ValueError(f"{' and '.join(given) or 'none'} of {', '.join(KINDS)} is given; it must be one of them")
        for name in ("estimators", "trials"):
            if self.simulates and not (name in self.model_fields_set and getattr(self, name)):
                raise ValueError(f"{name} is missing; it must be given")
            if not self.simulates and name in self.model_fields_set:
                raise ValueError(f"{name} is given beside {given[0]}; it must not be, as there are no trials")

    def check_columns(self, known: Sequence[str]) -> None:
        """ValueError for a column of the summary or a figure that the table does not have."""
        check_columns("summary", [*self.summary.columns, *self.summary.where], known)
        for section in self.figures:
            if section.draw is None:
                check_columns(f"figure {section.name}", section.used, known)

    def _check_axis(self, key: str) -> None:
        """ValueError unless a key names something that decides the echoes."""
        section, _, rest = key.partition(".")
        there = ["sonar", self.kind]
        names = [f"{name}.{field}" for name in there for field in model_at(Study, [name]).model_fields]
        if section not in there or key not in names or not rest:
            raise ValueError(f"axes has {key!r}; it must be {suggestion(key, names)}")

    def with_values(self, values: Mapping[str, Any]) -> "Study":
        """The same study with other values; a key that is an axis gets other values along it.

        Raises
        ------
        ValueError
            For a key that does not exist, and a value that cannot be; names both.
        """
        tree = self.model_dump(exclude_unset=True)
        for key, value in values.items():
            self._put(tree, key, value)
        return made(tree, self.name)

    def _put(self, tree: dict[str, Any], key: str, value: Any) -> None:
        for axis in tree.get("axes", ()):
            if key in axis:
                axis[key] = value if isinstance(value, list | tuple) else [value]
                return
        *path, last = key.split(".")
        known = model_at(Study, path).model_fields
        absent = bool(path) and (path[0] not in Study.model_fields or getattr(self, path[0]) is None)
        if absent or last not in known:
            whole = ".".join([*([] if absent else path), "{}"])
            names = [whole.format(name) for name in (Study.model_fields if absent else known)]
            raise ValueError(f"there is no {key!r} in {self.name}; it must be {suggestion(key, names)}")
        for step in path:
            tree = tree.setdefault(step, {})
        tree[last] = value

    def for_a_first_look(self) -> "Study":
        """The study with its `quick` values."""
        return self.with_values(self.quick)

    def of_estimators(self, names: Sequence[str]) -> "Study":
        """The study with only these of its estimators, all where none is named; ValueError for an unknown name."""
        known = [section.name for section in self.estimators]
        for name in names:
            if name not in known:
                raise ValueError(f"estimator is {name!r}; of {self.name} it must be {suggestion(name, known)}")
        kept = tuple(section for section in self.estimators if section.name in names)
        return self.model_copy(update={"estimators": kept}) if names else self


def made(tree: Mapping[str, Any], source: str) -> Study:
    """A study from nested mappings; ValueError in one line that begins with the source."""
    try:
        return Study.model_validate(tree)
    except ValidationError as error:
        raise ValueError(f"{source}: {complaint(error, Study)}") from None


def load(path: Path) -> Study:
    """Read a study file.

    Parameters
    ----------
    path
        A TOML file (docs/study-files.md); the files that it names by a relative path lie beside it.

    Returns
    -------
    Study
        Checked, but for what only its design points can tell (`engine.check`).

    Raises
    ------
    ValueError
        Where it is no TOML, and for the first thing that is wrong in it: file, key, value and what is allowed.
    OSError
        Where it cannot be read.
    """
    try:
        tree = tomllib.loads(path.read_text(encoding="utf-8"))
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise ValueError(f"{path}: it must be TOML: {error}") from None
    return made(_beside(path, tree), str(path))


def _beside(path: Path, tree: Any) -> Any:
    """Nested tables with the files that they name found beside another file."""
    if isinstance(tree, list):
        return [_beside(path, part) for part in tree]
    if not isinstance(tree, dict):
        return tree
    found = {key: _beside(path, part) for key, part in tree.items()}
    if found.get("kind") == "height-map" and isinstance(found.get("file"), str):
        found["file"] = str(path.parent / found["file"])
    return found
