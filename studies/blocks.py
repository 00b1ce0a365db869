"""The store of a run: one Parquet file for each block of trials, written whole or not at all."""

import hashlib
import json
import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

from studies.moments import QUANTITIES, Moments
from studies.seeds import canonical
from studies.study import Block, Measurement, Point, Traces

SCHEMA = pa.schema(
    [
        ("labels", pa.string()),
        ("facts", pa.string()),
        ("clusters", pa.int64()),
        ("totals", pa.list_(pa.float64())),
        ("products", pa.list_(pa.float64())),
        ("failures", pa.int64()),
        ("failure", pa.string()),
        ("seconds_per_pixel", pa.float64()),
    ]
)
TRACES = pa.schema([("name", pa.string()), ("shape", pa.list_(pa.int64())), ("values", pa.list_(pa.float64()))])
KEY = b"twinecho"


@dataclass(frozen=True)
class Task:
    """One block of trials of one design point."""

    point: Point
    block: int
    trials: int


@dataclass(frozen=True)
class Store:
    """Block files below a folder, all of one design.

    Every file holds what it is of, the digest of the design, the point, the block and its trials, and a digest of its
    own rows. A file that says something else, that is cut off or whose rows have another digest counts as missing.

    Parameters
    ----------
    folder
        Where the files are.
    design
        Digest of all that decides their numbers but point, block and trials.
    """

    folder: Path
    design: str

    def path(self, task: Task) -> Path:
        """File of a block."""
        name = hashlib.sha256(canonical(task.point)).hexdigest()[:16]
        return self.folder / f"{name}-{task.block:06d}.parquet"

    def write(self, task: Task, block: Block) -> None:
        """Store the measurements of a block and, of the first of a point, its traces."""
        self.folder.mkdir(parents=True, exist_ok=True)
        rows = [_row(measurement) for measurement in block.measurements]
        if task.block == 0:
            traces = [
                {"name": name, "shape": np.shape(values), "values": np.ravel(values)}
                for name, values in block.traces.items()
            ]
            self._write(task, _traces_path(self.path(task)), pa.Table.from_pylist(traces, TRACES))
        self._write(task, self.path(task), pa.Table.from_pylist(rows, SCHEMA))

    def read(self, task: Task) -> Sequence[Measurement]:
        """Measurements of a block; none where there is no good file of it."""
        table = self._read(task, self.path(task))
        return [] if table is None else [_measurement(row) for row in table.to_pylist()]

    def read_traces(self, task: Task) -> Traces:
        """Traces of the first block of a point; none where there is no good file of them."""
        table = self._read(task, _traces_path(self.path(task)))
        rows: list[dict[str, Any]] = [] if table is None else table.to_pylist()
        return {row["name"]: np.array(row["values"]).reshape(row["shape"]) for row in rows}

    def _identity(self, task: Task, table: pa.Table) -> bytes:
        rows = hashlib.sha256(json.dumps(table.to_pylist()).encode()).hexdigest()
        of = {"design": self.design, "point": dict(task.point), "block": task.block, "trials": task.trials}
        return canonical({**of, "rows": rows})

    def _write(self, task: Task, path: Path, table: pa.Table) -> None:
        whole = table.replace_schema_metadata({KEY: self._identity(task, table)})
        beside = path.with_name(f".{path.name}.{os.getpid()}")
        try:
            pq.write_table(whole, beside)
            beside.replace(path)
        finally:
            beside.unlink(missing_ok=True)

    def _read(self, task: Task, path: Path) -> pa.Table | None:
        try:
            table = pq.read_table(path)
            metadata: Mapping[bytes, bytes] = table.schema.metadata or {}
            return table if metadata.get(KEY) == self._identity(task, table) else None
        except (OSError, UnicodeDecodeError, pa.ArrowException):
            return None


def _traces_path(path: Path) -> Path:
    return path.with_suffix(".traces.parquet")


def _row(measurement: Measurement) -> dict[str, Any]:
    return {
        "labels": json.dumps(dict(measurement.labels)),
        "facts": json.dumps(dict(measurement.facts)),
        "clusters": measurement.moments.clusters,
        "totals": measurement.moments.totals,
        "products": measurement.moments.products.ravel(),
        "failures": measurement.failures,
        "failure": measurement.failure,
        "seconds_per_pixel": measurement.seconds_per_pixel,
    }


def _measurement(row: Mapping[str, Any]) -> Measurement:
    size = len(QUANTITIES)
    return Measurement(
        labels=json.loads(row["labels"]),
        facts=json.loads(row["facts"]),
        moments=Moments(row["clusters"], np.array(row["totals"]), np.array(row["products"]).reshape(size, size)),
        failures=row["failures"],
        failure=row["failure"],
        seconds_per_pixel=row["seconds_per_pixel"],
    )
