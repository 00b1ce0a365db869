"""One block of trials: the same echoes to every estimator, and the sums of their errors."""

from collections.abc import Mapping, Sequence
from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike

from estimators import (
    CombinedNeighbours,
    CrossCorrelation,
    Estimator,
    FullBandPhaseSlope,
    MaximumLikelihood,
    SplitSpectrum,
    TwoWindow,
    bounds,
)
from estimators.posterior import Looks
from sim import EchoPair, Sonar
from sim.band import Real
from studies.attempt import Attempt, attempt
from studies.design import Task
from studies.measurement import Block, Failure, Measurement
from studies.method import Method
from studies.moments import of_errors
from studies.seeds import generator
from studies.world import Reading, World

FACTS = (
    "looks",
    "coherence",
    "snr_db",
    "relative_bandwidth",
    "wrap",
    "predicted_wrap_rate",
    "predicted_delay_std",
    "crlb",
    "ziv_zakai",
)
"""What `expected` says."""

NORMAL_95 = 1.959963984540054
"""Half the width of a 95 % interval of a normal distribution, in standard deviations."""


def echoes(task: Task, block_trials: int, seed: int) -> EchoPair:
    """The echoes of a block; a short block has the first trials of a whole one."""
    point, world = task.point, task.point.world
    rng = generator(seed, point.echoes, 0 if world.onward else task.block)
    pair = world.simulate(point.sonar, block_trials, rng, task.block * block_trials)
    return pair if task.trials == block_trials else pair.rows(slice(0, world.shape(point.sonar, task.trials)[0]))


def apply(method: Method, pair: EchoPair, task: Task, seed: int) -> tuple[Estimator, Attempt]:
    """An estimator on the echoes of a block, with random numbers of its own if it takes any."""
    estimator = method.build(generator(seed, task.point.echoes, task.block, method.stream()))
    return estimator, attempt(estimator, pair, method.window)


def measure(task: Task, methods: Sequence[Method], block_trials: int, seed: int) -> Block:
    """Simulate one block and apply estimators to it; always the same numbers, but for the times.

    Parameters
    ----------
    task
        The block.
    methods
        The estimators.
    block_trials
        Trials of a whole block.
    seed
        Root of all random numbers.
    """
    point = task.point
    pair = echoes(task, block_trials, seed)
    measurements, traces = [], point.world.traces(pair) if task.block == 0 or point.world.onward else {}
    for method in methods:
        estimator, made = apply(method, pair, task, seed)
        if traces:
            traces[" ".join(method.labels)] = point.world.trace(pair, made.estimate)
        window = method.window.on(pair)
        readings = point.world.read(pair, window, made.estimate)
        facts = (
            expected_over_range(estimator, readings, point.sonar)
            if point.world.ranged
            else [expected(estimator, window.looks(pair), point.world, point.sonar)] * len(readings)
        )
        measurements += [
            _measured(method, reading, len(readings), known, made, pair)
            for reading, known in zip(readings, facts, strict=True)
        ]
    return Block(measurements, traces)


def _measured(
    method: Method, reading: Reading, regions: int, facts: Mapping[str, float], made: Attempt, pair: EchoPair
) -> Measurement:
    """Sum up the errors of an attempt in one region; an error that is not finite is a failure."""
    estimate, wrap = made.estimate, facts["wrap"]
    moments, batches = of_errors(
        np.where(reading.counted, reading.errors / wrap, np.nan),
        np.abs(reading.errors) > 0.5 / pair.bandwidth,
        half_width=NORMAL_95 * reading.of(estimate.delay_std) / wrap,
        claimed=reading.of(estimate.wrap_error_probability),
        place=np.arange(pair.shape[0])[reading.rows] / pair.shape[0],
        weights=1.0 if pair.likelihood_ratio is None else pair.likelihood_ratio[reading.rows, None],
    )
    failed = reading.counted & ~np.isfinite(reading.errors)
    said = dict(made.raised)
    rows = np.arange(pair.shape[0])[reading.rows]
    failures = [Failure(int(row), said.get(int(row), "not a finite number")) for row in rows[failed.any(axis=1)]]
    return Measurement(
        *method.labels,
        region=reading.region,
        regions=regions,
        facts=facts,
        moments=moments,
        # One range by itself is not compared between estimators.
        batches=batches[:0] if reading.facts else batches,
        failures=int(failed.sum()),
        failed=failures,
        flagged=int(np.sum(reading.counted & ~reading.of(estimate.valid) & ~failed)),
        seconds_per_pixel=made.seconds / pair.primary.size,
    )


