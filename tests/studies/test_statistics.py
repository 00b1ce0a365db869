import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from studies import statistics
from studies.moments import of_errors


def moments(errors):
    return of_errors(errors, np.abs(errors) > 2)


def test_single_trials_give_the_textbook_errors():
    errors = np.random.default_rng(1).standard_t(5, size=(400, 1))
    found = moments(errors)
    n, right = len(errors), errors[np.abs(errors) <= 0.5]
    bias = statistics.ratio(found, "right_error", "right")
    assert bias.value == pytest.approx(right.mean())
    # The number in the right wrap is itself random, which counts one more cluster in n - 1.
    assert bias.error == pytest.approx(right.std() / np.sqrt(len(right)) * np.sqrt(n / (n - 1)))
    spread = statistics.std_in_wrap(found)
    m2, m4 = np.mean((right - right.mean()) ** 2), np.mean((right - right.mean()) ** 4)
    assert spread.value == pytest.approx(right.std())
    kurtosis_form = np.sqrt((m4 - m2**2) / len(right)) / (2 * np.sqrt(m2))
    assert spread.error == pytest.approx(kurtosis_form * np.sqrt(n / (n - 1)))
    square = errors**2
    rmse = statistics.rmse(found)
    assert rmse.value == pytest.approx(np.sqrt(square.mean()))
    assert rmse.error == pytest.approx(square.std(ddof=1) / np.sqrt(n) / (2 * rmse.value))


@pytest.mark.parametrize(
    ("hits", "trials", "low", "high"), [(0, 10, 0.0, 0.2775), (1, 10, 0.0179, 0.4042), (10, 10, 0.7225, 1.0)]
)
def test_wilson_interval_is_that_of_the_tables(hits, trials, low, high):
    # Newcombe (1998), by hand from the score equation.
    found = statistics.rate(moments(1.0 * (np.arange(trials)[:, None] < hits)), "wrong")
    assert found.value == hits / trials
    assert found.low == pytest.approx(low, abs=5e-4)
    assert found.high == pytest.approx(high, abs=5e-4)


@given(st.integers(2, 6), st.integers(0, 2**32 - 1))
def test_copies_within_a_cluster_add_no_certainty(copies, seed):
    errors = np.random.default_rng(seed).normal(size=(50, 1))
    single, repeated = moments(errors), moments(np.repeat(errors, copies, axis=1))
    assert statistics.rmse(repeated) == pytest.approx(statistics.rmse(single))
    assert statistics.std_in_wrap(repeated) == pytest.approx(statistics.std_in_wrap(single))
    widths = [rate.high - rate.low for rate in (statistics.rate(m, "wrong") for m in (single, repeated))]
    assert widths[1] == pytest.approx(widths[0], rel=0.05)


@given(st.integers(1, 20), st.integers(1, 20), st.integers(0, 2**32 - 1))
def test_moments_of_blocks_add_up(first, second, seed):
    errors = np.random.default_rng(seed).normal(size=(first + second, 3))
    whole, parts = moments(errors), moments(errors[:first]) + moments(errors[first:])
    assert parts.clusters == whole.clusters
    np.testing.assert_allclose(parts.totals, whole.totals, atol=1e-12)
    np.testing.assert_allclose(parts.products, whole.products, atol=1e-12)


@pytest.mark.parametrize("wraps", [0.0, 0.02])
def test_reported_errors_are_those_of_repetitions(wraps):
    # 1,000 repetitions of 200 clusters of 3 dependent errors. The mean reported error is within 10 % of the spread of
    # the repetitions; the standard error of that spread is about 1 / sqrt(2000) = 2.2 %.
    rng = np.random.default_rng(2)
    reported, found = [], []
    for _ in range(1000):
        errors = 0.1 * (rng.normal(size=(200, 1)) + 0.5 * rng.normal(size=(200, 3)))
        errors += rng.random((200, 3)) < wraps
        of = moments(errors)
        statistic = [statistics.ratio(of, "right_error", "right"), statistics.std_in_wrap(of), statistics.rmse(of)]
        if wraps:
            statistic.append(statistics.ratio(of, "wrong", "tried"))
        reported.append([s.error for s in statistic])
        found.append([s.value for s in statistic])
    np.testing.assert_allclose(np.mean(reported, axis=0), np.std(found, axis=0), rtol=0.1)


def test_wilson_intervals_cover_as_often_as_they_say():
    # 4,000 repetitions of 300 trials at 3 %: coverage within 93 to 97 %, 5 standard errors of 0.34 % around 95 %.
    rng = np.random.default_rng(3)
    found = [statistics.rate(moments(1.0 * (rng.random((300, 1)) < 0.03)), "wrong") for _ in range(4000)]
    covered = [rate.low <= 0.03 <= rate.high for rate in found]
    assert 0.93 < np.mean(covered) < 0.97


def test_errors_that_are_no_numbers_do_not_count():
    found = moments(np.array([[0.1], [-0.1], [np.nan], [2.0]]))
    assert found["tried"] == 3
    assert found["wrong"] == 1
    assert statistics.std_in_wrap(found).value == pytest.approx(0.1)
    assert statistics.rmse(found).value == pytest.approx(np.sqrt((0.01 + 0.01 + 4.0) / 3))


def test_nothing_tried_gives_no_number():
    nothing = moments(np.full((3, 2), np.nan))
    assert np.isnan(statistics.rmse(nothing).value)
    assert np.isnan(statistics.rate(nothing, "wrong").high)
