"""What a shortcut of the simulation saves and what it costs, against the full model of the same scene."""

from collections.abc import Iterator
from itertools import pairwise
from time import process_time
from typing import NamedTuple

import numpy as np

from estimators import FixedWindow
from sim import EchoPair, Sonar
from sim.band import Complex, Real
from studies.parallel import one_thread
from studies.scene_readings import clear
from studies.swath import Swath

WINDOW = FixedWindow(1, 64)
"""Over which interferograms are summed up."""

CLUSTER = 4.0
"""Independent rows that are left out together; what the resolution makes alike lies within."""

STATISTICS = ("coherence", "delay", "level")


class Timed(NamedTuple):
    """Processor seconds a row of both models, by turns, shape (repeat,)."""

    planned: Real
    full: Real


class Comparison(NamedTuple):
    """How far the planned model is from the full one in one stretch of ground range.

    For each of `STATISTICS` the difference, planned less full, its standard error, and the tolerance of the plan.
    """

    ground_range: tuple[float, float]
    difference: Real
    error: Real
    tolerance: Real


def in_full(swath: Swath) -> Swath:
    """A scene of whose simulation nothing is left out: scatterers of exact delays and levels, shadow, every section."""
    level = "even" if swath.sediment is None else "local"
    chosen = {
        "sections": None,
        "shadow": True,
        "delays": "scatterers",
        "baseline": True,
        "level": level,
        "accuracy": 1e-12,
    }
    return swath.model_copy(update={"plan": swath.plan.model_copy(update=chosen)})


def compare(
    swath: Swath, sonar: Sonar, *, rows: int, repeats: int, parts: int, rng: np.random.Generator
) -> tuple[Timed, list[Comparison]]:
    """Simulate a scene as planned and in full by turns; measure the time and what differs.

    Where one part of the seabed is heard, and the true delay `d` is taken away from the phase, `s = secondary conj(
    primary) exp(2 pi i fc d)` is summed over windows of 64 samples of a row. The statistics of a stretch of ground
    range are its coherence at lag zero, `|sum s| / sqrt(sum |p|^2 sum |s|^2)`; the mean delay error, that of `-arg / 2
    pi` of the windows in wraps; and the mean intensity [dB]. Their standard errors are from leaving out rows, some at a
    time.

    The plan promises a relative error of at most its tolerance `t` in the spread of an estimate, and in power. The
    spread goes as `sqrt(1 - g^2) / g` with the coherence `g` (`bounds.phase_crlb`), so that the coherence may differ by
    `t g (1 - g^2)`; a mean error makes the root mean square of the spread `t` larger where it is `sqrt(2 t)` of the
    spread of the windows; power may differ by `10 log10(1 + t)`.

    Parameters
    ----------
    swath, sonar
        The scene, and what it is seen by.
    rows, repeats
        Rows of a simulation, and how often each model simulates them.
    parts
        Equal stretches of ground range.
    rng
        Source of speckle and noise, of each simulation its own.

    Returns
    -------
    Timed, list of Comparison
        Time includes planning; a comparison for each stretch where something is seen.
    """
    models, seconds = (swath, in_full(swath)), np.zeros((2, repeats))
    edges = np.linspace(*swath.ground_range, parts + 1)
    sums: tuple[list[Complex], list[Complex]] = ([], [])
    with one_thread():
        for model in models:
            # Tables and compiled code are made by the first call.
            model.simulate(sonar, 1, rng)
        for repeat in range(repeats):
            for number, model in enumerate(models):
                start = process_time()
                pair = model.simulate(sonar, rows, rng)
                seconds[number, repeat] = (process_time() - start) / rows
                sums[number].append(_sums(pair, sonar, edges))
    planned, full = (np.concatenate(of_model) for of_model in sums)
    found = [
        comparison
        for part, stretch in enumerate(pairwise(edges.tolist()))
        for comparison in _compared(planned[:, part], full[:, part], stretch, swath.plan.tolerance)
    ]
    return Timed(*seconds), found


def _sums(pair: EchoPair, sonar: Sonar, edges: Real) -> Complex:
    """Sums over windows, shape (cluster, part, 6).

    Of windows, `s`, the energies of both series, the phases of the windows' `s` and their squares.
    """
    truth, length = pair.truth, WINDOW.samples
    assert truth is not None
    count = pair.shape[1] // length
    turned = np.exp(2j * np.pi * pair.centre_frequency * np.nan_to_num(truth.delay))
    cross, first, second = (
        series[:, : count * length].reshape(len(series), count, length).sum(axis=2)
        for series in (
            pair.secondary * pair.primary.conj() * turned,
            np.abs(pair.primary) ** 2,
            np.abs(pair.secondary) ** 2,
        )
    )
    middles = slice(length // 2, count * length, length)
    slant = pair.grid.times[middles] * sonar.sound_speed / 2
    part = np.searchsorted(edges, np.sqrt(np.maximum(slant**2 - sonar.altitude**2, 0.0))) - 1
    of_part = part[:, None] == np.arange(len(edges) - 1)
    seen = np.broadcast_to(np.atleast_2d(clear(pair, WINDOW))[:, middles], cross.shape)
    phase = np.angle(cross)
    sums = np.stack([(seen * q) @ of_part for q in (np.ones(cross.shape), cross, first, second, phase, phase**2)], -1)
    starts = np.arange(0, len(sums), int(np.ceil(CLUSTER / pair.row_looks)))
    clusters: Complex = np.add.reduceat(sums, starts, axis=0)
    return clusters


def _compared(
    planned: Complex, full: Complex, ground_range: tuple[float, float], tolerance: float
) -> Iterator[Comparison]:
    """The comparison of sums, shape (cluster, 6) each; none where nothing is seen."""
    if not (planned[:, 0].any() and full[:, 0].any()):
        return
    values, errors = zip(*(_jackknifed(sums) for sums in (planned, full)), strict=True)
    coherence = values[1][0]
    windows, _, _, _, phases, squares = full.sum(axis=0).real
    spread = np.sqrt(squares / windows - (phases / windows) ** 2) / (2 * np.pi)
    allowed = [
        coherence * (1 - coherence**2) * tolerance,
        np.sqrt(2 * tolerance) * spread,
        10 * np.log10(1 + tolerance),
    ]
    yield Comparison(ground_range, values[0] - values[1], np.hypot(*errors), np.array(allowed))


def _jackknifed(sums: Complex) -> tuple[Real, Real]:
    """The `STATISTICS` of sums, and their standard errors by leaving out clusters."""
    total, count = sums.sum(axis=0), len(sums)
    without = _statistics(total - sums)
    spread = np.sqrt((count - 1) / count * np.sum((without - without.mean(axis=0)) ** 2, axis=0))
    return _statistics(total), spread


def _statistics(sums: Complex) -> Real:
    """The `STATISTICS` of sums, shape (..., 6) to (..., 3)."""
    windows, cross, first, second, phases, _ = np.moveaxis(sums, -1, 0)
    coherence = np.abs(cross) / np.sqrt(first.real * second.real)
    delay = -phases.real / windows.real / (2 * np.pi)
    level = 10 * np.log10((first + second).real / (2 * WINDOW.samples * windows.real))
    return np.stack([coherence, delay, level], axis=-1)
