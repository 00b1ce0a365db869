"""The statistics of a long study stream: memory does not grow with the blocks."""

import tracemalloc
from dataclasses import replace

import pytest

from studies import engine, report
from studies.blocks import Store
from studies.design import methods, points, task
from studies.stored import Stored


@pytest.fixture
def stored(small, tmp_path):
    """A store of many blocks at one point, all copies of one measurement."""

    def write(blocks):
        study = small.of_estimators(["split-spectrum"]).with_values(
            {"patch.snr": [10], "trials.block": 20, "trials.count": 20 * blocks}
        )
        store = engine.store_of(study, 2026, tmp_path / str(blocks))
        point = next(points(study))
        (measurement,) = engine.measure(task(study, point, 0), methods(study, point), 20, 2026).measurements
        store.folder.mkdir(parents=True)
        rows = (Stored(block, 20, measurement) for block in range(blocks))
        store._write(store.folder / f"{point.key}-000000-{blocks - 1:06d}.parquet", point, rows)
        return study, replace(store), measurement

    return write


def peak(study, store: Store):
    tracemalloc.start()
    try:
        table = report.result(study, store).table
        return table, tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()


def test_memory_does_not_grow_with_the_blocks(stored):
    (few, low), (many, high) = (peak(*stored(blocks)[:2]) for blocks in (1500, 6000))
    assert list(few.trials) == [30_000]
    assert list(many.trials) == [120_000]
    # What a reader takes is a batch of a thousand rows; beside it, a bit for every block.
    assert high < 1.2 * low + 16_000


def test_a_compacted_file_takes_little_room(stored):
    study, store, _ = stored(1500)
    (path,) = store.folder.iterdir()
    # A million blocks would take less than a gigabyte and a half for each estimator.
    assert path.stat().st_size / 1500 < 1500
    assert study.trials.count == 30_000