def expected(estimator: Estimator, looks: Looks, world: World, sonar: Sonar) -> Mapping[str, float]:
    """What theory says of an estimator, in columns of the table.

    `crlb` is the coherent wideband bound whatever the estimator, `ziv_zakai` the bound with wraps for a delay within
    `1 / B` of zero [s]; `predicted_wrap_rate` and `predicted_delay_std` [s] are those of the estimator's kind, and
    `wrap` the delay of one [s]. Where the world has no one coherence, or looks vary with time, no one number can be
    said: they and what follows from them are NaN.
    """
    looks = float(np.max(looks)) if np.ptp(looks) == 0 else np.nan
    fc, ratio, coherence = sonar.centre_frequency, sonar.relative_bandwidth, world.true_coherence
    known = {
        "looks": looks,
        "coherence": coherence,
        "snr_db": world.snr_db,
        "relative_bandwidth": ratio,
        "wrap": sonar.wrap,
    }
    if np.isnan(coherence):
        return {**dict.fromkeys(FACTS, np.nan), **known}
    return {
        **known,
        "predicted_wrap_rate": float(predicted_wrap_rate(estimator, looks, coherence, sonar)),
        "predicted_delay_std": float(predicted_delay_std(estimator, looks, coherence, sonar)),
        "crlb": float(bounds.coherent_delay_crlb(looks, coherence, fc, sonar.bandwidth)),
        "ziv_zakai": _ziv_zakai(looks, coherence, fc, sonar.bandwidth),
    }


def expected_over_range(estimator: Estimator, readings: Sequence[Reading], sonar: Sonar) -> list[Mapping[str, float]]:
    """The same for regions of one range each, with their own facts; without `ziv_zakai`, which would take long."""
    looks, coherence = (np.array([reading.facts[name] for reading in readings]) for name in ("looks", "coherence"))
    over_range = {
        "predicted_wrap_rate": predicted_wrap_rate(estimator, looks, coherence, sonar),
        "predicted_delay_std": predicted_delay_std(estimator, looks, coherence, sonar),
        "crlb": bounds.coherent_delay_crlb(looks, coherence, sonar.centre_frequency, sonar.bandwidth),
    }
    alike = {"relative_bandwidth": sonar.relative_bandwidth, "wrap": sonar.wrap}
    return [
        {
            **dict.fromkeys(FACTS, np.nan),
            **alike,
            **{name: float(values[number]) for name, values in over_range.items()},
            **reading.facts,
        }
        for number, reading in enumerate(readings)
    ]


def predicted_wrap_rate(estimator: Estimator, looks: ArrayLike, coherence: ArrayLike, sonar: Sonar) -> Real:
    """Wrap-error rate of an estimator of its kind.

    Maximum likelihood, a peak that its phase refines, the split spectrum; for all others that of the envelope's peak.
    Of two windows it is that of the one for the wrap, and of neighbours that are combined NaN: nothing tells.
    """
    if isinstance(estimator, TwoWindow):
        return predicted_wrap_rate(estimator.wrap, looks, coherence, sonar)
    if isinstance(estimator, CombinedNeighbours):
        return np.full(np.broadcast_shapes(np.shape(looks), np.shape(coherence)), np.nan)
    ratio = sonar.relative_bandwidth
    search = getattr(estimator, "search", None)
    # A search in height is another delay for every record.
    wraps = search * sonar.centre_frequency if isinstance(search, float | int) else None
    if isinstance(estimator, SplitSpectrum):
        share = (estimator.sub_bandwidth or sonar.bandwidth / 3) / sonar.bandwidth
        return bounds.split_spectrum_wrap_error_probability(looks, coherence, ratio, sub_band_share=share)
    if isinstance(estimator, MaximumLikelihood):
        return bounds.likelihood_wrap_error_probability(looks, coherence, ratio, wraps)
    if isinstance(estimator, CrossCorrelation | FullBandPhaseSlope) and estimator.refine:
        return bounds.cross_correlation_wrap_error_probability(looks, coherence, ratio, wraps)
    return bounds.wrap_error_probability(looks, coherence, ratio)


def predicted_delay_std(estimator: Estimator, looks: ArrayLike, coherence: ArrayLike, sonar: Sonar) -> Real:
    """Standard deviation of an estimator of its kind in the right wrap [s].

    That of the exact multilook phase where the phase refines the delay, the coherent bound for maximum likelihood, and
    the bound of the group delay for what has no phase; of single looks, a guess within a wrap at the most. NaN for what
    is made of another estimator: the looks are those of that one.
    """
    if isinstance(estimator, TwoWindow | CombinedNeighbours):
        return np.full(np.broadcast_shapes(np.shape(looks), np.shape(coherence)), np.nan)
    fc, bandwidth = sonar.centre_frequency, sonar.bandwidth
    if isinstance(estimator, MaximumLikelihood):
        return bounds.coherent_delay_crlb(looks, coherence, fc, bandwidth)
    if getattr(estimator, "refine", True):
        spread: Real = bounds.multilook_phase_std(looks, coherence) / (2 * np.pi * fc)
        return spread
    return bounds.group_delay_crlb(looks, coherence, bandwidth)


@lru_cache(maxsize=4096)
def _ziv_zakai(looks: float, coherence: float, centre_frequency: float, bandwidth: float) -> float:
    """The bound for a delay within `1 / B` of zero; the same for all estimators of a point."""
    return float(bounds.ziv_zakai_delay_std(looks, coherence, centre_frequency, bandwidth, 2 / bandwidth))
