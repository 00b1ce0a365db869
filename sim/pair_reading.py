"""Pairs read from netCDF, HDF5 and npz; from files larger than memory by blocks of rows.

Which variables a file has, `sim.pair_layout` says.
"""

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from difflib import get_close_matches
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sim import checks
from sim.band import Real
from sim.echo_pair import EchoPair
from sim.geometry import Geometry
from sim.npz_rows import npz_rows
from sim.pair_layout import ATTRIBUTES, AXES, NEEDED, PLACED, xarray_with_h5netcdf
from sim.sonar import Sonar

EVEN = 0.05
"""How far a place on an axis may be off even steps, in steps."""


def read_pair(path: str | Path) -> EchoPair:
    """Read a whole file.

    Samples that are not finite in either series are zero in both of the pair's, and `missing` says where.

    Parameters
    ----------
    path
        A netCDF-4, HDF5 or npz file; which one, its content says.

    Returns
    -------
    EchoPair
        With its geometry, where the file has it.

    Raises
    ------
    ValueError
        In one line, for a file of another kind, a variable that is missing, pickled, of another unit or shape, real
        series, axes that are not even, a sample rate below the bandwidth, and a file without a finite sample.
    ImportError
        Where the extra `data` is not installed.
    """
    with open_pair(path) as file:
        pair = file.rows(slice(None))
    if pair.missing is not None and pair.missing.all():
        raise ValueError(f"{path}: no sample is finite; some must be")
    return pair


@contextmanager
def open_pair(path: str | Path) -> "Iterator[PairFile]":
    """Open a file, checked but for its samples, to read rows of it while the context lasts.

    Parameters
    ----------
    path
        As for `read_pair`.

    Yields
    ------
    PairFile
        Closed with the context.

    Raises
    ------
    ValueError, ImportError, OSError
        As `read_pair`, in the context too.
    """
    path = Path(path)
    try:
        with _stored(path) as stored:
            yield PairFile(path, stored)
    except ValueError as error:
        raise ValueError(f"{path}: {error}") from None


