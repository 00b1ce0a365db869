"""Stability at the extremes: whether each method gives what it claims, or says that it is not valid."""

from collections.abc import Callable, Mapping
from dataclasses import fields
from types import MappingProxyType
from typing import Any

import numpy as np
import pandas as pd
from scipy import stats

from estimators import (
    CombinedNeighbours,
    CrossCorrelation,
    DelayEstimate,
    Estimator,
    FixedWindow,
    FullBandPhaseSlope,
    Interferogram,
    MaximumLikelihood,
    MultiChromatic,
    SplitSpectrum,
    TwoWindow,
    bounds,
)
from estimators.extremes import Tally, tally
from estimators.posterior import NORMAL_95
from sim import Sonar
from studies.catalogue.extremes_cases import CASES, Echoes, Setting, in_single
from studies.catalogue.extremes_functions import functions

EXACT = 1e-5
"""Error without noise that interpolation between lags leaves [wraps]."""

METHODS: Mapping[str, tuple[Callable[[FixedWindow], Estimator], Callable[[Sonar], float]]] = MappingProxyType(
    {
        "interferogram": (Interferogram, lambda sonar: 0.5 * sonar.wrap),
        "cross-correlation": (CrossCorrelation, lambda sonar: 1 / sonar.bandwidth),
        "cross-correlation-group": (lambda w: CrossCorrelation(w, refine=False), lambda sonar: 1 / sonar.bandwidth),
        "split-spectrum": (SplitSpectrum, lambda sonar: 0.75 / sonar.bandwidth),
        "multi-chromatic": (lambda w: MultiChromatic(w, bands=3), lambda sonar: 1.5 / sonar.bandwidth),
        "phase-slope": (lambda w: FullBandPhaseSlope(w, lags_per_resolution=8), lambda sonar: 2 / sonar.bandwidth),
        "phase-slope-pixel": (lambda w: FullBandPhaseSlope(lags_per_resolution=8), lambda sonar: 2 / sonar.bandwidth),
        "maximum-likelihood": (MaximumLikelihood, lambda sonar: 1 / sonar.bandwidth),
        "two-window": (lambda w: TwoWindow(CrossCorrelation(w)), lambda sonar: 1 / sonar.bandwidth),
        "combined-neighbours": (
            lambda w: CombinedNeighbours(FullBandPhaseSlope(lags_per_resolution=8)),
            lambda sonar: 2 / sonar.bandwidth,
        ),
    }
)
"""Each method with the largest delay that it looks for [s]."""

COLUMNS = (
    *("case", "value", "estimator", "estimates", *(f.name for f in fields(Tally))),
    *("reference_error", "wraps_short", "spread_short", "single_other_wrap", "single_apart"),
    *("statistic", "found", "theory", "standard_errors", "verdict", "said"),
)
"""Of the table, empty where a method or function has nothing of the kind."""

Bound = Callable[[Any, float, float, float], float]


def _of_phase(looks: Any, coherence: float, centre_frequency: float, bandwidth: float) -> float:
    return float(bounds.phase_crlb(looks, coherence)) / (2 * np.pi * centre_frequency)


BOUNDS: Mapping[str, Bound] = MappingProxyType(
    {
        "cross-correlation": _of_phase,
        "phase-slope": _of_phase,
        "split-spectrum": _of_phase,
        "multi-chromatic": _of_phase,
        "cross-correlation-group": lambda n, g, fc, b: float(bounds.group_delay_crlb(n, g, b)),
        "maximum-likelihood": lambda n, g, fc, b: float(bounds.coherent_delay_crlb(n, g, fc, b)),
    }
)
"""Bound of methods whose estimate is of the whole window [s], from looks, coherence, centre frequency and bandwidth."""


