"""Heights on a grid: measured or made elsewhere, and random relief."""

from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np
import scipy.fft

from sim import checks
from sim.band import Real
from sim.features import Outline


@dataclass(frozen=True, eq=False)
class HeightMap:
    """A height on a grid, straight between its nodes and level beyond its edges.

    Parameters
    ----------
    nodes
        Heights at the nodes [m], shape (along_track, ground_range).
    start
        Along-track place and ground range of the first node [m].
    spacing
        Distance of nodes along track and in ground range [m].

    Raises
    ------
    ValueError
        For heights that are no such array or not finite, and for a spacing that is not above 0.
    """

    nodes: Real
    start: tuple[float, float]
    spacing: tuple[float, float]

    def __post_init__(self) -> None:
        nodes = np.asarray(self.nodes, dtype=float)
        if nodes.ndim != 2 or nodes.size == 0:
            raise ValueError(f"nodes have the shape {nodes.shape}; it must be (along_track, ground_range)")
        checks.finite_samples("nodes", nodes)
        object.__setattr__(self, "nodes", nodes)
        for name, place, step in zip(("along_track", "ground_range"), self.start, self.spacing, strict=True):
            checks.finite(f"start in {name}", place, "m")
            checks.positive(f"spacing in {name}", step, "m")

    @classmethod
    def read(cls, file: str | Path) -> "HeightMap":
        """The height map of an `.npz` file with arrays of the names of the parameters.

        Raises
        ------
        ValueError
            Where the file cannot be read or lacks one of them; pickled objects are not read.
        """
        try:
            with np.load(file, allow_pickle=False) as arrays:
                nodes = arrays["nodes"]
                start, spacing = (tuple(float(part) for part in arrays[name]) for name in ("start", "spacing"))
        except (OSError, ValueError, KeyError, TypeError, EOFError, AttributeError) as error:
            said = " ".join(str(error).split())
            raise ValueError(
                f"{file} holds no height map ({said}); it must be .npz with nodes, start and spacing"
            ) from None
        if len(start) != 2 or len(spacing) != 2:
            raise ValueError(
                f"{file} has start {start} and spacing {spacing}; both must be (along_track, ground_range)"
            )
        return cls(nodes, (start[0], start[1]), (spacing[0], spacing[1]))

    @property
    def uniform(self) -> bool:
        """Whether all its rows are the same."""
        return bool((self.nodes == self.nodes[0]).all())

    @property
    def ends(self) -> None:
        """It may reach beyond the scene."""
        return

    @cached_property
    def heights(self) -> tuple[float, float]:
        """Of its nodes and the floor [m]."""
        return float(self.nodes.min(initial=0.0)), float(self.nodes.max(initial=0.0))

    def outline(self, along_track: float, ground_range: tuple[float, float]) -> Outline:
        """Its nodes in ground range, between the two rows of nodes around a place along track."""
        rows, columns = self.nodes.shape
        row = np.clip((along_track - self.start[0]) / self.spacing[0], 0, rows - 1)
        before = min(int(row), rows - 1)
        after = min(before + 1, rows - 1)
        first, last = np.clip((np.array(ground_range) - self.start[1]) / self.spacing[1], 0, columns - 1)
        chosen = np.arange(int(first), int(np.ceil(last)) + 1)
        share = row - before
        heights: Real = (1 - share) * self.nodes[before, chosen] + share * self.nodes[after, chosen]
        return self.start[1] + self.spacing[1] * chosen.astype(np.float64), heights


@dataclass(frozen=True)
class Roughness:
    """Random relief with a power-law spectrum, `W(K) ~ K^-exponent` in two dimensions, the same for the same seed.

    A Gaussian surface on a square grid that repeats itself every `period` in both directions, so that no stretch of
    seabed is too long for it; straight between nodes. Its spectrum is that of the sediments (`sim.Sediment`), at scales
    that the sonar resolves.

    Parameters
    ----------
    rms
        Root mean square height over a period [m].
    seed
        Of the surface, a whole number of at least 0.
    exponent
        Of the spectrum, 2 to 4; that of a section along a line is one less.
    period
        Longest wavelength [m].
    spacing
        Distance of nodes, half the shortest wavelength [m]; a period holds a whole number of them, 2 to 4096.

    Raises
    ------
    ValueError
        For a value outside these limits.
    """

    rms: float
    seed: int
    exponent: float = 3.25
    period: float = 51.2
    spacing: float = 0.1

    def __post_init__(self) -> None:
        checks.positive("rms", self.rms, "m")
        checks.count("seed", self.seed, least=0)
        checks.within("exponent", self.exponent, 2.0, 4.0)
        checks.positive("period", self.period, "m")
        nodes = self.period / checks.positive("spacing", self.spacing, "m")
        if abs(nodes - round(nodes)) > 1e-6 or not 2 <= round(nodes) <= 4096:
            raise ValueError(f"period / spacing is {nodes:g}; it must be a whole number between 2 and 4096")

    @cached_property
    def tile(self) -> Real:
        """Heights of one period [m], shape (along_track, ground_range)."""
        nodes = round(self.period / self.spacing)
        rng = np.random.default_rng(self.seed)
        wavenumber = np.hypot(*np.meshgrid(scipy.fft.fftfreq(nodes), scipy.fft.rfftfreq(nodes), indexing="ij"))
        wavenumber[0, 0] = np.inf
        shaped = scipy.fft.rfft2(rng.standard_normal((nodes, nodes))) * wavenumber ** (-self.exponent / 2)
        heights = scipy.fft.irfft2(shaped, s=(nodes, nodes))
        scaled: Real = heights * (self.rms / heights.std())
        return scaled

    @property
    def uniform(self) -> bool:
        """It is not."""
        return False

    @property
    def ends(self) -> None:
        """It has none."""
        return

    @cached_property
    def heights(self) -> tuple[float, float]:
        """Of its nodes [m]."""
        return float(self.tile.min()), float(self.tile.max())

    def outline(self, along_track: float, ground_range: tuple[float, float]) -> Outline:
        """Its nodes over these ground ranges, between the two rows of nodes around a place along track."""
        row = along_track / self.spacing
        before = int(np.floor(row))
        near, far = ground_range
        chosen = np.arange(int(np.floor(near / self.spacing)), int(np.ceil(far / self.spacing)) + 1)
        columns = chosen % len(self.tile)
        share = row - before
        here, there = (self.tile[line % len(self.tile), columns] for line in (before, before + 1))
        heights: Real = (1 - share) * here + share * there
        return self.spacing * chosen.astype(np.float64), heights
