"""Points that end by a rule: on complete prefixes of blocks, and on nothing else."""

import numpy as np
import pandas as pd
import pytest

from studies import engine
from studies.design import methods, points
from studies.engine import Run
from studies.measurement import Measurement
from studies.moments import of_errors
from studies.stopping import Standing, met
from studies.study import Until

RULE = {"trials.count": 3200, "trials.block": 50, "trials.until.wrap_errors": 20}


def measurement(errors):
    moments, batches = of_errors(errors, np.abs(errors) > 2)
    return Measurement("a", "1x1", "", 1, {}, moments, batches, 0, [], 0, 1.0)


def errors(wrong, of=50):
    return np.where(np.arange(of) < wrong, 1.0, 0.01 * (np.arange(of) % 3 - 1))[:, None]


def test_a_rule_asks_after_1_2_4_8_blocks(small):
    standing = Standing(small.with_values(RULE))
    targets = []
    for block in range(8):
        standing.add(block, [measurement(errors(4))])
        targets.append(standing.target)
    # 4, 8, 12, 16, 20, ... wrap errors: 16 after 4 blocks do not do, 32 after 8 do.
    assert targets == [2, 4, 4, 8, 8, 8, 8, 8]
    assert standing.complete
    assert not standing.add(8, [measurement(errors(4))])
    assert standing.sums[""].moments.wrap_errors == 32


def test_blocks_after_a_gap_do_not_count(small):
    standing = Standing(small.with_values(RULE))
    assert standing.add(0, [measurement(errors(1))])
    assert not standing.add(2, [measurement(errors(40))])
    assert standing.target == 2
    assert list(standing.missing) == [1]


def test_targets_of_a_rule():
    found = measurement(errors(10, of=1000))
    # A rate of .01 in 1,000 trials has a standard error of .00315, and 990 errors around 0 a spread known to 1 %.
    assert met(Until(wrap_errors=10), found)
    assert not met(Until(wrap_errors=11), found)
    assert met(Until(wrap_rate_error=0.32), found)
    assert not met(Until(wrap_rate_error=0.31), found)
    assert met(Until(std_error=0.02, wrap_errors=1), found)
    assert not met(Until(std_error=0.005), found)
    assert not met(Until(wrap_rate_error=0.9), measurement(errors(0)))


@pytest.mark.parametrize("how", [Run(jobs=2), Run(jobs=2, backend="threading")])
def test_the_table_does_not_depend_on_speed(small, table_of, tmp_path, how):
    study = small.with_values(RULE)
    plain = table_of(study, Run(jobs=1, backend="sequential"), tmp_path / "plain")
    pd.testing.assert_frame_equal(table_of(study, how, tmp_path / "other"), plain, check_exact=True)
    # The noisy point needs fewer trials, and each estimator ends for itself.
    assert plain.trials.nunique() > 1
    assert (plain.wrap_errors >= 20).all()
    assert set(plain.trials) <= {50 * 2**n for n in range(7)}


def test_another_estimator_or_a_stricter_rule_changes_no_number_of_before(small, table_of, tmp_path):
    study = small.with_values(RULE)
    how = Run(jobs=1, backend="sequential")
    plain = table_of(study, how, tmp_path / "plain")
    table_of(study.of_estimators(["split-spectrum"]), how, tmp_path / "grown")
    table_of(
        study.with_values({"trials.until.wrap_errors": 60}).of_estimators(["phase-slope"]), how, tmp_path / "grown"
    )
    pd.testing.assert_frame_equal(table_of(study, how, tmp_path / "grown"), plain, check_exact=True)


def test_shards_hold_whole_points_where_a_rule_ends_them(small):
    study = small.with_values(RULE)
    for point in points(study):
        parts = [engine.Share(k, 2).of_blocks(study, point, np.arange(64)).size for k in (1, 2)]
        assert sorted(parts) == [0, 64]
    study = small.with_values({"trials.count": 700})
    for point in points(study):
        assert [engine.Share(k, 2).of_blocks(study, point, np.arange(7)).size for k in (1, 2)] in ([3, 4], [4, 3])
    assert len(methods(study, point)) == 3
