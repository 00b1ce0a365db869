"""How likely it is that two tables of the same study differ by chance as much as they do, comparison by comparison."""

from collections.abc import Callable, Iterator, Sequence

import numpy as np
import pandas as pd
from scipy.special import ndtri
from scipy.stats import hypergeom, norm, t

Clusters = Callable[[pd.DataFrame], "pd.Series[float] | int"]
"""How many clusters of trials each row of a kept table has."""

EXACT = (
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
"""Columns of a table of trials that no chance is in, where windows do not follow the data."""

ENOUGH = 200
"""Trials below which the error of a mean or spread is not known well enough to be compared; half as many again where
they depend on each other."""


class Surprises:
    """Probabilities of differences at least as large, each with what is compared: column and row, or column and method.

    A comparison of rows that chance alone drives apart has a probability below `p` with probability `p`.
    """

    def __init__(self) -> None:
        self.found: list[tuple[float, str]] = []

    def add(self, column: str, rows: pd.DataFrame, on: Sequence[str], p: np.ndarray) -> None:
        labels = (" ".join(map(str, of_row)) for of_row in rows[list(on)].itertuples(index=False))
        self.found += [(float(one), f"{column} of {label}") for one, label in zip(p, labels, strict=True)]

    def beyond(self, false_alarm: float) -> list[str]:
        """What differs by more than chance, with a false alarm in any of them at most so likely."""
        return [f"{what} (p = {p:.1e})" for p, what in self.found if not p >= false_alarm / len(self.found)]


def matched(kept: pd.DataFrame, fresh: pd.DataFrame, on: Sequence[str]) -> pd.DataFrame:
    """Rows of both by their labels, the fresh values with an ending; every fresh row must be among the kept."""
    both = kept.merge(fresh, on=list(on), suffixes=("", "_fresh"), validate="one_to_one")
    assert len(both) == len(fresh) > 0
    return both


def of_trials(
    kept: pd.DataFrame,
    fresh: pd.DataFrame,
    on: Sequence[str],
    *,
    clusters: Clusters | None = None,
) -> Surprises:
    """Two tables of trials.

    Rates of independent trials by the exact test of two binomials; means, and rates of trials that come in so many
    `clusters` or that have weights, by Student's t of their standard errors. Points of independent trials are
    independent, so that the mean of what each row differs by is compared as well, for each estimator.
    """
    both, surprises = matched(kept, fresh, on), Surprises()
    both = both.copy().assign(cluster=1.0 if clusters is None else both.trials / clusters(both))
    independent = clusters is None and not (kept.effective_trials < kept.trials - kept.failures).any()
    fixed = ~both.window.str.contains("(", regex=False)
    for column in (c for c in EXACT if c not in on):
        same = np.isclose(both[column], both[f"{column}_fresh"], rtol=1e-6, atol=0, equal_nan=True)
        surprises.add(column, both[fixed], on, same[fixed].astype(float))
    signed = list(_rates(both)) if independent else list(_clustered_rates(both))
    signed += [*_means(both), *_spreads(both, both[fixed]), _claims(both)]
    for column, rows, z, p in signed:
        surprises.add(column, rows, on, p)
        if clusters is None:
            for name, of_name in rows.assign(z=z).groupby("estimator"):
                known = of_name.z[np.isfinite(of_name.z)]
                if len(known):
                    surprises.found.append((2 * norm.sf(abs(known.sum()) / len(known) ** 0.5), f"{column}, {name}"))
    return surprises


Compared = tuple[str, pd.DataFrame, np.ndarray, np.ndarray]
"""A column, its rows, how many standard errors these differ by, with a sign, and how likely that is."""


def _tried(both: pd.DataFrame, end: str = "") -> np.ndarray:
    return (both[f"trials{end}"] - both[f"failures{end}"]).to_numpy()


def _right(both: pd.DataFrame, end: str = "") -> np.ndarray:
    return _tried(both, end) - both[f"wrap_errors{end}"].to_numpy()


def _rates(both: pd.DataFrame) -> Iterator[Compared]:
    numbers = {
        "wrap_rate": _tried,
        "outlier_rate": _tried,
        "coverage": _right,
        "failure_rate": lambda of, end="": of[f"trials{end}"].to_numpy(),
        "flagged_rate": lambda of, end="": of[f"trials{end}"].to_numpy(),
    }
    for column, number in numbers.items():
        of = number(both), number(both, "_fresh")
        hits = [np.rint(np.nan_to_num(both[f"{column}{e}"]) * n) for e, n in zip(("", "_fresh"), of, strict=True)]
        yield column, both, *binomials(hits[0], of[0], hits[1], of[1])


def binomials(hits: np.ndarray, of: np.ndarray, hits_2: np.ndarray, of_2: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Difference of two shares in standard errors, and its two-sided probability: Fisher's, given the hits of both."""
    chance = hypergeom(of + of_2, hits + hits_2, of_2)
    p = np.minimum(1.0, 2 * np.minimum(chance.cdf(hits_2), chance.sf(hits_2 - 1)))
    with np.errstate(invalid="ignore", divide="ignore"):
        share = (hits + hits_2) / (of + of_2)
        z = (hits_2 / of_2 - hits / of) / np.sqrt(share * (1 - share) * (1 / of + 1 / of_2))
    return z, p


def differences(
    value: np.ndarray, error: np.ndarray, value_2: np.ndarray, error_2: np.ndarray, degrees: np.ndarray | float
) -> tuple[np.ndarray, np.ndarray]:
    """Difference of two means in standard errors, and its two-sided probability."""
    difference, both = value_2 - value, np.hypot(error, error_2)
    with np.errstate(invalid="ignore", divide="ignore"):
        z = np.where(difference == 0, 0.0, difference / both)
    p = np.where(np.isfinite(z), 2 * t.sf(np.abs(z), degrees), 1.0)
    # What is no number in one of them only differs for sure.
    return z, np.where(np.isnan(value) != np.isnan(value_2), 0.0, p)


def _of_means(column: str, both: pd.DataFrame, numbers, errors, power: float = 1.0) -> Compared:
    """A mean, or a power of it; where there are enough trials in both."""
    of, of_2 = numbers
    cluster = both.cluster.to_numpy()
    enough = np.minimum(of, of_2) >= ENOUGH * np.minimum(cluster, 1.5)
    value, value_2 = (both[f"{column}{end}"].to_numpy() for end in ("", "_fresh"))
    error, error_2 = errors[0], _of_few(*errors, of, of_2)
    if power != 1:
        with np.errstate(invalid="ignore", divide="ignore"):
            slope = power * ((value + value_2) / 2) ** (power - 1)
        error, error_2, value, value_2 = error * slope, error_2 * slope, value**power, value_2**power
    z, p = differences(value, error, value_2, error_2, np.maximum(of / cluster - 1, 1))
    return column, both[enough], z[enough], p[enough]


def _of_few(error: np.ndarray, few_error: np.ndarray, of: np.ndarray, few: np.ndarray) -> np.ndarray:
    """The error of few trials goes with their mean, and knows nothing of what is rare; what many say of it does."""
    return np.fmax(few_error, error * np.sqrt(of / np.maximum(few, 1)))


def _errors(both: pd.DataFrame, column: str) -> list[np.ndarray]:
    return [both[f"{column}_se{end}"].to_numpy() for end in ("", "_fresh")]


def _clustered_rates(both: pd.DataFrame) -> Iterator[Compared]:
    for column, number in (("wrap_rate", _tried), ("outlier_rate", _tried), ("coverage", _right)):
        widths = [(both[f"{column}_high{e}"] - both[f"{column}_low{e}"]).to_numpy() for e in ("", "_fresh")]
        errors = [width / (2 * ndtri(0.975)) for width in widths]
        yield _of_means(column, both, (number(both), number(both, "_fresh")), errors)


def _means(both: pd.DataFrame) -> Iterator[Compared]:
    for column, number in (("delay_bias", _right), ("delay_bias_total", _tried)):
        yield _of_means(column, both, (number(both), number(both, "_fresh")), _errors(both, column))


def _spreads(both: pd.DataFrame, fixed: pd.DataFrame) -> Iterator[Compared]:
    """Cube roots of mean squares, which are nearest to normal (Wilson and Hilferty 1931).

    Windows that follow the data may be so large that few of them fall short of the spread, as it is about their mean.
    """
    cases = (("delay_std_in_wrap", _right, fixed), ("delay_std_total", _tried, fixed), ("rmse", _tried, both))
    for column, number, of in cases:
        numbers = number(of), number(of, "_fresh")
        yield _of_means(column, of, numbers, _errors(of, column), power=2 / 3)


def _claims(both: pd.DataFrame) -> Compared:
    """Mean claimed probabilities, whose variance is `p (1 - p)` at the most (Bhatia and Davis 2000)."""
    p = both.claimed_wrap_rate
    most = np.sqrt(p * (1 - p)).to_numpy()
    errors = [
        most / np.sqrt(both[f"effective_trials{end}"].to_numpy() / both.cluster.to_numpy()) for end in ("", "_fresh")
    ]
    return _of_means("claimed_wrap_rate", both, (_tried(both), _tried(both, "_fresh")), errors)


def of_errors_given(kept: pd.DataFrame, fresh: pd.DataFrame, on: Sequence[str], leave_out: Sequence[str]) -> Surprises:
    """Two tables by the columns that have a standard error beside them, `_se`, or the ends of an interval of 95 %.

    Columns that no chance is in are to be the same.

    Rows of fewer than `ENOUGH` trials, and columns whose names hold one of some words, are left out.
    """
    both, surprises = matched(kept, fresh, on).copy(), Surprises()
    if "trials" in kept:
        both = both[(both.trials_fresh - both.wrap_errors_fresh) >= ENOUGH]
    for column in (c for c in EXACT if c in kept and c not in on):
        same = np.isclose(both[column], both[f"{column}_fresh"], rtol=1e-6, atol=0, equal_nan=True)
        surprises.add(column, both, on, same.astype(float))
    for end in ("_se", "_low"):
        for column in (name.removesuffix(end) for name in kept.columns if name.endswith(end)):
            if column in kept and not any(word in column for word in leave_out):
                error, fresh_error = (_error(both, column, of) for of in ("", "_fresh"))
                known = np.isfinite(error) & np.isfinite(fresh_error)
                if "trials" in kept:
                    fresh_error = _of_few(error, fresh_error, both.trials, both.trials_fresh)
                value, fresh_value = both[column].to_numpy(), both[f"{column}_fresh"].to_numpy()
                p = differences(value, error, fresh_value, fresh_error, np.inf)[1]
                surprises.add(column, both[known], on, p[known])
    return surprises


def _error(both: pd.DataFrame, column: str, of: str) -> np.ndarray:
    if f"{column}_se" in both:
        return both[f"{column}_se{of}"].to_numpy()
    return (both[f"{column}_high{of}"] - both[f"{column}_low{of}"]).to_numpy() / (2 * ndtri(0.975))
