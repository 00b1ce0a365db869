"""From a scene and a sonar to a registered pair of echoes."""

import numpy as np
import scipy.fft

from sim import checks
from sim.band import Band, Complex, TimeGrid
from sim.echo_pair import EchoPair
from sim.echoes import scene_spectra
from sim.geometry import Geometry, travel_times
from sim.levels import range_gain
from sim.registration import register
from sim.scene import Scene
from sim.sonar import Sonar
from sim.visibility import truth

OVERSAMPLING = 4 / 3
"""Sample rate over bandwidth: leaves the registered band, which moves by up to `fc D H / (2 r^2)`, inside the Nyquist
frequency."""

GUARD = 64
"""Empty resolution cells before and after the scene, so that its ends do not meet on the circular grid."""


def simulate(
    scene: Scene,
    sonar: Sonar,
    *,
    rng: np.random.Generator,
    snr: float | None = None,
    rows: int = 1,
    scatterers_per_resolution: float = 8.0,
) -> EchoPair:
    """Simulate what both receivers hear of a scene, registered to the reference plane.

    Off-grid scatterers along the whole seabed, walls included, with shadow from transmitter and receivers, exact
    delays, and band-limited noise that is added before registration.

    Where the scene has a sediment, the sonar equation says how strong its echoes are: noise has unit mean power in each
    receiver, and the echoes the power that follows from range, beams, sediment and local grazing angle. Where it has
    none, the seabed scatters alike everywhere, the flat floor has unit mean power at every range, and `snr` sets the
    noise.

    The band is flat, so that its pulse has side lobes without end: next to a seabed that is 20 dB brighter or more, as
    at the null of a beam, what is measured is theirs. By the null of `hisas-1032`, at 34.7 m of ground range, the
    coherence over coarse sand is .09 where noise and geometry leave .95; at the near end of its swath, 42 m, it is .991
    for .993.

    Parameters
    ----------
    scene, sonar
        What is seen, and by what; the whole scene must lie below the sonar.
    rng
        The only source of chance. The same seed gives the same speckle with and without noise.
    snr
        For a scene without sediment: signal-to-noise ratio of the flat floor in each receiver [dB]; None for no noise.
    rows
        Rows along track, of independent speckle and noise.
    scatterers_per_resolution
        Scatterers in a length `c / (2 B)` of seabed, at least 1. Speckle is Gaussian at any density; a low one
        leaves the power uneven from cell to cell.

    Returns
    -------
    EchoPair
        Circular, with truth and geometry. Samples before and after the scene lie in shadow.

    Raises
    ------
    ValueError
        Where the sonar is not above the scene, a number is outside its limits, or `snr` is given with a sediment.
    """
    checks.generator(rng)
    checks.count("rows", rows)
    if snr is not None:
        checks.finite("snr", snr, "dB")
        if scene.sediment is not None:
            raise ValueError(f"snr is {snr:g} dB; it must be left out for a scene whose sediment gives the levels")
    if checks.finite("scatterers_per_resolution", scatterers_per_resolution) < 1:
        raise ValueError(f"scatterers_per_resolution is {scatterers_per_resolution:g}; it must be at least 1")
    if sonar.altitude <= scene.highest:
        raise ValueError(
            f"altitude is {sonar.altitude:g} m; it must be above the highest point of the scene, {scene.highest:g} m"
        )
    grid = time_grid(scene, sonar)
    band = Band(grid, sonar.bandwidth)
    spectra = scene_spectra(scene, sonar, band, rows, scatterers_per_resolution, rng)
    if scene.sediment is None:
        primary, secondary = _with_noise(spectra, band, sonar, snr, rng)
    else:
        primary, secondary = _in_noise(spectra, band, sonar, rng)
    geometry = Geometry(sonar, grid.start)
    return EchoPair(
        primary=primary,
        secondary=secondary,
        sample_rate=grid.sample_rate,
        centre_frequency=sonar.centre_frequency,
        bandwidth=sonar.bandwidth,
        truth=truth(scene, geometry, grid.times),
        geometry=geometry,
        circular=True,
    )


def _with_noise(
    spectra: tuple[Complex, Complex], band: Band, sonar: Sonar, snr: float | None, rng: np.random.Generator
) -> tuple[Complex, Complex]:
    """Series of echoes as strong as they are, and noise `snr` below unit power, if any."""
    primary, secondary = spectra
    if snr is not None:
        amplitude = 10 ** (-snr / 20)
        primary += amplitude * band.noise(len(primary), rng)
        secondary += amplitude * band.noise(len(secondary), rng)
    return band.series(primary), register(secondary, band, sonar)


def _in_noise(
    spectra: tuple[Complex, Complex], band: Band, sonar: Sonar, rng: np.random.Generator
) -> tuple[Complex, Complex]:
    """Series of echoes that lose strength on their way, and noise of unit power."""
    gain = range_gain(sonar, band.grid.times)
    rows = len(spectra[0])
    primary = gain * band.series(spectra[0]) + band.series(band.noise(rows, rng))
    secondary = gain * register(spectra[1], band, sonar) + register(band.noise(rows, rng), band, sonar)
    return primary, secondary


def time_grid(scene: Scene, sonar: Sonar) -> TimeGrid:
    """The circular grid that holds all echoes of a scene at both receivers, with a guard on either side.

    Its length is rounded up to one that the FFT likes, and its period follows.
    """
    sample_rate = OVERSAMPLING * sonar.bandwidth
    first, last = _first_and_last_echo(scene, sonar)
    guard = GUARD / sonar.bandwidth
    start = max(first - guard, 0.0)
    samples = scipy.fft.next_fast_len(int(np.ceil((last + guard - start) * sample_rate)))
    return TimeGrid(samples, sample_rate, start)


def _first_and_last_echo(scene: Scene, sonar: Sonar) -> tuple[float, float]:
    corners = scene.profile
    at_primary, at_secondary = travel_times(sonar, corners[:, 0], corners[:, 1])
    # A slope may come nearer between its corners than at them, but never nearer than its crest is deep.
    nearest = 2 * np.hypot(corners[0, 0], sonar.altitude - scene.highest) / sonar.sound_speed
    return min(float(nearest), float(at_primary.min())), float(at_secondary.max())
