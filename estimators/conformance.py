"""What every estimator must do, tried on one of your own."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

import numpy as np
import scipy.fft
from numpy.typing import NDArray

from estimators.estimate import DelayEstimate, Estimator
from sim import EchoPair, speckle_pair
from sim.band import Real

FIELDS = (
    "delay",
    "phase",
    "coherence",
    "debiased_coherence",
    "delay_std",
    "wrap_error_probability",
    "quality",
    "valid",
)
SHARES = ("coherence", "debiased_coherence", "wrap_error_probability", "quality")
CENTRE_FREQUENCY, BANDWIDTH = 100e3, 30e3
WRAP = 1 / CENTRE_FREQUENCY

SAME = 1e-6
"""Difference of delays that rounding may make [wraps]; 1e-3 in single precision."""


@dataclass(frozen=True)
class Trial:
    """An estimator and the speckle that it is tried on."""

    estimator: Estimator
    shape: tuple[int, int]

    def echoes(self, coherence: float = 0.95, delay: float = 0.2) -> EchoPair:
        """The same speckle every time, at a delay in wraps."""
        pair = speckle_pair(
            self.shape,
            coherence=coherence,
            delay=delay * WRAP,
            centre_frequency=CENTRE_FREQUENCY,
            bandwidth=BANDWIDTH,
            sample_rate=4 / 3 * BANDWIDTH,
            rng=np.random.default_rng(1),
        )
        return replace(pair, truth=None)


def findings(estimator: Estimator, *, shape: tuple[int, int] = (9, 256)) -> list[str]:
    """Say in words what an estimator does that none may do; an empty list if nothing was found.

    It is tried on simulated speckle at a coherence of .95 and of 1, a delay of 0.2 wraps and a relative bandwidth of
    0.3: shapes and limits of what it gives, nothing that is not finite marked valid, silence not valid, a record that
    is not periodic and one of single precision taken, its input left alone; receivers swapped negate the delay, a
    common gain or phase changes nothing, and 0.2 wraps of delay more or less move the estimate by it (in the median,
    within 0.02 wraps).

    Parameters
    ----------
    estimator
        Anything with `estimate(pair)`.
    shape
        (rows, samples) of the speckle, which must hold the estimator's window.

    Returns
    -------
    list
        One sentence a finding. Whatever it raises is a finding too.
    """
    if not isinstance(estimator, Estimator):
        return [f"{type(estimator).__name__} has no method estimate(pair)"]
    trial = Trial(estimator, shape)
    return [finding for check in CHECKS for finding in _tried(check, trial)]


def _tried(check: Callable[[Trial], Iterator[str]], trial: Trial) -> Iterator[str]:
    # Whatever a stranger's estimator raises is to be told, not to end the suite.
    try:
        yield from check(trial)
    except Exception as error:
        yield f"{check.__name__.strip('_').replace('_', ' ')}: it raised {type(error).__name__}: {error}"


def _an_ordinary_pair(trial: Trial) -> Iterator[str]:
    yield from _contract(trial.estimator.estimate(trial.echoes()), trial.shape)


def _a_record_that_is_not_periodic(trial: Trial) -> Iterator[str]:
    pair = replace(trial.echoes(), circular=False)
    estimate = trial.estimator.estimate(pair)
    yield from (f"of a record that is not periodic, {said}" for said in _contract(estimate, trial.shape))


def _contract(estimate: DelayEstimate, shape: tuple[int, int]) -> Iterator[str]:
    wrong = [name for name in FIELDS if np.shape(getattr(estimate, name)) != shape]
    if wrong:
        for name in wrong:
            yield f"{name} has the shape {np.shape(getattr(estimate, name))}; it must have that of the pair, {shape}"
        return
    valid = np.asarray(estimate.valid)
    if valid.dtype != np.bool_:
        yield f"valid is of type {valid.dtype}; it must be bool"
        valid = valid.astype(np.bool_)
    if not valid.any():
        yield "no sample of speckle at a coherence of .95 is valid"
    for name in FIELDS[:-1]:
        yield from _some(~np.isfinite(getattr(estimate, name)) & valid, f"{name} is not finite but valid")
    for name in SHARES:
        value = getattr(estimate, name)
        yield from _some(valid & ((value < 0) | (value > 1)), f"{name} is not between 0 and 1")
    yield from _some(valid & (estimate.delay_std < 0), "delay_std is below 0")
    yield from _some(valid & (np.abs(estimate.phase) > np.pi * (1 + 1e-12)), "phase is not within -pi and pi")


def _silence(trial: Trial) -> Iterator[str]:
    pair = trial.echoes()
    nothing = np.zeros_like(pair.primary)
    cases = {
        "the primary is silent": replace(pair, primary=nothing),
        "the secondary is silent": replace(pair, secondary=nothing),
        "both receivers are silent": replace(pair, primary=nothing, secondary=nothing),
    }
    for said, silent in cases.items():
        yield from _some(np.asarray(trial.estimator.estimate(silent).valid, dtype=bool), f"it is valid where {said}")


def _receivers_swapped(trial: Trial) -> Iterator[str]:
    pair = trial.echoes()
    there = trial.estimator.estimate(pair)
    back = trial.estimator.estimate(replace(pair, primary=pair.secondary, secondary=pair.primary))
    yield from _some(_apart(there.delay, -back.delay) & there.valid, "receivers swapped do not negate the delay")
    yield from _some(there.valid != back.valid, "receivers swapped change what is valid")


def _a_common_gain_or_phase(trial: Trial) -> Iterator[str]:
    pair = trial.echoes()
    plain = trial.estimator.estimate(pair)
    for name, factor in (("gain of 1e6", 1e6), ("gain of 1e-6", 1e-6), ("phase of 1 rad", np.exp(1j))):
        changed = trial.estimator.estimate(
            replace(pair, primary=factor * pair.primary, secondary=factor * pair.secondary)
        )
        yield from _some(_apart(plain.delay, changed.delay) & plain.valid, f"a common {name} changes the delay")
        yield from _some(
            ~np.isclose(plain.coherence, changed.coherence, rtol=0, atol=1e-6) & plain.valid,
            f"a common {name} changes the coherence",
        )
        yield from _some(plain.valid != changed.valid, f"a common {name} changes what is valid")


def _an_added_delay(trial: Trial) -> Iterator[str]:
    pair = trial.echoes(coherence=1.0, delay=0.0)
    frequencies = CENTRE_FREQUENCY + scipy.fft.fftfreq(trial.shape[1], 1 / pair.sample_rate)
    before = trial.estimator.estimate(pair)
    for added in (-0.2, 0.2):
        spectrum = scipy.fft.fft(pair.secondary, axis=-1) * np.exp(-2j * np.pi * frequencies * added * WRAP)
        after = trial.estimator.estimate(replace(pair, secondary=scipy.fft.ifft(spectrum, axis=-1)))
        both = before.valid & after.valid
        moved = float(np.median((after.delay - before.delay)[both])) / WRAP if both.any() else np.nan
        # A NaN is a finding.
        if not abs(moved - added) < 0.02:
            yield f"a delay of {added:g} wraps more moves the median estimate by {moved:.3g} wraps"


def _single_precision(trial: Trial) -> Iterator[str]:
    pair = trial.echoes()
    single = replace(pair, primary=pair.primary.astype(np.complex64), secondary=pair.secondary.astype(np.complex64))
    double, found = trial.estimator.estimate(pair), trial.estimator.estimate(single)
    apart = _apart(double.delay, found.delay, 1e3 * SAME) & double.valid & found.valid
    # A single pixel may be so dark that its wrap hangs on rounding.
    if apart.mean() > 0.01:
        yield from _some(apart, "single precision gives another delay")


def _its_input(trial: Trial) -> Iterator[str]:
    pair, untouched = trial.echoes(), trial.echoes()
    trial.estimator.estimate(pair)
    for name in ("primary", "secondary"):
        if not np.array_equal(getattr(pair, name), getattr(untouched, name)):
            yield f"it changes the {name} that it is given"


def _apart(one: Real, other: Real, limit: float = SAME) -> NDArray[np.bool_]:
    """Where delays differ by more than a limit in wraps, or are not numbers."""
    apart: NDArray[np.bool_] = ~(np.abs(one - other) <= limit * WRAP)
    return apart


def _some(where: NDArray[np.bool_], said: str) -> Iterator[str]:
    if where.any():
        first = tuple(int(i) for i in np.argwhere(where)[0])
        yield f"{said} at {int(where.sum())} of {where.size} samples, the first at {first}"


CHECKS: tuple[Callable[[Trial], Iterator[str]], ...] = (
    _an_ordinary_pair,
    _a_record_that_is_not_periodic,
    _silence,
    _receivers_swapped,
    _a_common_gain_or_phase,
    _an_added_delay,
    _single_precision,
    _its_input,
)
