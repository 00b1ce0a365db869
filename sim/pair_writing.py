"""Pairs written as netCDF, HDF5 and npz."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sim.echo_pair import EchoPair
from sim.pair_layout import ATTRIBUTES, AXES, NEEDED, PLACED, xarray_with_h5netcdf


def write_pair(pair: EchoPair, path: str | Path) -> None:
    """Write a pair as netCDF (`.nc`), HDF5 (`.h5`, `.hdf5`) or npz (`.npz`); missing samples become NaN.

    In netCDF a series is two variables, its real and imaginary part; in the others one of complex numbers. Truth,
    likelihood ratios and what of the sonar does not place the pair are not written; a record that is periodic is
    written as one that is not.

    Parameters
    ----------
    pair
        What is written.
    path
        Where to; its end says as what.

    Raises
    ------
    ValueError
        For a path that ends otherwise.
    ImportError
        Where the extra `data` is not installed.
    """
    path = Path(path)
    variables = _variables(pair)
    if path.suffix == ".nc":
        parts = {part: value for name, found in variables.items() for part, value in _real_parts(name, *found)}
        xarray_with_h5netcdf().Dataset(parts, attrs={"Conventions": "CF-1.11", "title": "pair of echoes"}).to_netcdf(
            path, engine="h5netcdf"
        )
    elif path.suffix in (".h5", ".hdf5"):
        xarray_with_h5netcdf()
        import h5py

        with h5py.File(path, "w") as file:
            for name, (_, array) in variables.items():
                file[name] = array
                file[name].attrs.update(ATTRIBUTES[name])
    elif path.suffix == ".npz":
        np.savez(path, allow_pickle=False, **{name: array for name, (_, array) in variables.items()})
    else:
        raise ValueError(f"{path} ends with {path.suffix!r}; it must end with .nc, .h5, .hdf5 or .npz")


def _variables(pair: EchoPair) -> dict[str, tuple[tuple[str, ...], NDArray[Any]]]:
    """Axes and values of every variable of a pair."""
    found: dict[str, tuple[tuple[str, ...], NDArray[Any]]] = {}
    for name in ("primary", "secondary"):
        series = getattr(pair, name)
        nothing = series.dtype.type(complex(np.nan, np.nan))
        found[name] = AXES, series if pair.missing is None else np.where(pair.missing, nothing, series)
    numbers = {name: getattr(pair, name) for name in (*NEEDED, "row_looks")}
    if pair.geometry is not None:
        numbers |= {name: getattr(pair.geometry.sonar, name) for name in PLACED}
    found |= {name: ((), np.array(float(value))) for name, value in numbers.items()}
    found["time"] = ("time",), pair.grid.times
    if pair.row_spacing is not None:
        found["along_track"] = ("along_track",), pair.row_spacing * np.arange(pair.shape[0])
    return found


def _real_parts(name: str, axes: tuple[str, ...], array: NDArray[Any]) -> Iterator[tuple[str, Any]]:
    known = dict(ATTRIBUTES[name])
    if not np.iscomplexobj(array):
        yield name, (axes, array, known)
        return
    for part, words, values in (("real", "real", array.real), ("imag", "imaginary", array.imag)):
        yield f"{name}_{part}", (axes, values, known | {"long_name": f"{words} part of {known['long_name']}"})
