"""Estimates of a measured pair, block by block of its rows, into a netCDF file."""

import math
import re
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from types import MappingProxyType
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from estimators import DelayEstimate, Estimator, FixedWindow
from estimators.conformance_checks import form
from estimators.depth import depth_map
from sim import EchoPair, PairFile, checks, open_pair
from sim.band import Real
from sim.pair_layout import xarray_with_h5netcdf
from studies.method import EstimatorSection, Method
from studies.named import words_of
from studies.options import Options, rows_in
from studies.progress import Show

BLOCK_SAMPLES = 2**20
"""Samples of a block of rows, where its size is not given."""


class Field(NamedTuple):
    """A variable of the file: its type, and its attributes."""

    kind: str
    units: str
    long_name: str
    more: Mapping[str, Any] = MappingProxyType({})


FLAGS = MappingProxyType({"flag_values": np.array([0, 1], dtype=np.int8), "flag_meanings": "not_valid valid"})

FIELDS: Mapping[str, Field] = MappingProxyType(
    {
        "intensity": Field("f4", "dB", "power of the primary receiver"),
        "delay": Field("f8", "s", "delay of the secondary behind the primary"),
        "delay_std": Field("f4", "s", "predicted standard deviation of the delay while the wrap is right"),
        "coherence": Field("f4", "1", "sample coherence at the delay"),
        "wrap_error_probability": Field("f4", "1", "predicted probability that the wrap is wrong"),
        "valid": Field("i1", "1", "whether the estimate is valid", FLAGS),
    }
)

PLACED_FIELDS: Mapping[str, Field] = MappingProxyType(
    {
        "depth": Field("f8", "m", "depth of the seabed below the primary receiver", {"positive": "down"}),
        "depth_std": Field("f4", "m", "predicted standard deviation of the depth while the wrap is right"),
        "ground_range": Field("f8", "m", "horizontal distance of the seabed from the sonar"),
    }
)
"""Those of a pair with a geometry."""

WHERE_VALID = ("delay", "delay_std", "wrap_error_probability", "depth", "depth_std", "ground_range")
"""What stands only where it is valid, and is NaN elsewhere; the coherence, where the window holds all it should."""


def estimate_file(
    path: Path,
    estimator: str,
    window: str,
    out: Path,
    *,
    options: Options = MappingProxyType({}),
    block: int | None = None,
    progress: Show = lambda done, total: None,
) -> str:
    """Estimate the delays of a pair in a file, and its depths where it has a geometry, into another file.

    Rows are read, estimated and written in blocks of whole windows, with the rows of all windows around each: as moving
    sums group the same rows, the file has the same bits whatever the block. An estimator of one's own must not look
    further along track than its window and those of its options together.

    Parameters
    ----------
    path
        What `sim.open_pair` reads.
    estimator
        A class of `estimators`, the entry point of a package or `module:object`; made with a window and options.
    window
        `ROWSxSAMPLES`.
    out
        NetCDF file for the estimates; it is there when all of it is written.
    options
        Of the estimator.
    block
        Rows at a time, rounded up to whole windows; what holds some 2^20 samples where None.
    progress
        Is told rows done, and of how many.

    Returns
    -------
    str
        How much there was, was valid and was missing.

    Raises
    ------
    ValueError
        In one line, as `sim.read_pair`, for an estimator, window or option that cannot be, and where `out` is `path`.
    ImportError
        Where the extra `data` is not installed.
    """
    size = fixed_window(window)
    section = EstimatorSection(name="estimate", method=estimator, options=options)
    made = Method(section, size).build(np.random.default_rng(0))
    _check_out(out, path)
    with open_pair(path) as file:
        size.check(file)
        whole, reach = _along_track(size, section.options)
        rows = _block_rows(file, whole, block)
        given = "".join(f", {name} = {value}" for name, value in options.items())
        words = {"source": f"{estimator} with a window of {size} pixels{given}"}
        with _created(out, file, words) as variables:
            bad, valid = 0, 0
            for start in range(0, file.shape[0], rows):
                inner = slice(start, min(start + rows, file.shape[0]))
                found, missing = _estimated(file, inner, made, size, reach)
                for name, values in found.items():
                    variables[name][inner] = values
                bad, valid = bad + missing, valid + int(found["valid"].sum())
                progress(inner.stop, file.shape[0])
            pixels = file.shape[0] * file.shape[1]
            if bad == pixels:
                raise ValueError("no sample is finite; some must be")
            variables["valid"].attrs["missing_share"] = bad / pixels
    rows, samples = file.shape
    return f"{rows} x {samples} pixels, {_share(valid / pixels)} valid, {_share(bad / pixels)} of samples NaN"


def fixed_window(text: str) -> FixedWindow:
    """The window that is written `ROWSxSAMPLES`; ValueError for another text."""
    found = re.fullmatch(r"(\d{1,9})x(\d{1,9})", text)
    if found is None:
        raise ValueError(f"window is {text!r}; it must be ROWSxSAMPLES, such as 9x9")
    return FixedWindow(int(found[1]), int(found[2]))


