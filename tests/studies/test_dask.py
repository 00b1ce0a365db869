"""Blocks on the workers of a real Dask scheduler on this machine."""

from dataclasses import replace

import pandas as pd
import pytest
from distributed import LocalCluster

from studies import engine, report
from studies.catalogue import STUDIES
from studies.engine import Run


@pytest.fixture
def small():
    return replace(
        STUDIES["wrap-errors"](), snr=(0.0, 10.0), looks=(9,), relative_bandwidth=(0.3,), trials=300, block_trials=50
    )


def table_of(study, how, folder):
    engine.run(study, how, folder)
    found = report.result(study, engine.store_of(study, how.seed, folder), tuple(study.methods())).table
    return found.drop(columns="seconds_per_pixel")


def test_the_table_is_that_of_one_process(small, tmp_path):
    plain = table_of(small, Run(jobs=1, backend="sequential"), tmp_path / "plain")
    with LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster:
        how = Run(backend="dask", scheduler=cluster.scheduler_address)
        found = table_of(small, how, tmp_path / "dask")
    pd.testing.assert_frame_equal(found, plain, check_exact=True)


def test_a_scheduler_that_does_not_answer_is_one_line_and_loses_nothing(small, tmp_path):
    first = replace(small, snr=(0.0,))
    table_of(first, Run(jobs=1), tmp_path)
    with pytest.raises(OSError, match=r"^the Dask scheduler tcp://127\.0\.0\.1:9 does not answer: .*stored$"):
        engine.run(small, Run(backend="dask", scheduler="tcp://127.0.0.1:9"), tmp_path)
    store = engine.store_of(small, 2026, tmp_path)
    assert all(store.read(task) for task in engine.tasks(first))


def test_a_scheduler_that_goes_away_is_one_line_and_the_next_run_goes_on(small, tmp_path):
    plain = table_of(small, Run(jobs=1, backend="sequential"), tmp_path / "plain")
    cluster = LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None)

    def close(done, total):
        if done == 3:
            cluster.close()

    how = Run(backend="dask", scheduler=cluster.scheduler_address)
    with pytest.raises(OSError, match=r"^the Dask scheduler .* does not answer: "):
        engine.run(small, how, tmp_path / "dask", close)
    stored = [task for task in engine.tasks(small) if engine.store_of(small, 2026, tmp_path / "dask").read(task)]
    assert len(stored) >= 3
    pd.testing.assert_frame_equal(table_of(small, Run(jobs=1), tmp_path / "dask"), plain, check_exact=True)
