"""Public names say what they are: parameters with units, and errors that are raised on purpose."""

import ast
import inspect
import re
import textwrap
from collections.abc import Iterator

import pytest

import estimators
import sim
import studies
from estimators import bounds

PACKAGES = (sim, estimators, bounds, studies)

CHECKS = {"checks", "positive", "checked_looks_and_coherence"}
"""What raises ValueError where it is called: the module, and the functions, of checks."""

BARE = re.compile(
    r"""\[.+\] | \d\ to\ \.?\d | \b(rate|ratio|looks?|share|over)\b | whole | number | least | `B\ /\ fc` | probabilit |
    exponent | loss | salinity | fluctuation | \bpH | scale | as\ (for|of)\ `""",
    re.VERBOSE | re.IGNORECASE,
)
"""What says of a number that it has no unit, or how it is counted."""

NUMBERS = re.compile(r"\b(float|ArrayLike|Real|Floats|Complex)\b")


def names() -> Iterator[tuple[str, object]]:
    for package in PACKAGES:
        for name in package.__all__:
            thing = getattr(package, name)
            if not inspect.ismodule(thing):
                yield f"{package.__name__}.{name}", thing


CLASSES = {name: thing for name, thing in names() if inspect.isclass(thing) and not issubclass(thing, Warning)}
FUNCTIONS = {name: thing for name, thing in names() if inspect.isfunction(thing)}
METHODS = {
    f"{of}.{name}": getattr(member, "fget", None)
    or getattr(member, "func", None)
    or getattr(member, "__func__", member)
    for of, cls in CLASSES.items()
    for name, member in vars(cls).items()
    if not name.startswith("_")
    and (inspect.isroutine(member) or isinstance(member, property) or hasattr(member, "func"))
}


def sections(thing) -> dict[str, list[str]]:
    """The lines of a docstring by the section of numpydoc that they are in; the words before under no name."""
    lines, found, place = inspect.cleandoc(thing.__doc__ or "").splitlines(), {"": []}, ""
    for line, below in zip(lines, [*lines[1:], ""], strict=True):
        if re.fullmatch("-{3,}", below):
            place = line
            found[place] = []
        elif not re.fullmatch("-{3,}", line):
            found[place].append(line)
    return found


def entries(thing) -> dict[str, str]:
    """What is said of each parameter or attribute."""
    found: dict[str, str] = {}
    these: list[str] = []
    for section in ("Parameters", "Attributes"):
        for line in sections(thing).get(section, []):
            if line and not line.startswith(" "):
                these = [name.strip().lstrip("*") for name in line.split(",")]
                found |= dict.fromkeys(these, "")
            for name in these:
                found[name] += f" {line.strip()}" if line.startswith(" ") else ""
    return found


def parameters(thing) -> dict[str, str]:
    """Annotations by parameter."""
    try:
        given = inspect.signature(thing).parameters.values()
    except ValueError:
        return {}
    return {p.name: str(p.annotation) for p in given if p.name not in ("self", "cls", "args", "kwargs")}


def raises(thing) -> bool:
    """Whether its own code raises ValueError, or calls what checks for it."""
    tree = ast.parse(textwrap.dedent(inspect.getsource(inspect.unwrap(thing))))
    for node in ast.walk(tree):
        if isinstance(node, ast.Raise) and node.exc is not None and "ValueError" in ast.unparse(node.exc):
            return True
        if isinstance(node, ast.Call) and ast.unparse(node.func).split(".")[0] in CHECKS:
            return True
    return False


def without_a_unit(thing, said: dict[str, str]) -> list[str]:
    numbers = [name for name, annotation in parameters(thing).items() if NUMBERS.search(annotation) and name in said]
    return [name for name in numbers if not BARE.search(said[name])]


@pytest.mark.parametrize("name", FUNCTIONS)
def test_a_function_names_parameters_units_result_and_errors(name):
    thing = FUNCTIONS[name]
    said = entries(thing)
    assert [p for p in parameters(thing) if p not in said] == []
    assert without_a_unit(thing, said) == []
    returns = inspect.signature(thing).return_annotation
    assert returns in (None, "None") or {"Returns", "Yields"} & set(sections(thing))
    assert not raises(thing) or "Raises" in sections(thing)


@pytest.mark.parametrize("name", bounds.__all__)
def test_a_bound_names_its_source(name):
    assert re.search(r"Source: |[Tt]heory section \d|[Pp]aper [AB]|\b(19|20)\d\d\b", getattr(bounds, name).__doc__)


@pytest.mark.parametrize("name", CLASSES)
def test_a_class_names_attributes_units_and_errors(name):
    thing = CLASSES[name]
    said = {k: v for base in reversed(thing.__mro__[:-1]) for k, v in entries(base).items()}
    assert sections(thing)[""]
    assert [p for p in parameters(thing) if p not in said] == []
    assert without_a_unit(thing, said) == []
    made = vars(thing).get("__post_init__")
    assert made is None or not raises(made) or "Raises" in sections(thing)


@pytest.mark.parametrize("name", METHODS)
def test_a_method_says_what_it_gives_of_which_numbers_and_when_it_raises(name):
    thing = METHODS[name]
    assert thing.__doc__
    # What a protocol says of a method holds for all that have it.
    last = name.rpartition(".")[2]
    protocols = [cls for cls in CLASSES.values() if getattr(cls, "_is_protocol", False) and last in vars(cls)]
    words = " ".join(
        [thing.__doc__, *(vars(cls)[last].__doc__ or "" for cls in protocols if callable(vars(cls)[last]))]
    )
    numbers = [p for p, annotation in parameters(thing).items() if NUMBERS.search(annotation)]
    assert [p for p in numbers if not all(word in words for word in p.split("_"))] == []
    said = entries(thing)
    assert not said or [p for p in parameters(thing) if p not in said] == []
    assert not raises(thing) or "ValueError" in thing.__doc__


def test_what_is_missing_would_be_found():
    def poor(bandwidth: float, looks: float) -> float:
        """Something.

        Parameters
        ----------
        bandwidth
            Of the band.
        """
        if bandwidth < 0:
            raise ValueError(looks)
        return bandwidth

    assert raises(poor)
    assert set(parameters(poor)) - set(entries(poor)) == {"looks"}
    assert without_a_unit(poor, entries(poor)) == ["bandwidth"]
    assert len(FUNCTIONS) > 40
    assert len(CLASSES) > 60
    assert len(METHODS) > 100
