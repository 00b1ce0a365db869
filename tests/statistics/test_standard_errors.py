"""Standard errors and intervals of a study are honest: 1,000 small studies, each with echoes of its own.

The spread of 1,000 repetitions is itself known to 2.2 %, their coverage to 0.7 %.
"""

import numpy as np
import pytest

from studies import catalogue
from studies.design import methods, points, task
from studies.measure import measure
from studies.table import row

STUDIES, TRIALS = 1000, 400

pytestmark = pytest.mark.long


def repeated(looks, snr):
    study = catalogue.study("wrap-errors").of_estimators(["cross-correlation"])
    study = study.with_values(
        {
            "patch.looks": [looks],
            "patch.snr": [snr],
            "sonar.bandwidth": ["30 kHz"],
            "trials.count": TRIALS,
            "trials.block": TRIALS,
        }
    )
    point = next(points(study))
    chosen = methods(study, point)
    return [row(point, measure(task(study, point, 0), chosen, TRIALS, seed).measurements[0]) for seed in range(STUDIES)]


@pytest.fixture(scope="module", params=[(9, 8.0, True), (33, 13.0, False)], ids=["with wraps", "without"])
def studies(request):
    looks, snr, wraps = request.param
    rows = repeated(looks, snr)
    seen = np.mean([r["wrap_errors"] for r in rows])
    assert seen > 20 if wraps else seen == 0
    return rows, wraps


def values(rows, name):
    return np.array([r[name] for r in rows])


def test_reported_errors_are_the_spread_of_repetitions(studies):
    rows, wraps = studies
    names = ["delay_bias", "delay_std_in_wrap", "delay_bias_total", "delay_std_total", "rmse"]
    names += ["wrap_rate"] if wraps else []
    for name in names:
        reported, found = np.mean(values(rows, f"{name}_se")), np.std(values(rows, name))
        assert reported == pytest.approx(found, rel=0.1), name


def test_intervals_of_95_percent_cover_as_often(studies):
    rows, _ = studies
    for name in ("delay_bias", "delay_std_in_wrap", "delay_std_total", "rmse"):
        value, error = values(rows, name), values(rows, f"{name}_se")
        # The pooled value of 400,000 trials is the truth, to a thirtieth of a study's standard error.
        truth = 0.0 if name == "delay_bias" else np.sqrt(np.mean(value**2))
        covered = np.mean(np.abs(value - truth) < 1.96 * error)
        assert 0.93 < covered < 0.97, (name, covered)


def test_intervals_of_the_wrap_rate_cover_as_often(studies):
    rows, wraps = studies
    rate = np.mean(values(rows, "wrap_rate"))
    for kind in ("", "_exact"):
        low, high = (values(rows, f"wrap_rate{kind}_{end}") for end in ("low", "high"))
        covered = np.mean((low <= rate) & (rate <= high))
        # Where no study saw a wrap error, every interval begins at the rate that was seen.
        assert 0.93 < covered < 0.97 if wraps else covered == 1.0, (kind, covered)
