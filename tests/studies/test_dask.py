"""Blocks on the workers of a real Dask scheduler on this machine."""

import pandas as pd
import pytest
from distributed import LocalCluster

from studies import engine
from studies.design import points
from studies.engine import Run


@pytest.fixture
def longer(small):
    return small.with_values({"trials.block": 50})


@pytest.fixture
def table(longer, table_of, tmp_path):
    return table_of(longer, Run(jobs=1, backend="sequential"), tmp_path / "one process")


def stored(study, folder):
    store = engine.store_of(study, 2026, folder)
    return sum(len(list(store.read(point))) for point in points(study))


def test_the_table_is_that_of_one_process(longer, table, table_of, tmp_path):
    with LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster:
        how = Run(backend="dask", scheduler=cluster.scheduler_address)
        found = table_of(longer, how, tmp_path / "dask")
    pd.testing.assert_frame_equal(found, table, check_exact=True)


def test_a_scheduler_that_does_not_answer_is_one_line_and_loses_nothing(small, table_of, tmp_path):
    table_of(small.with_values({"patch.snr": [0]}), Run(jobs=1), tmp_path)
    with pytest.raises(OSError, match=r"^the Dask scheduler tcp://127\.0\.0\.1:9 does not answer: .*stored$"):
        engine.run(small, Run(backend="dask", scheduler="tcp://127.0.0.1:9"), tmp_path)
    assert stored(small, tmp_path) == 3


def test_a_scheduler_that_goes_away_is_one_line_and_the_next_run_goes_on(longer, table, table_of, tmp_path):
    cluster = LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None)

    def close(done, total):
        if done == 3:
            cluster.close()

    how = Run(backend="dask", scheduler=cluster.scheduler_address)
    with pytest.raises(OSError, match=r"^the Dask scheduler .* does not answer: "):
        engine.run(longer, how, tmp_path / "dask", close)
    assert stored(longer, tmp_path / "dask") >= 3
    pd.testing.assert_frame_equal(table_of(longer, Run(jobs=1), tmp_path / "dask"), table, check_exact=True)
