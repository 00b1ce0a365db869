import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from studies import statistics
from studies.measurement import Measurement
from studies.moments import of_errors


def moments(errors, **options):
    return of_errors(errors, np.abs(errors) > 2, **options)[0]


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
    found = statistics.wilson(moments(1.0 * (np.arange(trials)[:, None] < hits)), "wrong")
    assert found.value == hits / trials
    assert found.low == pytest.approx(low, abs=5e-4)
    assert found.high == pytest.approx(high, abs=5e-4)


@given(st.integers(2, 6), st.integers(0, 2**32 - 1))
def test_copies_within_a_cluster_add_no_certainty(copies, seed):
    errors = np.random.default_rng(seed).normal(size=(50, 1))
    single, repeated = moments(errors), moments(np.repeat(errors, copies, axis=1))
    assert statistics.rmse(repeated) == pytest.approx(statistics.rmse(single))
    assert statistics.std_in_wrap(repeated) == pytest.approx(statistics.std_in_wrap(single))
    widths = [rate.high - rate.low for rate in (statistics.wilson(m, "wrong") for m in (single, repeated))]
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
        statistic = [
            statistics.ratio(of, "right_error", "right"),
            statistics.std_in_wrap(of),
            statistics.rmse(of),
            statistics.std(of),
        ]
        if wraps:
            statistic.append(statistics.ratio(of, "wrong", "tried"))
        reported.append([s.error for s in statistic])
        found.append([s.value for s in statistic])
    np.testing.assert_allclose(np.mean(reported, axis=0), np.std(found, axis=0), rtol=0.1)


def test_errors_that_are_no_numbers_do_not_count():
    found = moments(np.array([[0.1], [-0.1], [np.nan], [2.0]]))
    assert found["tried"] == 3
    assert found["wrong"] == 1
    assert statistics.std_in_wrap(found).value == pytest.approx(0.1)
    assert statistics.rmse(found).value == pytest.approx(np.sqrt((0.01 + 0.01 + 4.0) / 3))


@pytest.mark.parametrize(("hits", "low", "high"), [(0, 0.0, 0.3085), (1, 0.0025, 0.4450), (5, 0.1871, 0.8129)])
def test_exact_interval_is_that_of_the_tables(hits, low, high):
    # Clopper and Pearson's limits for 10 trials, from tables of the binomial distribution.
    found = statistics.clopper_pearson(moments(1.0 * (np.arange(10)[:, None] < hits)), "wrong")
    assert found.low == pytest.approx(low, abs=5e-5)
    assert found.high == pytest.approx(high, abs=5e-5)


@given(st.integers(0, 200), st.integers(0, 2**32 - 1))
def test_the_mean_square_error_is_the_sum_of_its_parts(wraps, seed):
    rng = np.random.default_rng(seed)
    errors = 0.03 + 0.1 * rng.uniform(-1, 1, (200, 1)) + (np.arange(200) < wraps)[:, None]
    parts = statistics.parts_of_mse(moments(errors))
    right = errors[np.abs(errors) <= 0.5]
    square = np.mean(errors**2)
    share = right.size / errors.size
    assert parts.wraps == pytest.approx(np.mean(np.where(np.abs(errors) > 0.5, errors**2, 0)) / square, abs=1e-9)
    if right.size:
        assert parts.bias == pytest.approx(share * right.mean() ** 2 / square, abs=1e-9)
        assert parts.spread == pytest.approx(share * right.var() / square, abs=1e-9)
    assert sum(parts) == pytest.approx(1.0)


def test_coverage_counts_the_right_ones_within_their_own_interval():
    errors = np.array([[0.1], [0.2], [-0.3], [1.0]])
    found = moments(errors, half_width=0.25, claimed=np.array([[0.1], [0.2], [0.3], [0.4]]))
    assert statistics.ratio(found, "covered", "right").value == pytest.approx(2 / 3)
    assert statistics.ratio(found, "claimed", "tried").value == pytest.approx(0.25)


def importance(rng, size, shift):
    """Trials of N(0, 1) drawn from N(shift, 1), with their likelihood ratios."""
    x = rng.normal(shift, 1.0, (size, 1))
    return x, np.exp(shift**2 / 2 - shift * x)


def test_weights_of_one_change_nothing():
    errors = np.random.default_rng(1).normal(0, 0.5, (300, 1))
    plain, weighted = moments(errors), moments(errors, weights=np.ones((300, 1)))
    assert not weighted.weighted
    for name in ("trials", "wrap_errors", "square_weight", "largest_weight"):
        assert getattr(plain, name) == getattr(weighted, name)
    np.testing.assert_array_equal(plain.products, weighted.products)