def _along_track(window: FixedWindow, options: Options) -> tuple[int, int]:
    """Rows that are whole windows of every size, and so many of these as an estimate may depend on."""
    rows = [window.rows, *rows_in(options)]
    whole = math.lcm(*rows)
    return whole, -(-sum(rows) // whole) * whole


def _check_out(out: Path, path: Path) -> None:
    """ValueError where estimates cannot be written, before any is made."""
    if out.suffix != ".nc":
        raise ValueError(f"out is {out}; it must end with .nc")
    if out.exists() and path.exists() and out.samefile(path):
        raise ValueError(f"out is {out}, the file that is read; it must be another")
    if out.is_dir():
        raise ValueError(f"out is {out}, a folder; it must be a file")


def _block_rows(file: PairFile, whole: int, block: int | None) -> int:
    wanted = max(BLOCK_SAMPLES // file.shape[1], 1) if block is None else checks.count("block", block)
    return -(-wanted // whole) * whole


def _estimated(
    file: PairFile, inner: slice, estimator: Estimator, window: FixedWindow, reach: int
) -> tuple[dict[str, NDArray[Any]], int]:
    """Values of every variable in some rows, and how many samples are missing there."""
    first = max(inner.start - reach, 0)
    pair = file.rows(slice(first, min(inner.stop + reach, file.shape[0])))
    kept = slice(inner.start - first, inner.stop - first)
    found = {name: np.broadcast_to(values, pair.shape)[kept] for name, values in _fields(pair, estimator, window)}
    names = [name for name in found if name not in ("intensity", "valid")]
    valid = found["valid"] & np.all([np.isfinite(found[name]) for name in names], axis=0)
    found |= {name: np.where(valid, found[name], np.nan) for name in names if name in WHERE_VALID}
    missing = 0 if pair.missing is None else int(pair.missing[kept].sum())
    return found | {"valid": valid.astype(np.int8)}, missing


def _fields(pair: EchoPair, estimator: Estimator, window: FixedWindow) -> Iterator[tuple[str, NDArray[Any]]]:
    estimate = _estimate(pair, estimator)
    # An estimator of one's own may not ask for what is missing.
    inside = window.inside(pair)
    valid = estimate.valid & inside
    yield "intensity", _decibels(pair)
    yield "coherence", np.where(inside, estimate.coherence, np.nan)
    for name in ("delay", "delay_std", "wrap_error_probability"):
        yield name, getattr(estimate, name)
    if pair.geometry is not None:
        depths = depth_map(pair, estimate, window)
        yield "depth", pair.geometry.sonar.altitude - depths.height
        yield "depth_std", depths.height_std
        yield "ground_range", depths.ground_range
        valid = valid & depths.valid
    yield "valid", valid


def _estimate(pair: EchoPair, estimator: Estimator) -> DelayEstimate:
    name = type(estimator).__name__
    try:
        estimate = estimator.estimate(pair)
    except (ValueError, MemoryError):
        raise
    except (Exception, SystemExit) as error:  # One's own may do anything.
        raise ValueError(f"{name} failed: {words_of(error)}") from None
    for wrong in form(estimate, pair.shape):
        raise ValueError(f"{name} gave what is no estimate: {wrong}")
    return estimate


def _decibels(pair: EchoPair) -> Real:
    """Power of the primary [dB]; NaN where there is none."""
    magnitude = np.abs(pair.primary).astype(float)
    level: Real = 20 * np.log10(np.where(magnitude > 0, magnitude, np.nan))
    return level


@contextmanager
def _created(out: Path, file: PairFile, words: Mapping[str, Any]) -> Iterator[Mapping[str, Any]]:
    """The variables of a new file, to be filled; it gets its name when all went well."""
    xarray_with_h5netcdf()
    import h5netcdf

    part = out.with_name(f"{out.name}.part")
    try:
        with h5netcdf.File(part, "w") as dataset:
            yield _declared(dataset, file, words)
        part.replace(out)
    finally:
        part.unlink(missing_ok=True)


def _declared(dataset: Any, file: PairFile, words: Mapping[str, Any]) -> Mapping[str, Any]:
    dataset.attrs.update(
        {"Conventions": "CF-1.11", "title": "delay of the echoes at two receivers", "source": words["source"]}
    )
    dataset.dimensions = dict(zip(("along_track", "time"), file.shape, strict=True))
    coordinates = {"time": (file.times, "s", "time after transmission at the primary receiver")}
    if (places := file.places()) is not None:
        coordinates["along_track"] = places, "m", "distance along track"
    for name, (values, units, long_name) in coordinates.items():
        dataset.create_variable(name, (name,), data=values).attrs.update({"units": units, "long_name": long_name})
    fields = FIELDS if file.geometry is None else {**FIELDS, **PLACED_FIELDS}
    for name, field in fields.items():
        nothing = None if field.kind == "i1" else np.dtype(field.kind).type(np.nan)
        variable = dataset.create_variable(name, ("along_track", "time"), field.kind, fillvalue=nothing)
        variable.attrs.update({"units": field.units, "long_name": field.long_name, **field.more})
        if name in WHERE_VALID:
            variable.attrs["ancillary_variables"] = "valid"
    return {name: dataset[name] for name in fields}


def _share(share: float) -> str:
    return f"{100 * share:.3g} %"
