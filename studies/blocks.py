"""The store of a run: Parquet files of measured blocks, each written whole or not at all."""

import hashlib
import heapq
import json
import os
import re
from collections import defaultdict
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import chain, groupby
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

from studies.design import Point, Task
from studies.drawing import Traces
from studies.measurement import Block
from studies.seeds import canonical
from studies.stored import SCHEMA, Stored, digest, plain, stored

TRACES = pa.schema([("name", pa.string()), ("shape", pa.list_(pa.int64())), ("values", pa.list_(pa.float64()))])
TRACED = ".traces.parquet"
"""How the names of files with traces end."""

KEY = b"twinecho"
ROWS = 1024
"""Rows that are read, checked or written at a time."""

_NAME = re.compile(r"([0-9a-f]{16})-(\d+)(?:-(\d+))?\.parquet")


class Segment(NamedTuple):
    """A file with rows of the blocks `first` to `last` of one point; not necessarily of all of them."""

    first: int
    last: int
    path: Path


@dataclass(frozen=True)
class Store:
    """Block files below a folder, all of one design.

    A block is written to a file of its own, and the files of a finished point are put together into one. Every file
    names the design and the point, every row has a digest of both and of itself. A file or row that does not match,
    that is cut off or damaged counts as missing.

    Parameters
    ----------
    folder
        Where the files are.
    design
        Digest of all that decides their numbers, but for the point and what is in the rows.
    """

    folder: Path
    design: str

    def path(self, task: Task) -> Path:
        """File of a single block."""
        return self.folder / f"{task.point.key}-{task.block:06d}.parquet"

    @cached_property
    def _segments(self) -> dict[str, list[Segment]]:
        """The files of each point, as they were when the store was opened."""
        found = defaultdict(list)
        if self.folder.is_dir():
            with os.scandir(self.folder) as entries:
                for entry in entries:
                    if name := _NAME.fullmatch(entry.name):
                        first, last = int(name[2]), int(name[3] or name[2])
                        found[name[1]].append(Segment(first, last, Path(entry.path)))
        return {key: sorted(segments) for key, segments in found.items()}

    def read(self, point: Point) -> Iterator[tuple[int, list[Stored]]]:
        """The good rows of a point, block by block in order; a few in memory at a time."""
        return self._merged(point, self._segments.get(point.key, []))

    def _merged(self, point: Point, segments: Sequence[Segment]) -> Iterator[tuple[int, list[Stored]]]:
        rows = chain.from_iterable(
            heapq.merge(*(self._rows(point, segment.path) for segment in group), key=lambda row: row.block)
            for group in _overlapping(segments)
        )
        for block, together in groupby(rows, key=lambda row: row.block):
            once = {(row.trials, *row.measurement.labels, row.measurement.region): row for row in together}
            yield block, list(once.values())

    def write(self, task: Task, block: Block) -> None:
        """Store the measurements of a block beside others of it, and its traces where it has some."""
        self.folder.mkdir(parents=True, exist_ok=True)
        if block.traces:
            self._write_traces(task.point, task.block, block.traces)
        new = {m.labels for m in block.measurements}
        kept = [
            row
            for row in self._rows(task.point, self.path(task))
            if row.trials == task.trials and row.measurement.labels not in new
        ]
        rows = [*kept, *(Stored(task.block, task.trials, measurement) for measurement in block.measurements)]
        self._write(self.path(task), task.point, rows)

    def compact(self, point: Point, shorter_than: float = np.inf) -> None:
        """Put the files of a point into one, all that there are now or those of fewer blocks than a number."""
        now = Store(self.folder, self.design)
        segments = [s for s in now._segments.get(point.key, []) if s.last - s.first + 1 < shorter_than]
        if len(segments) < 2:
            return
        first, last = segments[0].first, max(segment.last for segment in segments)
        path = self.folder / f"{point.key}-{first:06d}-{last:06d}.parquet"
        self._write(path, point, (row for _, rows in self._merged(point, segments) for row in rows))
        for segment in segments:
            if segment.path != path:
                segment.path.unlink(missing_ok=True)

    def others(self, points: Iterable[Point]) -> int:
        """How many other points there are files of."""
        return len(set(self._segments) - {point.key for point in points})

    def take_over(self, point: Point, other: "Store") -> None:
        """Add what another store of the same design has of a point to what is here, in one file."""
        here, there = (store._segments.get(point.key, []) for store in (self, other))
        if not there:
            return
        first, last = (here + there)[0].first, max(segment.last for segment in here + there)
        path = self.folder / f"{point.key}-{min(first, there[0].first):06d}-{last:06d}.parquet"
        self.folder.mkdir(parents=True, exist_ok=True)
        found = heapq.merge(self.read(point), other.read(point), key=lambda of_block: of_block[0])
        self._write(path, point, (row for _, rows in found for row in rows))
        for segment in here:
            if segment.path != path:
                segment.path.unlink(missing_ok=True)
        for block in other._traced(point):
            self._write_traces(point, block, other._traces(point, block))

    def clean(self) -> None:
        """Remove what a writer that was killed left half written."""
        for left in self.folder.glob(".*.parquet.*"):
            left.unlink(missing_ok=True)

    def read_traces(self, point: Point) -> Traces:
        """Traces of a point; none where there is no good file of them.

        Those of the first block, and of later ones that have some: images, of two dimensions, joined along track.
        """
        parts = [traces for block in self._traced(point) if (traces := self._traces(point, block))]
        if len(parts) < 2:
            return parts[0] if parts else {}
        return {
            name: np.concatenate([part[name] for part in parts if name in part]) if first.ndim == 2 else first
            for name, first in parts[0].items()
        }

    def _traces(self, point: Point, block: int) -> Traces:
        try:
            table = pq.read_table(self._traces_path(point, block))
            rows = table.to_pylist()
            good = (table.schema.metadata or {}).get(KEY) == self._identity(point, rows)
        except (OSError, ValueError, KeyError, TypeError, pa.ArrowException):
            return {}
        return {row["name"]: np.array(row["values"]).reshape(row["shape"]) for row in rows} if good else {}

    def _traced(self, point: Point) -> list[int]:
        """Numbers of the blocks of which there are traces, in order."""
        found = self.folder.glob(f"{point.key}*{TRACED}")
        return sorted(int(path.name[len(point.key) + 1 : -len(TRACED)] or 0) for path in found)

    def _write_traces(self, point: Point, block: int, traces: Traces) -> None:
        together = {**self._traces(point, block), **traces}
        rows = [{"name": n, "shape": list(np.shape(v)), "values": np.ravel(v).tolist()} for n, v in together.items()]
        table = pa.Table.from_pylist(rows, TRACES).replace_schema_metadata({KEY: self._identity(point, rows)})
        with _replacing(self._traces_path(point, block)) as beside:
            pq.write_table(table, beside.path)

    def _traces_path(self, point: Point, block: int) -> Path:
        number = f"-{block:06d}" if block else ""
        return self.folder / f"{point.key}{number}{TRACED}"

    def _identity(self, point: Point, rows: Sequence[Mapping[str, Any]] = ()) -> bytes:
        of = hashlib.sha256(json.dumps(rows).encode()).hexdigest() if rows else ""
        return canonical({"design": self.design, "echoes": point.echoes, "rows": of})

    def _write(self, path: Path, point: Point, rows: Iterable[Stored]) -> None:
        identity = self._identity(point)
        schema = SCHEMA.with_metadata({KEY: identity})
        with _replacing(path) as beside, pq.ParquetWriter(beside.path, schema) as writer:
            for chunk in _chunks(rows):
                signed = [{**row, "digest": digest(row, identity)} for row in map(plain, chunk)]
                writer.write_table(pa.Table.from_pylist(signed, schema))

    def _rows(self, point: Point, path: Path) -> Iterator[Stored]:
        """The good rows of a file, in the order of their blocks."""
        identity = self._identity(point)
        try:
            with pq.ParquetFile(path) as file:
                schema = file.schema_arrow
                if (schema.metadata or {}).get(KEY) != identity or schema.remove_metadata() != SCHEMA:
                    return
                for batch in file.iter_batches(ROWS):
                    for row in batch.to_pylist():
                        if row["digest"] == digest(row, identity):
                            yield stored(row)
        except FileNotFoundError:
            return
        except OSError as error:
            # A file that the system does not let us read is not a damaged one, whose complaint has no number.
            if error.errno is not None:
                raise
        except (ValueError, KeyError, TypeError, pa.ArrowException):
            return


def _overlapping(segments: Sequence[Segment]) -> Iterator[list[Segment]]:
    """Groups of segments, in order, of which no two hold the same block: few files are open at a time."""
    group: list[Segment] = []
    last = -1
    for segment in segments:
        if group and segment.first > last:
            yield group
            group = []
        group.append(segment)
        last = max(last, segment.last)
    if group:
        yield group


class _replacing:
    """A path beside another, that takes its place when all went well and is removed otherwise."""

    def __init__(self, path: Path) -> None:
        self.final, self.path = path, path.with_name(f".{path.name}.{os.getpid()}")

    def __enter__(self) -> "_replacing":
        return self

    def __exit__(self, kind: object, *_: object) -> None:
        try:
            if kind is None:
                self.path.replace(self.final)
        finally:
            self.path.unlink(missing_ok=True)


def _chunks(rows: Iterable[Stored]) -> Iterator[list[Stored]]:
    chunk: list[Stored] = []
    for row in rows:
        chunk.append(row)
        if len(chunk) == ROWS:
            yield chunk
            chunk = []
    if chunk:
        yield chunk
