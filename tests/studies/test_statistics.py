import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from studies import statistics


def test_single_values_give_the_textbook_errors():
    values = np.random.default_rng(1).standard_t(5, size=(400, 1))
    every = np.ones(values.shape, dtype=bool)
    n = len(values)
    centre = statistics.mean(values, every)
    assert centre.value == pytest.approx(values.mean())
    assert centre.error == pytest.approx(values.std(ddof=1) / np.sqrt(n))
    spread = statistics.root_mean_square(values, every, centre.value)
    m2, m4 = np.mean((values - values.mean()) ** 2), np.mean((values - values.mean()) ** 4)
    assert spread.value == pytest.approx(np.sqrt(m2))
    assert spread.error == pytest.approx(np.sqrt((m4 - m2**2) / (n - 1)) / (2 * np.sqrt(m2)))


@pytest.mark.parametrize(
    ("hits", "trials", "low", "high"), [(0, 10, 0.0, 0.2775), (1, 10, 0.0179, 0.4042), (10, 10, 0.7225, 1.0)]
)
def test_wilson_interval_is_that_of_the_tables(hits, trials, low, high):
    # Newcombe (1998), by hand from the score equation.
    found = statistics.rate(np.arange(trials)[:, None] < hits, np.ones((trials, 1), dtype=bool))
    assert found.value == hits / trials
    assert found.low == pytest.approx(low, abs=5e-4)
    assert found.high == pytest.approx(high, abs=5e-4)


@given(st.integers(2, 6), st.integers(0, 2**32 - 1))
def test_copies_within_a_cluster_add_no_certainty(copies, seed):
    rng = np.random.default_rng(seed)
    values = rng.normal(size=(50, 1))
    every = np.ones(values.shape, dtype=bool)
    repeated, all_repeated = np.repeat(values, copies, axis=1), np.repeat(every, copies, axis=1)
    assert statistics.mean(repeated, all_repeated) == pytest.approx(statistics.mean(values, every))
    positive, single = statistics.rate(repeated > 0, all_repeated), statistics.rate(values > 0, every)
    assert positive.high - positive.low == pytest.approx(single.high - single.low, rel=0.05)


def test_reported_errors_are_those_of_repetitions():
    # 1,000 repetitions of 200 clusters of 3 dependent values, 2 % of them far off. The mean reported error is within
    # 10 % of the spread of the repetitions; the standard error of that spread is about 1 / sqrt(2000) = 2.2 %.
    rng = np.random.default_rng(2)
    reported, found = [], []
    for _ in range(1000):
        shared = rng.normal(size=(200, 1))
        values = shared + 0.5 * rng.normal(size=(200, 3)) + 10 * (rng.random((200, 3)) < 0.02)
        every = np.ones(values.shape, dtype=bool)
        statistic = [
            statistics.mean(values, every),
            statistics.root_mean_square(values, every),
            statistics.mean((values > 5).astype(float), every),
        ]
        reported.append([s.error for s in statistic])
        found.append([s.value for s in statistic])
    np.testing.assert_allclose(np.mean(reported, axis=0), np.std(found, axis=0), rtol=0.1)


def test_wilson_intervals_cover_as_often_as_they_say():
    # 4,000 repetitions of 300 trials at 3 %: coverage within 93 to 97 %, 5 standard errors of 0.34 % around 95 %.
    rng = np.random.default_rng(3)
    covered = []
    for _ in range(4000):
        hits = rng.random((300, 1)) < 0.03
        found = statistics.rate(hits, np.ones(hits.shape, dtype=bool))
        covered.append(found.low <= 0.03 <= found.high)
    assert 0.93 < np.mean(covered) < 0.97


def test_nothing_counted_gives_no_number():
    none = np.zeros((3, 2), dtype=bool)
    assert np.isnan(statistics.mean(np.ones((3, 2)), none).value)
    assert np.isnan(statistics.rate(none, none).high)
