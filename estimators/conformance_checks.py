"""The checks of the conformance suite: each tries one thing, and says in words where it is wrong."""

from collections.abc import Callable, Iterator
from copy import deepcopy
from dataclasses import dataclass, fields, replace

import numpy as np
import scipy.fft
from numpy.typing import NDArray

from estimators.estimate import DelayEstimate, Estimator
from estimators.windows import FixedWindow
from sim import EchoPair, speckle_pair
from sim.band import Real

NUMBERS = tuple(field.name for field in fields(DelayEstimate) if field.name != "valid")
SHARES = ("coherence", "debiased_coherence", "wrap_error_probability", "quality")
CENTRE_FREQUENCY, BANDWIDTH = 100e3, 30e3
WRAP = 1 / CENTRE_FREQUENCY

SAME = 1e-6
"""Difference of delays that rounding may make [wraps]; 1e-3 in single precision."""


class Malformed(Exception):
    """What is wrong with the form of an estimate, a sentence each."""


@dataclass(frozen=True)
class Trial:
    """An estimator, the speckle that it is tried on, and the window that it was made with, where that is known."""

    estimator: Estimator
    shape: tuple[int, int]
    window: FixedWindow | None = None

    def echoes(
        self, coherence: float = 0.95, delay: float = 0.2, *, shape: tuple[int, int] | None = None, seed: int = 1
    ) -> EchoPair:
        """The same speckle every time, at a delay in wraps."""
        pair = speckle_pair(
            shape or self.shape,
            coherence=coherence,
            delay=delay * WRAP,
            centre_frequency=CENTRE_FREQUENCY,
            bandwidth=BANDWIDTH,
            sample_rate=4 / 3 * BANDWIDTH,
            rng=np.random.default_rng(seed),
        )
        return replace(pair, truth=None)

    def estimate(self, pair: EchoPair) -> DelayEstimate:
        """What the estimator gives, in the state that it came in; Malformed where that has not the form."""
        estimate = self.as_it_came().estimate(pair)
        wrong = list(form(estimate, pair.shape))
        if wrong:
            raise Malformed(*wrong)
        return estimate

    def as_it_came(self) -> Estimator:
        """A copy of the estimator, or itself where it cannot be copied."""
        try:
            return deepcopy(self.estimator)
        except Exception:
            return self.estimator


def form(estimate: DelayEstimate, shape: tuple[int, int]) -> Iterator[str]:
    """What keeps an estimate of a pair of a shape from being one."""
    absent = [name for name in (*NUMBERS, "valid") if not hasattr(estimate, name)]
    if absent:
        yield f"it gives a {type(estimate).__name__} without {', '.join(absent)}; it must give a DelayEstimate"
        return
    for name in (*NUMBERS, "valid"):
        array = getattr(estimate, name)
        if not isinstance(array, np.ndarray):
            yield f"{name} is of type {type(array).__name__}; it must be an array"
        elif array.shape != shape:
            yield f"{name} has the shape {array.shape}; it must have that of the pair, {shape}"
        elif (array.dtype != np.bool_) if name == "valid" else (array.dtype.kind != "f"):
            yield f"{name} is of type {array.dtype}; it must be {'bool' if name == 'valid' else 'float'}"


def _limits(estimate: DelayEstimate) -> Iterator[str]:
    valid = estimate.valid
    for name in NUMBERS:
        yield from _some(~np.isfinite(getattr(estimate, name)) & valid, f"{name} is not finite but valid")
    for name in SHARES:
        value = getattr(estimate, name)
        yield from _some(valid & ((value < 0) | (value > 1)), f"{name} is not between 0 and 1")
    yield from _some(valid & ~(estimate.delay_std > 0), "delay_std is not above 0")
    yield from _some(valid & (np.abs(estimate.phase) > np.pi * (1 + 1e-12)), "phase is not within -pi and pi")


def an_ordinary_pair(trial: Trial) -> Iterator[str]:
    """That it gives what an estimate is; without that, nothing else can be tried."""
    estimate = trial.estimate(trial.echoes())
    if not estimate.valid.any():
        yield "no sample of speckle at a coherence of .95 is valid"
    yield from _limits(estimate)


