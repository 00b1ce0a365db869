"""Seeds: one stream of random numbers for each design point and block, whatever runs before or beside it."""

import hashlib
import json
from collections.abc import Mapping
from typing import Any

import numpy as np


def canonical(value: Mapping[str, Any]) -> bytes:
    """The one JSON text of a mapping: keys sorted, no spaces, finite numbers only."""
    return json.dumps(value, sort_keys=True, separators=(",", ":"), allow_nan=False).encode()


def check(root: int) -> None:
    """ValueError unless a root seed is a whole number of 0 to 2^128 - 1."""
    if not 0 <= root < 2**128:
        raise ValueError(f"seed is {root}; it must lie between 0 and 2^128 - 1")


def generator(root: int, point: Mapping[str, Any], block: int, stream: int = 0) -> np.random.Generator:
    """Random numbers of one block of one design point.

    Philox, seeded by `SeedSequence(root, spawn_key)` with a key of six words: four of the SHA-256 of the point's
    canonical JSON, the block and the stream. Points, blocks or streams that are added change no others.

    Parameters
    ----------
    root
        Seed of the whole run, 0 to 2^128 - 1.
    point
        Parameters of the design point; what JSON can hold.
    block, stream
        Whole numbers from 0.

    Raises
    ------
    ValueError
        For a root outside its limits.
    """
    check(root)
    words = np.frombuffer(hashlib.sha256(canonical(point)).digest()[:16], dtype=">u4")
    key = (*(int(word) for word in words), block, stream)
    return np.random.Generator(np.random.Philox(np.random.SeedSequence(root, spawn_key=key)))
