"""From a scene and a sonar to a registered pair of echoes."""

from collections.abc import Iterator
from typing import Any

import numpy as np
from joblib import Parallel, delayed
from numpy.typing import NDArray

from sim import checks
from sim.band import Complex
from sim.costs import DIFFERENT, SAME
from sim.echo_pair import EchoPair, Truth
from sim.echoes import scatterer_spectra
from sim.heard import heard_at
from sim.listening import Listening
from sim.passes import recorded
from sim.plan import Plan, plan
from sim.scene import Scene
from sim.section import Section
from sim.snr_profile import SnrProfile
from sim.sonar import Sonar
from sim.streams import Streams, Use
from sim.targets import add_targets
from sim.truth import stacked, truth, truth_in_order
from sim.warp import warped_series


def simulate(
    scene: Scene,
    sonar: Sonar,
    *,
    rng: np.random.Generator,
    snr: float | SnrProfile | None = None,
    rows: int = 1,
    first_row: int = 0,
    row_spacing: float | None = None,
    required: Plan | None = None,
) -> EchoPair:
    """Simulate what both receivers hear of a scene, registered to the reference plane.

    `sim.plan` finds out what the scene requires, and no more is modelled: in full, off-grid scatterers along the whole
    seabed, walls included, with shadow from transmitter and receivers and exact delays; always, band-limited noise in
    each receiver.

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
        For a scene without sediment: signal-to-noise ratio of the flat floor in each receiver [dB], or its profile over
        range; None for no noise.
    rows, first_row
        Rows along track, and the number of the first; that at along-track place 0 has the number 0. A row is the same
        whatever others are simulated with it.
    row_spacing
        Their distance [m]. By default the along-track resolution of the sonar, where speckle and noise of rows are
        independent; at less, neighbours are alike (`sim.AlongTrack`).
    required
        What to model; by default what `sim.plan` says of these rows. A plan also says their distance.

    Returns
    -------
    EchoPair
        Circular, with truth and geometry. Samples before and after the scene lie in shadow.

    Raises
    ------
    ValueError
        Where the sonar is not above the scene, a number is outside its limits, `snr` is given with a sediment, or a
        warp is asked for of a seabed that is heard several parts at a time.
    """
    streams = Streams.drawn(checks.generator(rng))
    numbers = range(first_row, first_row + checks.count("rows", rows))
    listening = Listening(scene, sonar, _required(scene, sonar, snr, numbers, row_spacing, required), snr)
    return _block(listening, numbers, streams)


def echo_blocks(
    scene: Scene,
    sonar: Sonar,
    *,
    rng: np.random.Generator,
    snr: float | SnrProfile | None = None,
    rows: int,
    row_spacing: float | None = None,
    required: Plan | None = None,
    block: int = 256,
    jobs: int = 1,
) -> Iterator[EchoPair]:
    """Simulate a scene of any length along track, block by block.

    The blocks after one another are `simulate(...)` of all rows, to the last bit, whatever their size and the number of
    jobs; no more than two blocks a job are held at a time.

    Parameters
    ----------
    scene, sonar, rng, snr, rows, row_spacing, required
        As for `simulate`.
    block
        Rows in a block.
    jobs
        Threads that simulate blocks.

    Yields
    ------
    EchoPair
        In order; the last may be short.

    Raises
    ------
    ValueError
        As `simulate`.
    """
    streams = Streams.drawn(checks.generator(rng))
    numbers = range(checks.count("rows", rows))
    listening = Listening(scene, sonar, _required(scene, sonar, snr, numbers, row_spacing, required), snr)
    checks.count("block", block)
    blocks = (range(start, min(start + block, rows)) for start in range(0, rows, block))
    work = (delayed(_block)(listening, numbers, streams) for numbers in blocks)
    threads = checks.count("jobs", jobs)
    yield from Parallel(n_jobs=threads, backend="threading", return_as="generator", pre_dispatch="n_jobs")(work)


def _required(
    scene: Scene,
    sonar: Sonar,
    snr: float | SnrProfile | None,
    rows: range,
    row_spacing: float | None,
    required: Plan | None,
) -> Plan:
    if snr is not None:
        given = "given over range" if isinstance(snr, SnrProfile) else f"{checks.finite('snr', snr, 'dB'):g} dB"
        if scene.sediment is not None:
            raise ValueError(f"snr is {given}; it must be left out for a scene whose sediment gives the levels")
    if required is None:
        return plan(scene, sonar, snr=snr, rows=len(rows), first_row=rows.start, row_spacing=row_spacing)
    if row_spacing is not None:
        raise ValueError(f"row_spacing is {row_spacing:g} m; it must be left out where a plan says it")
    return required