def _a_coherence_of_0_and_1(trial: Trial) -> Iterator[str]:
    for coherence in (0.0, 1.0):
        pair = trial.echoes(coherence, 0.0)
        yield from (f"at a coherence of {coherence:g}, {said}" for said in _limits(trial.estimate(pair)))


def _another_shape(trial: Trial) -> Iterator[str]:
    rows, samples = trial.shape
    pair = trial.echoes(shape=(rows + 1, samples + 1))
    yield from (f"of {rows + 1} x {samples + 1} samples, {said}" for said in _limits(trial.estimate(pair)))


def _a_record_that_is_not_periodic(trial: Trial) -> Iterator[str]:
    estimate = trial.estimate(replace(trial.echoes(), circular=False))
    yield from (f"of a record that is not periodic, {said}" for said in _limits(estimate))


def _silence(trial: Trial) -> Iterator[str]:
    pair = trial.echoes()
    nothing = np.zeros_like(pair.primary)
    cases = {
        "the primary is silent": replace(pair, primary=nothing),
        "the secondary is silent": replace(pair, secondary=nothing),
        "both receivers are silent": replace(pair, primary=nothing, secondary=nothing),
    }
    for said, silent in cases.items():
        yield from _some(trial.estimate(silent).valid, f"it is valid where {said}")
    later = np.arange(pair.shape[1]) >= pair.shape[1] // 2
    padded = replace(pair, primary=np.where(later, 0, pair.primary), secondary=np.where(later, 0, pair.secondary))
    yield from _some(trial.estimate(padded).valid & later, "it is valid where both receivers are silent from a time on")


