"""A measurement as a row of a Parquet file, with a digest of itself, and back."""

import hashlib
import json
from array import array
from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np
import pyarrow as pa

from studies.measurement import Failure, Measurement
from studies.moments import PAIRED, QUANTITIES, Moments

SCHEMA = pa.schema(
    [
        ("block", pa.int64()),
        ("trials", pa.int64()),
        ("estimator", pa.string()),
        ("window", pa.string()),
        ("region", pa.string()),
        ("regions", pa.int64()),
        ("facts", pa.string()),
        ("clusters", pa.int64()),
        ("counted", pa.int64()),
        ("wrap_errors", pa.int64()),
        ("totals", pa.list_(pa.float64())),
        ("products", pa.list_(pa.float64())),
        ("square_weight", pa.float64()),
        ("largest_weight", pa.float64()),
        ("batches", pa.list_(pa.float64())),
        ("failures", pa.int64()),
        ("failed", pa.string()),
        ("flagged", pa.int64()),
        ("seconds_per_pixel", pa.float64()),
        ("digest", pa.string()),
    ]
)

_LISTS = tuple(field.name for field in SCHEMA if pa.types.is_list(field.type))
_SCALARS = tuple(name for name in SCHEMA.names if name not in (*_LISTS, "digest"))
_UPPER = np.triu_indices(len(QUANTITIES))


class Stored(NamedTuple):
    """A measurement as it was found."""

    block: int
    trials: int
    measurement: Measurement


def digest(row: Mapping[str, Any], identity: bytes) -> str:
    """Of a row's other columns and of the file's identity."""
    scalars = [row[name] for name in _SCALARS]
    found = hashlib.sha256(identity + json.dumps(scalars).encode())
    for name in _LISTS:
        found.update(array("d", row[name]).tobytes())
    return found.hexdigest()[:32]


def plain(row: Stored) -> dict[str, Any]:
    """The columns of a row, but for its digest."""
    m, moments = row.measurement, row.measurement.moments
    return {
        "block": row.block,
        "trials": row.trials,
        "estimator": m.estimator,
        "window": m.window,
        "region": m.region,
        "regions": m.regions,
        "facts": json.dumps(dict(m.facts)),
        "clusters": moments.clusters,
        "counted": moments.trials,
        "wrap_errors": moments.wrap_errors,
        "totals": moments.totals.tolist(),
        "products": moments.products[_UPPER].tolist(),
        "square_weight": moments.square_weight,
        "largest_weight": moments.largest_weight,
        "batches": m.batches.ravel().tolist(),
        "failures": m.failures,
        "failed": json.dumps([list(failure) for failure in m.failed]),
        "flagged": m.flagged,
        "seconds_per_pixel": m.seconds_per_pixel,
    }


def stored(row: Mapping[str, Any]) -> Stored:
    """The measurement of a row."""
    products = np.empty((len(QUANTITIES),) * 2)
    products[_UPPER] = products.T[_UPPER] = row["products"]
    moments = Moments(
        clusters=row["clusters"],
        trials=row["counted"],
        wrap_errors=row["wrap_errors"],
        totals=np.array(row["totals"]),
        products=products,
        square_weight=row["square_weight"],
        largest_weight=row["largest_weight"],
    )
    measurement = Measurement(
        row["estimator"],
        row["window"],
        row["region"],
        row["regions"],
        facts=json.loads(row["facts"]),
        moments=moments,
        batches=np.array(row["batches"]).reshape(-1, len(PAIRED)),
        failures=row["failures"],
        failed=[Failure(*failure) for failure in json.loads(row["failed"])],
        flagged=row["flagged"],
        seconds_per_pixel=row["seconds_per_pixel"],
    )
    return Stored(row["block"], row["trials"], measurement)