def measure(sonar: Sonar, rows: int, rng: np.random.Generator) -> pd.DataFrame:
    """One row for each case, value and estimator; then one for each function of bounds and simulator.

    The echoes of a value are the same for all estimators, but for delays that depend on what a method looks for.
    """
    found = []
    for case, (make, values) in CASES.items():
        for value, seed in zip(values, rng.integers(2**63, size=len(values)), strict=True):
            for name, (_, reach) in METHODS.items():
                echoes = make(value, Setting(sonar, rows, reach), np.random.default_rng(seed))
                found.append({"case": case, "value": float(value), "estimator": name, **_judged(name, echoes)})
    return pd.DataFrame(found + functions(sonar, rng), columns=COLUMNS)


def _judged(name: str, echoes: Echoes) -> dict[str, Any]:
    try:
        estimator = METHODS[name][0](echoes.window)
        estimate = estimator.estimate(echoes.pair)
        alike = None if echoes.alike is None else estimator.estimate(echoes.alike)
        single = in_single(echoes)
        other = None if single is None else estimator.estimate(single.pair)
    except ValueError as error:
        # Whatever a method cannot take it has to say in one line.
        return {"verdict": "fails" if "\n" in str(error) else "refused", "said": str(error)}
    counts = _tally(estimate, echoes)
    return {
        "estimates": len(estimate.delay),
        **{f.name: getattr(counts, f.name) for f in fields(Tally)},
        "reference_error": _reference_error(estimate, alike, echoes, counts),
        "wraps_short": _ratio(counts.wrong, counts.claimed),
        "spread_short": _spread_short(counts),
        **_apart(estimate, other, echoes),
        **_theory(name, estimate, echoes, counts),
        "verdict": _verdict(counts, _reference_error(estimate, alike, echoes, counts)),
        "said": "",
    }


def _tally(estimate: DelayEstimate, echoes: Echoes) -> Tally:
    delay, wrap = echoes.delay, 1 / echoes.pair.centre_frequency
    if echoes.modulo:
        # Of no bandwidth, no wrap is wrong, and none must be said to be right.
        delay = delay + np.rint((estimate.delay[:, echoes.column] - delay) / wrap) * wrap
    return tally(estimate, delay, echoes.pair.centre_frequency, echoes.column)


def _reference_error(estimate: DelayEstimate, alike: DelayEstimate | None, echoes: Echoes, counts: Tally) -> float:
    """Worst error of noise-free echoes [wraps], or difference from echoes scaled by powers of two; NaN of others."""
    if alike is not None:
        if all(np.array_equal(getattr(estimate, f.name), getattr(alike, f.name)) for f in fields(DelayEstimate)):
            return 0.0
        return max(float(np.abs(estimate.delay - alike.delay).max()) * echoes.pair.centre_frequency, 5e-324)
    return counts.worst if echoes.exact and counts.wrong == 0 else np.nan


def _ratio(wrong: int, claimed: float) -> float:
    """How many times wraps are wrong as often as claimed, where that can be told."""
    return wrong / claimed if wrong >= 10 else np.nan


def _spread_short(counts: Tally) -> float:
    """How many times errors are as large as claimed, by the share outside their interval, where that can be told."""
    if counts.outside < 10:
        return np.nan
    return float(NORMAL_95 / stats.norm.isf(min(counts.outside / counts.sure, 0.999) / 2))


def _apart(estimate: DelayEstimate, other: DelayEstimate | None, echoes: Echoes) -> dict[str, float]:
    """Of estimates that are sure of their wrap in both precisions: in another wrap, and how far apart [claimed STD]."""
    if other is None:
        return {}
    sure = [e.valid & (e.wrap_error_probability < 0.5) for e in (estimate, other)]
    both = (sure[0] & sure[1])[:, echoes.column]
    if not both.any():
        return {}
    apart = np.abs(estimate.delay - other.delay)[both, echoes.column]
    same = apart * echoes.pair.centre_frequency <= 0.5
    spread = apart / estimate.delay_std[both, echoes.column]
    return {
        "single_other_wrap": float((~same).mean()),
        "single_apart": float(spread[same].max()) if same.any() else np.nan,
    }