@dataclass(frozen=True, eq=False)
class PairFile:
    """An open file with a pair, from which rows are read as they are asked for.

    Parameters
    ----------
    path
        Where it is.
    stored
        Its variables by name, each with `shape`, `dtype` and slices of its first axis.
    """

    path: Path
    stored: Mapping[str, Any]

    def __post_init__(self) -> None:
        for name in self.stored:
            self._check_units(name)
            self._check_name(name)
        self._check_series()
        self._check_axis("time", 1, 1 / self._number("sample_rate"))
        self._check_axis("along_track", 0, self.row_spacing)
        # What a pair refuses, but for its samples.
        self.rows(slice(0, 1))

    @property
    def shape(self) -> tuple[int, int]:
        """(rows along track, samples in time)."""
        return self._shapes["primary"]

    @cached_property
    def times(self) -> Real:
        """Times of the samples [s], shape (time,), from 0 where the file has none."""
        given = self._axis("time")
        return np.arange(self.shape[1]) / self._number("sample_rate") if given is None else given

    @cached_property
    def row_spacing(self) -> float | None:
        """Distance of rows [m]; None where the file does not say it, and of a single row."""
        given = self._axis("along_track")
        return None if given is None or given.size < 2 else float((given[-1] - given[0]) / (given.size - 1))

    @cached_property
    def geometry(self) -> Geometry | None:
        """Where the series were recorded; None where the file does not say it, ValueError where it says a part."""
        there = [name for name in PLACED if name in self.stored]
        if not there:
            return None
        lacking = [name for name in (*PLACED, "time") if name not in self.stored]
        if lacking:
            raise ValueError(f"{', '.join(lacking)} missing beside {', '.join(there)}; all or none must be given")
        sonar = Sonar(
            centre_frequency=self._number("centre_frequency"),
            bandwidth=self._number("bandwidth"),
            baseline=self._number("baseline"),
            altitude=self._number("altitude"),
            sound_speed=self._number("sound_speed"),
        )
        furthest = float(self.times[-1]) * sonar.sound_speed / 2
        if sonar.altitude >= furthest:
            raise ValueError(
                f"altitude is {sonar.altitude:g} m; it must be below the largest slant range, {furthest:g} m"
            )
        return Geometry(sonar, float(self.times[0]))

    def places(self) -> Real | None:
        """Distances of the rows along track [m], shape (rows,); None where the file does not say them."""
        return self._axis("along_track")

    def rows(self, chosen: slice) -> EchoPair:
        """The pair of only these rows; samples that are not finite in either series are missing, and zero."""
        primary, secondary = (np.atleast_2d(self._series(name, chosen)) for name in ("primary", "secondary"))
        return EchoPair.with_gaps(
            primary=primary,
            secondary=secondary,
            sample_rate=self._number("sample_rate"),
            centre_frequency=self._number("centre_frequency"),
            bandwidth=self._number("bandwidth"),
            geometry=self.geometry,
            row_spacing=self.row_spacing,
            row_looks=self._number("row_looks") if "row_looks" in self.stored else 1.0,
        )

    @cached_property
    def _shapes(self) -> dict[str, tuple[int, int]]:
        shapes = {}
        for name in ("primary", "secondary"):
            parts = [tuple(self.stored[part].shape) for part in self._parts(name)]
            if len(set(parts)) > 1:
                raise ValueError(f"{name}_real has the shape {parts[0]} and {name}_imag {parts[1]}; they must be equal")
            if len(parts[0]) not in (1, 2) or 0 in parts[0]:
                raise ValueError(f"{name} has the shape {parts[0]}; it must be (along_track, time), not empty")
            rows, samples = parts[0] if len(parts[0]) == 2 else (1, *parts[0])
            shapes[name] = rows, samples
        return shapes

    def _parts(self, name: str) -> tuple[str, ...]:
        """The variables that hold a series: a complex one, or two real ones."""
        if name in self.stored:
            if not np.issubdtype(self.stored[name].dtype, np.complexfloating):
                raise ValueError(
                    f"{name} is of type {self.stored[name].dtype}; it must be complex, or two variables {name}_real "
                    f"and {name}_imag"
                )
            return (name,)
        parts = f"{name}_real", f"{name}_imag"
        for part in parts:
            if part not in self.stored:
                other = f"{name} and {part} are" if part == parts[0] else f"{part} is"
                raise ValueError(f"{other} missing; a series must be complex, or have two parts {' and '.join(parts)}")
            if not np.issubdtype(self.stored[part].dtype, np.number) or "c" in self.stored[part].dtype.kind:
                raise ValueError(f"{part} is of type {self.stored[part].dtype}; it must be of real numbers")
        return parts

    def _series(self, name: str, chosen: slice) -> NDArray[Any]:
        parts = [self.stored[part] for part in self._parts(name)]
        values = [np.asarray(part[chosen]) if part.ndim == 2 else np.asarray(part)[None][chosen] for part in parts]
        # Native single or double precision, whatever the file has.
        kind = np.complex64 if np.result_type(np.complex64, *values).itemsize == 8 else np.complex128
        if len(values) == 1:
            return values[0].astype(kind, copy=False)
        series = np.empty(values[0].shape, dtype=kind)
        series.real, series.imag = values
        return series

    def _check_series(self) -> None:
        for name in NEEDED:
            checks.positive(name, self._number(name), "Hz")
        if self._shapes["primary"] != self._shapes["secondary"]:
            raise ValueError(
                f"primary has the shape {self._shapes['primary']} and secondary {self._shapes['secondary']}; "
                "they must be equal"
            )
        for name in ("primary", "secondary"):
            for part in self._parts(name):
                axes = getattr(self.stored[part], "dims", ())
                if axes != AXES and set(axes) & set(AXES):
                    raise ValueError(f"{part} has the axes ({', '.join(map(str, axes))}); they must be {_listed(AXES)}")

    def _check_axis(self, name: str, axis: int, step: float | None) -> None:
        given = self._axis(name)
        if given is None:
            return
        if given.shape != (self.shape[axis],):
            raise ValueError(f"{name} has the shape {given.shape}; the series have {self.shape[axis]} there")
        if step is None:
            return
        off = np.abs(given - given[0] - step * np.arange(given.size)).max()
        if not (step > 0 and off <= EVEN * step):
            raise ValueError(
                f"{name} is up to {off:.3g} {_units(name)} off even steps of {step:g} {_units(name)}; it must rise "
                f"evenly, within {EVEN:g} steps"
            )

    def _check_name(self, name: str) -> None:
        """ValueError for what is nearly the name of a variable that is not there: it would be ignored."""
        absent = [known for known in ATTRIBUTES if known not in self.stored]
        if name not in ATTRIBUTES and not name.startswith(("primary", "secondary")):
            for meant in get_close_matches(name, absent, 1, 0.8):
                raise ValueError(f"{name} is no variable of a pair; it must be {meant}, or have another name")

    def _check_units(self, name: str) -> None:
        given = getattr(self.stored[name], "attrs", {}).get("units")
        known = _units(name)
        # Of the echoes any unit will do.
        if given is not None and known not in (None, "1") and given != known:
            raise ValueError(f"{name} is in {given}; it must be in {known}")

    def _axis(self, name: str) -> Real | None:
        if name not in self.stored:
            return None
        given = np.asarray(self.stored[name])
        if given.dtype.kind not in "iuf":
            raise ValueError(f"{name} is of type {given.dtype}; it must be of real numbers")
        return given.astype(float)

    def _number(self, name: str) -> float:
        if name not in self.stored:
            raise ValueError(f"{name} is missing; it must be given, in {_units(name)}")
        value = np.asarray(self.stored[name])
        if value.size != 1 or value.dtype.kind not in "iuf":
            raise ValueError(f"{name} has the shape {value.shape} and type {value.dtype}; it must be one number")
        return float(value.reshape(()))


@contextmanager
def _stored(path: Path) -> Iterator[Mapping[str, Any]]:
    """The variables of a file by name, not yet read."""
    with path.open("rb") as file:
        start = file.read(8)
    if start == b"\x89HDF\r\n\x1a\n":
        with _opened(path) as dataset:
            yield {str(name): dataset[name] for name in dataset.variables}
    elif start.startswith(b"PK"):
        with npz_rows(path) as arrays:
            yield arrays
    else:
        raise ValueError("it is neither netCDF-4, HDF5 nor npz; it must be one of them")


def _opened(path: Path) -> Any:
    """A netCDF or HDF5 file; ValueError where it is damaged, or points at what is not there."""
    xarray = xarray_with_h5netcdf()
    try:
        return xarray.open_dataset(path, engine="h5netcdf", decode_times=False, cache=False, phony_dims="access")
    except (OSError, KeyError, RuntimeError, AttributeError, TypeError, IndexError) as error:
        raise ValueError(f"it cannot be read, {type(error).__name__}: {error}") from None


def _units(name: str) -> str | None:
    known = ATTRIBUTES.get(name)
    return None if known is None else known["units"]


def _listed(names: tuple[str, ...]) -> str:
    return f"({', '.join(names)})"
