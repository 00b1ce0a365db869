"""Random numbers of a scene's rows: the same for a row whatever block or process simulates it."""

from dataclasses import dataclass
from enum import IntEnum

import numpy as np

from sim.band import Complex, Real
from sim.passes import scale


class Use(IntEnum):
    """What random numbers are for."""

    PLACES = 0
    SPECKLE = 1
    TEXTURE = 2
    NOISE = 3


@dataclass(frozen=True)
class Streams:
    """Independent generators for every use and row, from entropy that was drawn once."""

    entropy: tuple[int, ...]

    @classmethod
    def drawn(cls, rng: np.random.Generator) -> "Streams":
        """Streams that follow from the state of a generator, which moves on."""
        return cls(tuple(int(word) for word in rng.integers(2**32, size=4)))

    def of(self, use: Use, row: int = 0) -> np.random.Generator:
        """The generator of one use in one row; rows before the first have negative numbers."""
        return np.random.default_rng(np.random.SeedSequence(self.entropy, spawn_key=(use, row % 2**32)))

    def gaussian(self, use: Use, rows: range, amplitude: Real) -> Complex:
        """Circular complex Gaussian numbers, shape (rows, count), of root mean square amplitudes (count,) or alike."""
        numbers = np.empty((len(rows), amplitude.shape[-1]), dtype=np.complex128)
        half = np.sqrt(0.5) * amplitude
        for place, row, share in zip(numbers, rows, np.broadcast_to(half, numbers.shape), strict=True):
            self.of(use, row).standard_normal(out=place.view(np.float64))
            scale(place, share)
        return numbers

    def texture(self, rows: range, count: int, shape: float | Real) -> Real:
        """Gamma-distributed powers of unit mean and a shape, a number or one for each; shape (rows, count)."""
        return np.array([self.of(Use.TEXTURE, row).gamma(shape, 1 / shape, count) for row in rows])
