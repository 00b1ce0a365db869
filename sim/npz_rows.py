"""Arrays of an npz file, read by rows and without pickle."""

import zipfile
import zlib
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import IO, Any

import numpy as np
from numpy.typing import NDArray

_HEADERS = {(1, 0): np.lib.format.read_array_header_1_0, (2, 0): np.lib.format.read_array_header_2_0}


class NpzRows:
    """One array of an npz file, of which slices of the first axis are read.

    What is stored column by column (Fortran's order) is read as a whole; of a compressed file all that stands before
    the slice is read over.

    Parameters
    ----------
    archive, name
        The open file, and the array's name in it.

    Raises
    ------
    ValueError
        For an array of objects, which only pickle could read.
    """

    def __init__(self, archive: zipfile.ZipFile, name: str) -> None:
        self.archive, self.name = archive, name
        with self._member() as member:
            version = np.lib.format.read_magic(member)
            if version not in _HEADERS:
                raise ValueError(f"{name} is an array of format {version}; it must be 1.0 or 2.0")
            self.shape, self.by_columns, self.dtype = _HEADERS[version](member)
            self._begin = member.tell()
        if self.dtype.hasobject:
            raise ValueError(f"{name} is pickled; it must be an array of numbers")

    @property
    def ndim(self) -> int:
        """Number of axes."""
        return len(self.shape)

    def __getitem__(self, chosen: slice) -> NDArray[Any]:
        """A slice of the first axis, without step."""
        if self.by_columns:
            return np.asarray(self)[chosen]
        start, stop, _ = chosen.indices(self.shape[0])
        shape = max(stop - start, 0), *self.shape[1:]
        each = self.dtype.itemsize * int(np.prod(self.shape[1:]))
        with self._member() as member:
            member.seek(self._begin + start * each)
            data = member.read(shape[0] * each)
        if len(data) < shape[0] * each:
            raise ValueError(f"{self.name} ends before row {stop}; it must have all {self.shape[0]}")
        return np.frombuffer(data, self.dtype).reshape(shape)

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> NDArray[Any]:
        with self._member() as member:
            whole = np.lib.format.read_array(member, allow_pickle=False)
        return np.asarray(whole, dtype=dtype)

    @contextmanager
    def _member(self) -> Iterator[IO[bytes]]:
        try:
            with self.archive.open(f"{self.name}.npy") as member:
                yield member
        except (zipfile.BadZipFile, zlib.error, EOFError) as error:
            raise ValueError(f"{self.name} cannot be read: {error}") from None


@contextmanager
def npz_rows(path: Path) -> Iterator[dict[str, NpzRows]]:
    """The arrays of an npz file by name; ValueError for what is not one, or holds pickled objects."""
    try:
        archive = zipfile.ZipFile(path)
    except zipfile.BadZipFile as error:
        raise ValueError(f"it is not an npz file: {error}") from None
    with archive:
        names = [name.removesuffix(".npy") for name in archive.namelist() if name.endswith(".npy")]
        yield {name: NpzRows(archive, name) for name in names}