def test_weighted_statistics_are_those_of_the_distribution_that_the_weights_lead_back_to():
    # N(0, 0.2^2) errors in wraps drawn from N(0.5, 0.2^2): P(|e| > 0.5) = 2 Q(2.5) = .012419, of which the far half is
    # out of reach; drawn from a mixture of both sides. 5 standard errors have a false-alarm rate of 6e-7.
    rng, size, scale = np.random.default_rng(4), 20_000, 0.2
    side = np.where(rng.random((size, 1)) < 0.5, 1.0, -1.0)
    centre = np.where(rng.random((size, 1)) < 0.3, 0.0, 0.5 * side)
    x = rng.normal(centre, scale)

    def density(mean):
        return np.exp(-((x - mean) ** 2) / (2 * scale**2))

    weights = density(0) / (0.3 * density(0) + 0.35 * density(0.5) + 0.35 * density(-0.5))
    found = moments(x, weights=weights)
    rate = statistics.ratio(found, "wrong", "tried")
    assert rate.value == pytest.approx(0.0124193, abs=5 * rate.error)
    # A direct count would have a standard error of sqrt(p / n) = 7.9e-4.
    assert rate.error < 2.5e-4
    interval = statistics.wilson(found, "wrong")
    assert interval.high - interval.low == pytest.approx(2 * 1.96 * rate.error, rel=0.1)
    exact = statistics.clopper_pearson(found, "wrong")
    assert exact.low < interval.value < exact.high
    assert exact.high - exact.low == pytest.approx(interval.high - interval.low, rel=0.1)
    spread = statistics.rmse(found)
    assert spread.value == pytest.approx(scale, abs=5 * spread.error)
    assert statistics.effective_trials(found) == pytest.approx(weights.sum() ** 2 / (weights**2).sum())
    assert 0.3 * size < statistics.effective_trials(found) < size


def test_few_dominating_weights_are_told():
    from studies.design import Point
    from studies.table import row

    rng = np.random.default_rng(6)
    x, weights = importance(rng, 2000, 4.0)
    facts = {"wrap": 1.0, "crlb": 0.1, "predicted_delay_std": 0.1}
    for factor, told in ((1.0, False), (weights, True)):
        of, batches = of_errors(0.1 * x, 0 * x > 1, weights=factor)
        measurement = Measurement("a", "1x1", "", 1, facts, of, batches, 0, [], 0, 1.0)
        assert row(Point(0, {}, None, None, {}), measurement)["few_dominate"] is told


def test_weighted_errors_are_those_of_repetitions():
    # 1,000 repetitions of 400 weighted trials; the standard error of their spread is 2.2 %.
    rng = np.random.default_rng(7)
    reported, found = [], []
    for _ in range(1000):
        x = rng.normal(np.where(rng.random((400, 1)) < 0.5, 0.0, 1.5), 1.0)
        weights = 1 / (0.5 + 0.5 * np.exp(1.5 * x - 1.125))
        of = moments(0.4 * x, weights=weights)
        statistic = [statistics.ratio(of, "wrong", "tried"), statistics.rmse(of), statistics.std_in_wrap(of)]
        reported.append([s.error for s in statistic])
        found.append([s.value for s in statistic])
    np.testing.assert_allclose(np.mean(reported, axis=0), np.std(found, axis=0), rtol=0.1)


@pytest.mark.parametrize("interval", [statistics.wilson, statistics.clopper_pearson])
@pytest.mark.parametrize(("p", "n"), [(0.03, 300), (0.3, 100), (0.003, 3000)])
def test_intervals_cover_as_often_as_they_say(interval, p, n):
    # 4,000 repetitions: a standard error of 0.34 % around 95 %.
    rng = np.random.default_rng(8)
    hits = rng.binomial(n, p, 4000)
    covered = []
    for count, times in zip(*np.unique(hits, return_counts=True), strict=True):
        found = interval(moments(1.0 * (np.arange(n)[:, None] < count)), "wrong")
        covered.append(times * (found.low <= p <= found.high))
    coverage = sum(covered) / 4000
    assert coverage > 0.93
    # The exact interval covers more often than it says where few are hit.
    assert coverage < (0.97 if interval is statistics.wilson else 0.985)


def test_nothing_tried_gives_no_number():
    nothing = moments(np.full((3, 2), np.nan))
    assert np.isnan(statistics.rmse(nothing).value)
    assert np.isnan(statistics.wilson(nothing, "wrong").high)
