"""Homogeneous patches of speckle: two series of a stated coherence and delay."""

import numpy as np
from numpy.typing import ArrayLike

from sim import checks
from sim.band import Band, Complex, Real, TimeGrid
from sim.echo_pair import EchoPair, Truth


def speckle_pair(
    shape: tuple[int, int],
    *,
    coherence: float,
    delay: ArrayLike,
    centre_frequency: float,
    bandwidth: float,
    sample_rate: float,
    rng: np.random.Generator,
) -> EchoPair:
    """Fully developed speckle of one coherence and delay, periodic in time; rows are independent.

    In every Fourier bin of the flat band the primary is `P`, circular Gaussian, and the secondary
    `S = (gamma P + sqrt(1 - gamma^2) W) exp(-2 pi i (fc + f) tau)` with `W` independent of `P` and alike.
    The bins are independent looks; both series have unit mean power. Time grows as `rows samples log samples`, memory
    as the pixels.

    Parameters
    ----------
    shape
        (rows, samples).
    coherence
        Magnitude of the complex coherence, `gamma`, 0 to 1.
    delay
        Delay of the secondary, `tau` [s]; one number, or one for each row.
    centre_frequency, bandwidth
        `fc` and `B` [Hz], `B < 2 fc`.
    sample_rate
        Samples per second [Hz], at least `B`.
    rng
        The only source of chance.

    Returns
    -------
    EchoPair
        With `truth.delay` of the shape (rows, 1).

    Raises
    ------
    ValueError
        For a value outside these limits.
    """
    coherence = checks.within("coherence", coherence, 0.0, 1.0)
    patch = Patch(shape, delay, centre_frequency, bandwidth, sample_rate)
    checks.generator(rng)
    primary = patch.band.noise(patch.rows, rng)
    secondary = coherence * primary + np.sqrt((1 - coherence) * (1 + coherence)) * patch.band.noise(patch.rows, rng)
    return patch.pair(primary, secondary)


class Patch:
    """The frame of a homogeneous patch, its values checked: how many rows, their band and their delays.

    Parameters are those of `speckle_pair`; `delays` [s] have the shape (rows, 1).
    """

    def __init__(
        self, shape: tuple[int, int], delay: ArrayLike, centre_frequency: float, bandwidth: float, sample_rate: float
    ) -> None:
        self.rows, samples = (checks.count(name, n) for name, n in zip(("rows", "samples"), shape, strict=True))
        self.centre_frequency = checks.positive("centre_frequency", centre_frequency, "Hz")
        self.band = Band(TimeGrid(samples, sample_rate), bandwidth)
        delays = np.asarray(delay, dtype=float)
        checks.finite_samples("delay", delays)
        if delays.size not in (1, self.rows):
            raise ValueError(f"delay has {delays.size} values; it must have 1, or one for each of the {self.rows} rows")
        self.delays = np.broadcast_to(delays.reshape(-1, 1), (self.rows, 1))

    def pair(self, primary: Complex, secondary: Complex, likelihood_ratio: Real | None = None) -> EchoPair:
        """The echoes of two spectra, (rows, bins), the secondary delayed; it is overwritten."""
        secondary *= np.exp(-2j * np.pi * (self.centre_frequency + self.band.frequencies) * self.delays)
        return EchoPair(
            primary=self.band.series(primary),
            secondary=self.band.series(secondary),
            sample_rate=self.band.grid.sample_rate,
            centre_frequency=self.centre_frequency,
            bandwidth=self.band.bandwidth,
            truth=Truth(delay=self.delays),
            circular=True,
            likelihood_ratio=likelihood_ratio,
        )