def _block(listening: Listening, numbers: range, streams: Streams) -> EchoPair:
    """Some rows of a scene."""
    plan = listening.plan
    halo = plan.along_track.halo
    raw = range(numbers.start - halo, numbers.stop + halo)
    series = np.empty((2, len(raw), plan.grid.samples), dtype=np.complex64 if plan.single else np.complex128)
    truths: list[Truth] = []
    for some, sections in _batches(listening, raw):
        _receive(listening, sections, some, streams, series[:, some.start - raw.start : some.stop - raw.start])
        found = truth_in_order if plan.delays == "warp" and not plan.shadow else truth
        truths += [
            found(section.profile, listening.geometry, plan.grid.times, section.heard)
            for row, section in zip(some, sections, strict=False)
            if row in numbers or (plan.sections == "one" and not truths)
        ]
    primary, secondary = (plan.along_track.gather(channel) for channel in series)
    add_targets(primary, secondary, listening, numbers)
    return EchoPair(
        primary=primary,
        secondary=secondary,
        sample_rate=plan.grid.sample_rate,
        centre_frequency=listening.sonar.centre_frequency,
        bandwidth=listening.sonar.bandwidth,
        truth=truths[0] if plan.sections == "one" else stacked(truths),
        geometry=listening.geometry,
        circular=True,
        row_spacing=plan.along_track.spacing,
        row_looks=plan.along_track.looks,
    )


def _batches(listening: Listening, rows: range) -> Iterator[tuple[range, list[Section]]]:
    """Rows that are transformed together, and the one section that all have, or each its own."""
    plan, sonar = listening.plan, listening.sonar

    def section(row: int) -> Section:
        profile = listening.scene.profile(row * plan.along_track.spacing)
        return Section(profile, heard_at(profile, sonar, plan.grid.times, sonar.altitude, shadow=plan.shadow))

    only, most = ([section(0)], SAME) if plan.sections == "one" else ([], DIFFERENT)
    for start in range(rows.start, rows.stop, most):
        some = range(start, min(start + most, rows.stop))
        yield some, only or [section(row) for row in some]


def _receive(
    listening: Listening, sections: list[Section], rows: range, streams: Streams, series: NDArray[Any]
) -> None:
    """Write registered series of rows, echoes and noise, to an array of shape (2, rows, samples)."""
    band, gain = listening.band, listening.gain
    warps = listening.plan.delays == "warp"
    echoes = (
        warped_series(listening, sections, rows, streams) if warps else _scattered(listening, sections, rows, streams)
    )
    if listening.noise > 0:
        amplitude = listening.noise * np.sqrt(band.weights / band.weights.sum())
        drawn = streams.gaussian(Use.NOISE, rows, np.tile(amplitude, 2)).reshape(len(rows), 2, -1)
        below, above = np.ascontiguousarray(drawn.swapaxes(0, 1))
        # Beside a warp it is registered but for the stretch of time, as the echoes are.
        noises = band.series(below), band.series(above) if warps else listening.registration.envelope(above)
    else:
        noises = (np.zeros((len(rows), gain.size), dtype=np.complex128),) * 2
    turns = np.ones(gain.size, dtype=np.complex128), listening.registration.turn
    for channel, of_receiver in zip(series, zip(echoes, noises, turns, strict=True), strict=True):
        echo, noise, turn = of_receiver
        for row in range(len(rows)):
            recorded(echo[row], gain, noise[row], turn, channel[row])


def _scattered(listening: Listening, sections: list[Section], rows: range, streams: Streams) -> tuple[Complex, Complex]:
    """Noise-free series of scatterers in rows at both receivers, the secondary before the carrier turns it."""
    alike = [rows] if len(sections) == 1 else [range(row, row + 1) for row in rows]
    spectra = [
        scatterer_spectra(listening, section.profile, some, streams)
        for section, some in zip(sections, alike, strict=True)
    ]
    below, above = (np.concatenate(channel) for channel in zip(*spectra, strict=True))
    return listening.band.series(below), listening.registration.envelope(above)
