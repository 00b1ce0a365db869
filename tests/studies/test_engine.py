import json
from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

from studies import seeds
from studies.catalogue import STUDIES
from studies.engine import Run, run, write
from studies.measure import measured
from studies.table import row


@pytest.fixture
def small():
    return replace(
        STUDIES["wrap-errors"](), snr=(0.0, 10.0), looks=(9,), relative_bandwidth=(0.3,), trials=300, block_trials=100
    )


@pytest.mark.parametrize("how", [Run(jobs=2), Run(jobs=2, backend="threading"), Run(jobs=1, backend="loky")])
def test_the_table_does_not_depend_on_how_it_ran(small, how):
    plain = run(small, Run(jobs=1, backend="sequential")).table
    pd.testing.assert_frame_equal(
        run(small, how).table.drop(columns="seconds_per_pixel"),
        plain.drop(columns="seconds_per_pixel"),
        check_exact=True,
    )


def test_points_and_estimators_that_are_added_change_no_others(small):
    one = run(replace(small, snr=(10.0,)), Run(methods=("cross-correlation",), jobs=1)).table
    two = run(small, Run(jobs=1)).table
    same = two[(two.snr_db == 10.0) & (two.estimator == "cross-correlation")].reset_index(drop=True)
    pd.testing.assert_frame_equal(
        one.drop(columns="seconds_per_pixel"), same.drop(columns="seconds_per_pixel"), check_exact=True
    )


def test_another_seed_gives_other_numbers(small):
    first, second = (run(small, Run(jobs=1, seed=seed)).table for seed in (1, 2))
    assert not np.allclose(first.rmse, second.rmse, rtol=1e-6)


def test_seeds_differ_by_point_block_and_stream():
    draws = {
        seeds.generator(1, {"a": a}, block, stream).integers(2**63)
        for a in (1, 2)
        for block in (0, 1)
        for stream in (0, 1)
    }
    assert len(draws) == 8
    assert seeds.generator(1, {"a": 1, "b": 2}, 0).integers(2**63) == seeds.generator(1, {"b": 2, "a": 1}, 0).integers(
        2**63
    )


def test_what_is_written_reads_back(small, tmp_path):
    how = Run(jobs=1)
    result = run(small, how)
    paths = write(small, how, result, tmp_path / "wrap-errors")
    assert all(path.stat().st_size > 0 for path in paths)
    assert {path.name for path in paths} == {"manifest.json", "table.csv", "wrap-rate.png", "std-over-crlb.png"}
    table = pd.read_csv(tmp_path / "wrap-errors" / "table.csv")
    pd.testing.assert_frame_equal(table, result.table, check_exact=False, check_dtype=False)
    manifest = json.loads((tmp_path / "wrap-errors" / "manifest.json").read_text())
    assert manifest["run"]["seed"] == 2026
    assert manifest["parameters"]["snr"] == [0.0, 10.0]


def test_failed_estimates_are_counted_and_in_no_other_statistic():
    facts = {"wrap": 2.0, "crlb": 0.1}
    errors = np.array([[0.2], [-0.2], [np.nan], [4.0]])
    found = row({"point": 1}, [measured({"estimator": "x"}, facts, errors, 3.0, 1.0)])
    assert found["trials"] == 4
    assert found["failures"] == 1
    assert found["wrap_errors"] == 1
    assert found["wrap_rate"] == found["outlier_rate"] == pytest.approx(1 / 3)
    assert found["delay_std_in_wrap"] == pytest.approx(0.2)
    assert found["std_over_crlb"] == pytest.approx(2.0)
    assert found["rmse"] == pytest.approx(np.sqrt((0.04 + 0.04 + 16.0) / 3))
