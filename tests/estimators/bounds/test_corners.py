"""Every exact statistic against high precision, at all combinations of the extremes that the docs promise."""

import csv
from collections.abc import Callable
from pathlib import Path

import mpmath
import numpy as np
import pytest

from estimators import bounds

# As high_precision.csv was made by make_high_precision.py beside it.
SMALLEST = 1e-290
Function = Callable[[np.ndarray, np.ndarray, np.ndarray], np.ndarray]

FUNCTIONS: dict[str, Function] = {
    "phase_pdf": lambda n, g, x: bounds.multilook_phase_pdf(x, n, g),
    "phase_tail": lambda n, g, x: bounds.multilook_phase_cdf(-x, n, g),
    "phase_std": lambda n, g, x: bounds.multilook_phase_std(n, g),
    "coherence_pdf": lambda n, g, x: bounds.sample_coherence_pdf(x, n, g),
    "coherence_mean": lambda n, g, x: bounds.sample_coherence_mean(n, g),
    "coherence_std": lambda n, g, x: bounds.sample_coherence_std(n, g),
    "coherent_pair": lambda n, g, x: bounds.coherent_pair_probability(n, g, x),
}


def corners(quantity: str) -> np.ndarray:
    """Columns: looks, coherence, argument, value; a value that underflows is zero."""
    with Path(__file__).with_name("high_precision.csv").open() as file:
        rows = [row for row in csv.DictReader(file) if row["quantity"] == quantity]
    return np.array([[float(row[k]) for k in ("looks", "coherence", "argument", "value")] for row in rows]).T


@pytest.mark.parametrize("quantity", FUNCTIONS)
def test_relative_error_at_the_corners(quantity: str) -> None:
    n, g, x, expected = corners(quantity)
    assert n.size > 25
    found = FUNCTIONS[quantity](n, g, x)
    there = expected > SMALLEST
    np.testing.assert_allclose(found[there], expected[there], rtol=1e-6)
    assert np.all((found[~there] >= 0.0) & (found[~there] < 10.0 * SMALLEST))


def test_quantile_at_the_corners() -> None:
    n, g, phase, tail = corners("phase_tail")
    there = (tail > SMALLEST) & (tail < 0.5 - 1e-9)
    n, g, phase, tail = n[there], g[there], phase[there], tail[there]
    # What the rounding of a probability near one half is worth in phase.
    rounding = 1e-16 / bounds.multilook_phase_pdf(phase, n, g)
    for sign, probability in ((-1.0, tail), (1.0, 1.0 - tail)):
        kept = (probability < 0.5) | (tail > 1e-3)
        error = np.abs(sign * bounds.multilook_phase_quantile(probability, n, g) - phase)[kept]
        assert np.all(error <= (1e-6 * phase + 4.0 * rounding)[kept])


def test_debiasing_at_the_corners() -> None:
    n, g, _, mean = corners("coherence_mean")
    found = bounds.debias_coherence(mean, n)
    risen = mean - 0.5 * np.sqrt(np.pi) * np.exp([_log_gamma_ratio(v) for v in n])
    # Near the floor, gamma^2 is as uncertain as rounding makes the rise of the mean: 1e-15 of the mean, and
    # 1e-11 of it at a million looks.
    rounding = mean * np.where(n > 1e5, 1e-11, 1e-15) / np.maximum(2.0 * risen, 1e-300)
    strict = rounding < 1e-7
    assert np.count_nonzero(strict) > 15
    np.testing.assert_allclose(found[strict], g[strict], rtol=1e-6)
    assert np.all(found[~strict] <= np.sqrt(g[~strict] ** 2 * (1.0 + 10.0 * rounding[~strict])) + 1e-300)


def _log_gamma_ratio(n: float) -> float:
    return float(mpmath.loggamma(n) - mpmath.loggamma(n + 0.5))
