"""Search for the cheapest setting that meets a tolerance."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np
import scipy.fft

from estimators import FixedWindow
from sim import Sonar, checks, speckle_pair
from studies.parallel import one_thread
from studies.pareto import to_digits
from studies.settings import WIDE, settings
from studies.statistics import Interval
from studies.timing import Case, prices
from studies.tuning.condition import Condition, Tolerance
from studies.tuning.judged import Judged, Records

FAR_STD, FAR_RATE = 1.5, 3.0
"""How many times what is allowed a prediction must be for a setting to be left out; predictions err by less."""

TIGHTER = 1e-3
"""Share by which a spread must be smaller on the same echoes to count as better."""

BETTER_TRIES = 6
"""Dearer settings that are confirmed in search of a better one."""


@dataclass(frozen=True)
class Effort:
    """How much is measured: samples that are timed, that sort out, that confirm; repeats of each time."""

    timed: int
    sorting: int
    confirming: int
    repeats: int


USUAL, QUICK = Effort(2**15, 2**17, 2**21, 5), Effort(2**13, 2**16, 2**19, 3)


@dataclass(frozen=True)
class Tuned:
    """What `tune` found.

    Attributes
    ----------
    condition, tolerance
        What was asked.
    best
        The cheapest setting that meets the tolerance; None where none does.
    cheaper, better
        The next cheaper one, which fails; and the next dearer one that meets the tolerance too and has a smaller spread
        on the same echoes, or fewer wrong wraps. None where there is none among the first `BETTER_TRIES`.
    nearest
        `best`; where there is none, the one whose spread and wrap rate exceed what is allowed by the least factor.
    looks_needed
        Where none meets it, the least looks with which a cross-correlation is predicted to; else None.
    judged
        All settings, the cheapest first.
    """

    condition: Condition
    tolerance: Tolerance
    best: Judged | None
    cheaper: Judged | None
    better: Judged | None
    nearest: Judged
    looks_needed: int | None
    judged: tuple[Judged, ...]


def tune(
    sonar: Sonar,
    *,
    looks: int,
    coherence: float,
    rng: np.random.Generator,
    over_bound: float = 0.05,
    wrap_rate: float = 1e-3,
    delay: float = 0.5,
    effort: Effort = USUAL,
) -> Tuned:
    """Find the cheapest setting of any estimator that meets a tolerance, and confirm that it does.

    Every setting of `studies.settings` is timed on homogeneous speckle over which the window slides. Those that theory
    predicts far beyond the tolerance are left out. The others see the same echoes, periodic records of as many looks as
    the window has (`studies.patch`), and fail where a 99 % interval lies beyond it. The rest are measured again, from
    the cheapest on, on fresh echoes until one has both its intervals within: so one that is just beyond passes in at
    most .5 % of cases. Numbers are those of the fresh echoes; of settings near the limit only those pass that happen to
    be low on them. Where fewer than `FEW_ERRORS` wrong wraps are to be expected of these echoes, the rate is that of
    records in which rare errors are frequent (`sim.rare_speckle_pair`); errors that it has no rival for are missed.

    Parameters
    ----------
    sonar
        Centre frequency and bandwidth.
    looks
        Independent looks in the window, 3 to 5,000.
    coherence
        Of the two series, .01 to .9999.
    rng
        The only source of chance. Times are measured, and so is what follows from their order.
    over_bound
        The spread in the right wrap may be that share above the coherent Cramér-Rao bound; .001 to 100.
    wrap_rate
        Largest wrap-error rate; 1e-8 to 1.
    delay
        True delays are even within so many wraps of zero, a number from 0.
    effort
        How much is measured.

    Returns
    -------
    Tuned
        The setting, those beside it and all others.

    Raises
    ------
    ValueError
        For a value outside its limits.
    """
    condition, tolerance = Condition(sonar, looks, coherence, delay), Tolerance(over_bound, wrap_rate)
    return tuned(condition, tolerance, rng, effort)


def tuned(condition: Condition, tolerance: Tolerance, rng: np.random.Generator, effort: Effort) -> Tuned:
    """As `tune`."""
    timing, sorting, confirming = checks.generator(rng).spawn(3)
    with one_thread():
        priced = [_far(one, tolerance) for one in _priced(condition, effort, timing)]
        same = Records(condition, tolerance, effort.sorting, sorting)
        sorted_out = [one if one.fails else _sorted(same.measured(one), tolerance) for one in priced]
        fresh = Records(condition, tolerance, effort.confirming, confirming)
        return _chosen(sorted_out, condition, tolerance, fresh)


def _priced(condition: Condition, effort: Effort, rng: np.random.Generator) -> list[Judged]:
    """All settings in double precision with what they cost and what is predicted of them, the cheapest first."""
    sonar, looks = condition.sonar, condition.looks
    samples = max(256, int(scipy.fft.next_fast_len(2 * WIDE * looks)))
    pair = speckle_pair(
        (max(effort.timed // samples, 1), samples),
        coherence=condition.coherence,
        delay=0.0,
        centre_frequency=sonar.centre_frequency,
        bandwidth=sonar.bandwidth,
        sample_rate=sonar.bandwidth,
        rng=rng,
    )
    chosen = [one for one in settings(sonar, looks, condition.delay) if not one.single]
    cases: dict[str, Case] = {}
    for one in chosen:
        estimator = one.build(FixedWindow(1, looks), FixedWindow(1, one.wide * looks))
        cases[one.name] = partial(estimator.estimate, pair)
    spent = prices(cases, pair.primary.size, effort.repeats)
    priced = []
    for one in chosen:
        std, rate = (Interval(value, value, value) for value in condition.predicted(one))
        priced.append(Judged(one, *spent[one.name], std, rate))
    return sorted(priced, key=lambda one: one.seconds_per_pixel.median)


def _far(one: Judged, tolerance: Tolerance) -> Judged:
    """Failed where its prediction is far beyond the tolerance."""
    std, rate = one.std_over_crlb.value, one.wrap_rate.value
    if std > FAR_STD * tolerance.std_over_crlb:
        return replace(one, fails=f"STD/CRLB {std:.3g} predicted")
    if rate > FAR_RATE * tolerance.wrap_rate:
        return replace(one, fails=f"wrap rate {rate:.2g} predicted")
    return one


def _sorted(one: Judged, tolerance: Tolerance) -> Judged:
    return replace(one, fails=one.beyond(tolerance))


def _chosen(judged: Sequence[Judged], condition: Condition, tolerance: Tolerance, fresh: Records) -> Tuned:
    """Confirm from the cheapest on until one meets the tolerance, then until a better one does too."""
    found = list(judged)

    def confirm(place: int) -> bool:
        """Measure a setting on fresh echoes; whether it meets the tolerance."""
        one = judged[place]
        measured = fresh.measured(one, rare=True)
        fails = measured.not_within(tolerance) or one.fails
        rmse = one.rmse_over_crlb
        found[place] = replace(measured, rmse_over_crlb=rmse, fails=fails, confirmed=not fails)
        return not fails

    left = [place for place, one in enumerate(judged) if not one.fails]
    best = next((place for place in left if confirm(place)), None)
    if best is None:
        nearest = min(range(len(found)), key=lambda place: to_digits(found[place].excess(tolerance)))
        confirm(nearest)
        needed = condition.looks_needed(tolerance)
        return Tuned(condition, tolerance, None, None, None, found[nearest], needed, tuple(found))
    if best > 0 and not found[best - 1].trials:
        confirm(best - 1)
    dearer = [place for place in left if place > best and _may_err_less(judged[place], judged[best])]
    confirmed = (place for place in dearer[:BETTER_TRIES] if confirm(place))
    better = next((place for place in confirmed if _errs_less(found[place], found[best])), None)
    return Tuned(
        condition,
        tolerance,
        best=found[best],
        cheaper=found[best - 1] if best > 0 else None,
        better=None if better is None else found[better],
        nearest=found[best],
        looks_needed=None,
        judged=tuple(found),
    )


def _may_err_less(one: Judged, other: Judged) -> bool:
    """Whether a setting has a smaller spread on the same echoes, or takes its wrap from more of them."""
    return one.setting.wide > other.setting.wide or _tighter(one, other)


def _errs_less(one: Judged, other: Judged) -> bool:
    """Whether a setting has fewer wrong wraps beyond chance or a smaller spread, and not more of the other."""
    fewer = one.wrap_rate.high < other.wrap_rate.low
    more = one.wrap_rate.low > other.wrap_rate.high
    wider = one.std_over_crlb.low > other.std_over_crlb.high
    return (fewer and not wider) or (_tighter(one, other) and not more)


def _tighter(one: Judged, other: Judged) -> bool:
    same_echoes = one.setting.wide == other.setting.wide
    return same_echoes and one.std_over_crlb.value < (1 - TIGHTER) * other.std_over_crlb.value
