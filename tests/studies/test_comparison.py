"""Estimators against each other on the same echoes."""

import numpy as np
import pytest

from studies.comparison import Comparison
from studies.measurement import Measurement
from studies.moments import of_errors


def block(**by_name):
    made = []
    for name, errors in by_name.items():
        moments, batches = of_errors(errors, np.abs(errors) > 2)
        made.append(Measurement(name, "1x1", "", 1, {}, moments, batches, 0, [], 0, 1.0))
    return made


def pairs(rng, size):
    """Errors of two estimators that share most of what goes wrong."""
    shared = 0.1 * rng.normal(size=(size, 1))
    wrong = rng.random((size, 1)) < 0.05
    a = shared + wrong
    b = shared + 0.02 * rng.normal(size=(size, 1)) + (wrong | (rng.random((size, 1)) < 0.01))
    return a, b


def compared(rng, blocks, size):
    comparison = Comparison()
    everything = [pairs(rng, size) for _ in range(blocks)]
    for a, b in everything:
        comparison.add(block(a=a, b=b))
    return comparison.rows(), *(np.concatenate(parts) for parts in zip(*everything, strict=True))


def test_differences_are_those_of_the_trials():
    (row,), a, b = compared(np.random.default_rng(1), 4, 100)
    assert (row["estimator"], row["other"]) == ("a", "b")
    rates = [np.mean(np.abs(errors) > 0.5) for errors in (a, b)]
    assert row["wrap_rate_difference"] == pytest.approx(rates[0] - rates[1])
    assert row["rmse_difference"] == pytest.approx(np.sqrt(np.mean(a**2)) - np.sqrt(np.mean(b**2)))


def test_their_standard_errors_are_the_spread_of_repetitions():
    # 1,000 repetitions of 4 blocks, 64 groups; the standard error of their spread is 2.2 %.
    rng = np.random.default_rng(2)
    names = ("wrap_rate_difference", "rmse_difference")
    rows = [compared(rng, 4, 100)[0][0] for _ in range(1000)]
    for name in names:
        spread = np.std([row[name] for row in rows])
        assert np.mean([row[f"{name}_se"] for row in rows]) == pytest.approx(spread, rel=0.1)
    # Unpaired, the difference of two rates of 5 and 6 % in 400 trials would have a standard error of .016.
    assert np.mean([row["wrap_rate_difference_se"] for row in rows]) < 0.008


def test_one_estimator_has_nobody_to_compare_with():
    comparison = Comparison()
    comparison.add(block(a=np.zeros((5, 1))))
    assert comparison.rows() == []
    assert Comparison().rows() == []


def test_blocks_that_only_some_have_count_for_those():
    rng = np.random.default_rng(3)
    comparison, both = Comparison(), [pairs(rng, 100) for _ in range(3)]
    for a, b in both:
        comparison.add(block(a=a, b=b))
    comparison.add(block(a=np.zeros((100, 1)), c=np.ones((100, 1))))
    rows = {(row["estimator"], row["other"]): row for row in comparison.rows()}
    assert set(rows) == {("a", "b"), ("a", "c")}
    a, b = (np.concatenate(parts) for parts in zip(*both, strict=True))
    expected = np.mean(np.abs(a) > 0.5) - np.mean(np.abs(b) > 0.5)
    assert rows["a", "b"]["wrap_rate_difference"] == pytest.approx(expected)
    assert rows["a", "b"]["trials"] == 300
    assert rows["a", "c"]["wrap_rate_difference"] == -1.0