def _missing_samples(trial: Trial) -> Iterator[str]:
    pair = trial.echoes()
    missing = np.zeros(pair.shape, dtype=np.bool_)
    missing[pair.shape[0] // 3, pair.shape[1] // 3 : pair.shape[1] // 2] = True
    primary, secondary = (np.where(missing, 0, series) for series in (pair.primary, pair.secondary))
    estimate = trial.estimate(replace(pair, primary=primary, secondary=secondary, missing=missing))
    yield from _some(estimate.valid & missing, "it is valid where samples are missing (pair.missing)")
    yield from (f"where samples are missing, {said}" for said in _limits(estimate))


def _receivers_swapped(trial: Trial) -> Iterator[str]:
    pair = trial.echoes()
    there = trial.estimate(pair)
    back = trial.estimate(replace(pair, primary=pair.secondary, secondary=pair.primary))
    yield from _some(_apart(there.delay, -back.delay) & there.valid, "receivers swapped do not negate the delay")
    yield from _some(there.valid != back.valid, "receivers swapped change what is valid")


def _a_common_gain_or_phase(trial: Trial) -> Iterator[str]:
    pair = trial.echoes()
    plain = trial.estimate(pair)
    for name, factor in (("gain of 1e6", 1e6), ("gain of 1e-6", 1e-6), ("phase of 1 rad", np.exp(1j))):
        changed = trial.estimate(replace(pair, primary=factor * pair.primary, secondary=factor * pair.secondary))
        yield from _unlike(plain, changed, f"a common {name} changes")
        yield from _some(
            ~np.isclose(plain.coherence, changed.coherence, rtol=0, atol=1e-6) & plain.valid,
            f"a common {name} changes the coherence",
        )


def _an_added_delay(trial: Trial) -> Iterator[str]:
    pair = trial.echoes(coherence=1.0, delay=0.0)
    frequencies = CENTRE_FREQUENCY + scipy.fft.fftfreq(trial.shape[1], 1 / pair.sample_rate)
    before = trial.estimate(pair)
    for added in (-0.2, 0.2):
        spectrum = scipy.fft.fft(pair.secondary, axis=-1) * np.exp(-2j * np.pi * frequencies * added * WRAP)
        after = trial.estimate(replace(pair, secondary=scipy.fft.ifft(spectrum, axis=-1)))
        both = before.valid & after.valid
        moved = float(np.median((after.delay - before.delay)[both])) / WRAP if both.any() else np.nan
        # A NaN is a finding.
        if not abs(moved - added) < 0.02:
            yield f"a delay of {added:g} wraps more moves the median estimate by {moved:.3g} wraps"


def _single_precision(trial: Trial) -> Iterator[str]:
    pair = trial.echoes()
    single = replace(pair, primary=pair.primary.astype(np.complex64), secondary=pair.secondary.astype(np.complex64))
    double, found = trial.estimate(pair), trial.estimate(single)
    apart = _apart(double.delay, found.delay, 1e3 * SAME) & double.valid & found.valid
    # A single pixel may be so dark that its wrap hangs on rounding.
    if apart.mean() > 0.01:
        yield from _some(apart, "single precision gives another delay")


def _another_layout_in_memory(trial: Trial) -> Iterator[str]:
    pair = trial.echoes()
    turned = replace(pair, primary=np.asfortranarray(pair.primary), secondary=np.repeat(pair.secondary, 2, 1)[:, ::2])
    yield from _unlike(trial.estimate(pair), trial.estimate(turned), "another layout of the arrays in memory changes")


def _its_input(trial: Trial) -> Iterator[str]:
    pair, untouched = trial.echoes(), trial.echoes()
    trial.as_it_came().estimate(pair)
    for name in ("primary", "secondary"):
        if not np.array_equal(getattr(pair, name), getattr(untouched, name)):
            yield f"it changes the {name} that it is given"


def _the_same_pair_again(trial: Trial) -> Iterator[str]:
    pair = trial.echoes()
    once = trial.estimate(pair)
    if not _equal(once, trial.estimate(pair)):
        yield "the same pair gives another estimate when it is asked again"
        return
    used = trial.as_it_came()
    if any(isinstance(held, np.random.Generator) for held in getattr(used, "__dict__", {}).values()):
        return
    used.estimate(trial.echoes(seed=2))
    if not _equal(once, used.estimate(pair)):
        yield "what it gives depends on the pairs that it had before"


def _rows_beyond_its_window(trial: Trial) -> Iterator[str]:
    if trial.window is None:
        return
    rows = trial.window.rows
    shape = max(trial.shape[0], 2 * rows + 2), trial.shape[1]
    pair, other = trial.echoes(shape=shape), trial.echoes(shape=shape, seed=2)
    primary = np.concatenate([other.primary[:1], pair.primary[1:]])
    secondary = np.concatenate([other.secondary[:1], pair.secondary[1:]])
    beyond = np.broadcast_to(np.arange(shape[0])[:, None] > rows, shape)
    changed = trial.estimate(replace(pair, primary=primary, secondary=secondary))
    yield from _unlike(trial.estimate(pair), changed, f"a row more than {rows} rows away changes", beyond)


CHECKS: dict[str, Callable[[Trial], Iterator[str]]] = {
    check.__name__.strip("_").replace("_", " "): check
    for check in (
        an_ordinary_pair,
        _a_coherence_of_0_and_1,
        _another_shape,
        _a_record_that_is_not_periodic,
        _silence,
        _missing_samples,
        _receivers_swapped,
        _a_common_gain_or_phase,
        _an_added_delay,
        _single_precision,
        _another_layout_in_memory,
        _its_input,
        _the_same_pair_again,
        _rows_beyond_its_window,
    )
}
"""What is tried, by name; the first is what all others need."""


def _apart(one: Real, other: Real, limit: float = SAME) -> NDArray[np.bool_]:
    """Where delays differ by more than a limit in wraps, or are not numbers."""
    apart: NDArray[np.bool_] = ~(np.abs(one - other) <= limit * WRAP)
    return apart


def _unlike(
    one: DelayEstimate, other: DelayEstimate, said: str, where: NDArray[np.bool_] | None = None
) -> Iterator[str]:
    """Where a change that must not matter changes the delay, or what is valid."""
    told = np.ones(one.valid.shape, dtype=np.bool_) if where is None else where
    yield from _some(_apart(one.delay, other.delay) & one.valid & told, f"{said} the delay")
    yield from _some((one.valid != other.valid) & told, f"{said} what is valid")


def _equal(one: DelayEstimate, other: DelayEstimate) -> bool:
    return all(np.array_equal(getattr(one, n), getattr(other, n), equal_nan=True) for n in (*NUMBERS, "valid"))


def _some(where: NDArray[np.bool_], said: str) -> Iterator[str]:
    if where.any():
        first = tuple(int(i) for i in np.argwhere(where)[0])
        yield f"{said} at {int(where.sum())} of {where.size} samples, the first at {first}"
