"""Homogeneous patches of speckle: two series of a stated coherence and delay."""

import numpy as np
from numpy.typing import ArrayLike

from sim import checks
from sim.band import Band, TimeGrid
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
    The bins are independent looks; both series have unit mean power.

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
    rows, samples = (checks.count(name, n) for name, n in zip(("rows", "samples"), shape, strict=True))
    coherence = checks.within("coherence", coherence, 0.0, 1.0)
    checks.positive("centre_frequency", centre_frequency, "Hz")
    grid = TimeGrid(samples, sample_rate)
    band = Band(grid, bandwidth)
    delays = np.asarray(delay, dtype=float)
    checks.finite_samples("delay", delays)
    if delays.size not in (1, rows):
        raise ValueError(f"delay has {delays.size} values; it must have 1, or one for each of the {rows} rows")
    delays = np.broadcast_to(delays.reshape(-1, 1), (rows, 1))
    checks.generator(rng)

    primary = band.noise(rows, rng)
    secondary = coherence * primary + np.sqrt((1 - coherence) * (1 + coherence)) * band.noise(rows, rng)
    secondary *= np.exp(-2j * np.pi * (centre_frequency + band.frequencies) * delays)
    return EchoPair(
        primary=band.series(primary),
        secondary=band.series(secondary),
        sample_rate=sample_rate,
        centre_frequency=centre_frequency,
        bandwidth=bandwidth,
        truth=Truth(delay=delays),
        circular=True,
    )