def _theory(name: str, estimate: DelayEstimate, echoes: Echoes, counts: Tally) -> dict[str, Any]:
    """A statistic, what theory says of it, and how many standard errors are between; nothing where there is none."""
    if echoes.coherence is None or counts.valid < 20:
        return {}
    at = estimate.valid[:, echoes.column]
    if echoes.coherence < 0.01:
        # Of a phase that is even over the circle.
        phase = estimate.phase[at, echoes.column]
        return _distance("mean cosine of the phase", float(np.cos(phase).mean()), 0.0, np.sqrt(0.5 / counts.valid))
    if name not in BOUNDS or counts.wrong or echoes.coherence == 1 or counts.sure < counts.valid:
        return {}
    pair, error = echoes.pair, (estimate.delay[:, echoes.column] - echoes.delay)[at]
    bound = BOUNDS[name](echoes.window.looks(pair), echoes.coherence, pair.centre_frequency, pair.bandwidth)
    return _distance("STD / bound", float(error.std()) / bound, 1.0, np.sqrt(0.5 / counts.valid))


def _distance(statistic: str, found: float, theory: float, error: float) -> dict[str, Any]:
    return {"statistic": statistic, "found": found, "theory": theory, "standard_errors": (found - theory) / error}


def _verdict(counts: Tally, reference_error: float) -> str:
    if not counts.holds:
        return "fails"
    if counts.valid == 0:
        return "invalid"
    return "exact" if reference_error <= EXACT else "as claimed"


def ranges(table: pd.DataFrame) -> pd.DataFrame:
    """For each method and case the values at which claims hold, and at which 99 % of all estimates are right.

    Columns `holds` and `right` say from which value to which, in the order that they were tried, with the number of
    values where there are gaps.
    """
    kept = table[table.estimator.isin(list(METHODS))]
    found = []
    for (name, case), rows in kept.groupby(["estimator", "case"], sort=False):
        right = (rows.valid - rows.wrong.fillna(0)) / rows.estimates >= 0.99
        holds = ~rows.verdict.isin(["fails"])
        found.append({"estimator": name, "case": case, "holds": _span(rows, holds), "right": _span(rows, right)})
    return pd.DataFrame(found)


def _span(rows: pd.DataFrame, where: pd.Series) -> str:
    values = rows.loc[where, "value"]
    if values.empty:
        return "none"
    said = f"{values.iloc[0]:.4g} to {values.iloc[-1]:.4g}" if len(values) > 1 else f"{values.iloc[0]:.4g}"
    between = rows.loc[values.index[0] : values.index[-1]]
    return said if len(between) == len(values) else f"{said} ({len(values)} of {len(between)})"


def answer(table: pd.DataFrame) -> str:
    """How many are exact, as claimed, invalid or refused; how far claims are short, and functions off, at worst."""
    methods = table[table.estimator.isin(list(METHODS))]
    others = table[~table.estimator.isin(list(METHODS))]
    counted = methods.verdict.value_counts()
    numbers = {name: int(counted.get(name, 0)) for name in ("exact", "as claimed", "invalid", "refused", "fails")}
    right = ranges(table).set_index(["estimator", "case"]).right
    snr = "; ".join(f"{name} {right[name, 'SNR [dB]']}" for name in METHODS)
    failed = int((others.verdict == "fails").sum())
    return (
        f"Of {len(methods)} extremes, {numbers['exact']} are exact, {numbers['as claimed']} within what is claimed, "
        f"{numbers['invalid']} flagged invalid, {numbers['refused']} refused in one line, and {numbers['fails']} fail; "
        f"at worst wraps are wrong {_worst(methods, 'wraps_short')} times as often as claimed, errors are "
        f"{_worst(methods, 'spread_short')} times as large, and single precision is off by "
        f"{_worst(methods, 'single_apart')} claimed standard deviations; of {len(others)} values of bounds, geometry "
        f"and seabed {failed} fail, and the worst is off by {others.reference_error.max():.1g}; 99 % of the wraps are "
        f"right at an SNR [dB] of: {snr}."
    )


def _worst(rows: pd.DataFrame, column: str) -> str:
    if rows[column].isna().all():
        return "as many"
    row = rows.iloc[int(np.nanargmax(rows[column]))]
    return f"{row[column]:.2g} ({row.estimator}, {row.case} {row.value:g})"
