"""The catalogue of sediments: the tables of the handbooks, found by forgiving names."""

import csv
import difflib
import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import replace
from importlib import resources

from sim.sediment import ElasticBed, FluidBed, Sediment


class UnknownSediment(ValueError, KeyError):
    """A name that no sediment has."""

    __str__ = Exception.__str__


class Catalogue(Mapping[str, Sediment]):
    """Sediments by name.

    A name is split at commas and slashes, and each part is a name of its own; case, plural and the order of words do
    not matter, and any character that is no letter separates words. So `"Coarse_Sand"` and `"gravelly sand"` are both
    `"coarse sand, gravelly sand"`. The keys are the full names.
    """

    def __init__(self, sediments: Iterable[Sediment]) -> None:
        self._sediments = {sediment.name: sediment for sediment in sediments}
        self._names = {}
        for full in self._sediments:
            for name in (full, *re.split("[,/]", full)):
                self._names[_words(name)] = full

    def __getitem__(self, name: str) -> Sediment:
        """The sediment; UnknownSediment (a ValueError and a KeyError) with the closest names if there is none."""
        words = _words(name) if isinstance(name, str) else ()
        if words not in self._names:
            raise UnknownSediment(f"sediment is {name!r}; {self._advice(str(name))}")
        return self._sediments[self._names[words]]

    def __iter__(self) -> Iterator[str]:
        return iter(self._sediments)

    def __len__(self) -> int:
        return len(self._sediments)

    def _advice(self, name: str) -> str:
        parts = [part.strip() for full in self for part in re.split("[,/]", full)]
        close = difflib.get_close_matches(name.lower(), parts, n=4, cutoff=0.5)
        return f"the closest names are {', '.join(close)}" if close else f"it must be one of {', '.join(parts)}"


def find(sediment: Sediment | str) -> Sediment:
    """A sediment itself, or that of the catalogue of this name; UnknownSediment (a ValueError) if there is none."""
    return sediment if isinstance(sediment, Sediment) else SEDIMENTS[sediment]


def _words(name: str) -> tuple[str, ...]:
    words = re.findall("[a-z]+", name.lower())
    return tuple(sorted(word.removesuffix("s") for word in words))


def _rows(name: str) -> Iterator[tuple[str, dict[str, float]]]:
    table = (resources.files("sim") / "data" / name).read_text(encoding="utf-8")
    for row in csv.DictReader(table.splitlines()):
        yield row["sediment"], {name: float(value) for name, value in row.items() if name != "sediment"}


def _read() -> Catalogue:
    fluids = Catalogue(Sediment(name, FluidBed(**row)) for name, row in _rows("sediments.csv"))
    elastic = {fluids[name].name: ElasticBed(**row) for name, row in _rows("sediments_elastic.csv")}
    return Catalogue(replace(fluid, elastic=elastic.get(name)) for name, fluid in fluids.items())


SEDIMENTS = _read()
"""The 23 sediments of APL-UW TR 9407, table 2 (`sim/data/sediments.csv`). Rough rock, rock, cobble, sandy gravel,
coarse, medium and fine sand and silt have the elastic sets of TM 2-00 as well (`sim/data/sediments_elastic.csv`); rocks
fluctuate in density and both speeds, the others in density alone."""
