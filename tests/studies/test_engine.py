import json
import multiprocessing
import os
import signal
import subprocess
import time
from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

from estimators import CrossCorrelation
from studies import engine, manifest, report, seeds
from studies.catalogue import STUDIES, wrap_errors
from studies.engine import Run
from studies.measure import Attempt, measured
from studies.table import row


@pytest.fixture
def small():
    return replace(
        STUDIES["wrap-errors"](), snr=(0.0, 10.0), looks=(9,), relative_bandwidth=(0.3,), trials=300, block_trials=100
    )


def table_of(study, how, folder, **options):
    engine.run(study, how, folder, **options)
    methods = how.methods or tuple(study.methods())
    found = report.result(study, engine.store_of(study, how.seed, folder), methods).table
    return found.drop(columns="seconds_per_pixel")


@pytest.fixture
def plain(small, tmp_path):
    return table_of(small, Run(jobs=1, backend="sequential"), tmp_path / "plain")


@pytest.mark.parametrize("how", [Run(jobs=2), Run(jobs=2, backend="threading"), Run(jobs=1, backend="loky")])
def test_the_table_does_not_depend_on_how_it_ran(small, plain, tmp_path, how):
    pd.testing.assert_frame_equal(table_of(small, how, tmp_path / "other"), plain, check_exact=True)


def test_the_table_does_not_depend_on_the_order_of_the_blocks(small, plain, tmp_path, monkeypatch):
    order = engine.tasks(small)
    np.random.default_rng(1).shuffle(order)
    with monkeypatch.context() as shuffled:
        shuffled.setattr(engine, "tasks", lambda study: order)
        engine.run(small, Run(jobs=1), tmp_path / "other")
    pd.testing.assert_frame_equal(table_of(small, Run(jobs=1), tmp_path / "other"), plain, check_exact=True)


def test_a_second_run_computes_nothing(small, plain, tmp_path, monkeypatch):
    monkeypatch.setattr(engine, "measure", None)
    pd.testing.assert_frame_equal(table_of(small, Run(jobs=1), tmp_path / "plain"), plain, check_exact=True)


def test_points_estimators_and_trials_come_later_as_well(small, plain, tmp_path):
    folder = tmp_path / "grown"
    first = replace(small, snr=(10.0,), trials=200)
    table_of(first, Run(methods=("split-spectrum",), jobs=1), folder)
    table_of(replace(first, trials=300), Run(methods=("cross-correlation", "split-spectrum"), jobs=1), folder)
    pd.testing.assert_frame_equal(table_of(small, Run(jobs=1), folder), plain, check_exact=True)


def test_another_seed_gives_other_numbers(small, plain, tmp_path):
    other = table_of(small, Run(jobs=1, seed=1), tmp_path / "other")
    assert not np.allclose(other.rmse, plain.rmse, rtol=1e-6)


def test_a_changed_design_is_refused_by_name(small, tmp_path):
    table_of(small, Run(jobs=1), tmp_path)
    with pytest.raises(ValueError, match=r"another design: centre_frequency was 100000\.0, is 90000\.0; take --fresh"):
        engine.run(replace(small, centre_frequency=90e3), Run(jobs=1), tmp_path)
    with pytest.raises(ValueError, match="another design: seed was 2026, is 3;"):
        engine.run(small, Run(jobs=1, seed=3), tmp_path)


@pytest.mark.parametrize("harm", ["cut off", "emptied", "bits flipped", "of another block", "not Parquet"])
def test_a_harmed_block_file_is_found_and_computed_again(small, plain, tmp_path, harm):
    store = engine.store_of(small, 2026, tmp_path / "plain")
    first, second = engine.tasks(small)[:2]
    path, content = store.path(first), store.path(first).read_bytes()
    spoilt = {
        "cut off": content[: len(content) // 2],
        "emptied": b"",
        "bits flipped": content[:200] + bytes(byte ^ 0x55 for byte in content[200:260]) + content[260:],
        "of another block": store.path(second).read_bytes(),
        "not Parquet": b"seconds,values\n",
    }[harm]
    path.write_bytes(spoilt)
    assert store.read(first) == []
    pd.testing.assert_frame_equal(table_of(small, Run(jobs=1), tmp_path / "plain"), plain, check_exact=True)
    assert len(store.read(first)) == 3


def test_runs_killed_at_random_moments_go_on_to_the_same_bits(small, tmp_path):
    larger = replace(small, trials=4000, block_trials=50)
    plain = table_of(larger, Run(jobs=1, backend="sequential"), tmp_path / "plain")
    how, folder, rng = Run(jobs=2, backend="threading"), tmp_path / "killed", np.random.default_rng(5)
    context = multiprocessing.get_context("forkserver")
    context.set_forkserver_preload(["studies.engine", "studies.catalogue"])

    def stored():
        return len(list((folder / "blocks").glob("*-*.parquet")))

    for _ in range(20):
        process = context.Process(target=engine.run, args=(larger, how, folder))
        enough = stored() + rng.integers(0, 6)
        process.start()
        while process.is_alive() and stored() < enough:
            time.sleep(0.001)
        time.sleep(rng.uniform(0.0, 0.02))
        process.kill()
        process.join()
        assert process.exitcode == -signal.SIGKILL
    assert stored() > 20
    pd.testing.assert_frame_equal(table_of(larger, how, folder), plain, check_exact=True)


def test_a_killed_worker_costs_its_block_only(small, plain, tmp_path):
    killed = []

    def kill_one(done, total):
        if done == 2 and not killed:
            listed = subprocess.run(
                ["ps", "-ww", "-o", "pid,args", "--ppid", str(os.getpid())], capture_output=True, text=True, check=True
            ).stdout.splitlines()
            killed.extend(int(line.split()[0]) for line in listed if "popen_loky_posix" in line)
            os.kill(killed[0], signal.SIGKILL)

    found = table_of(replace(small, trials=900), Run(jobs=2), tmp_path / "other", progress=kill_one)
    assert killed
    plain = table_of(replace(small, trials=900), Run(jobs=1), tmp_path / "plain")
    pd.testing.assert_frame_equal(found, plain, check_exact=True)


def test_seeds_differ_by_point_block_and_stream():
    draws = {
        seeds.generator(1, {"a": a}, block, stream).integers(2**63)
        for a in (1, 2)
        for block in (0, 1)
        for stream in (0, 1)
    }
    assert len(draws) == 8
    first, second = (seeds.generator(1, point, 0) for point in ({"a": 1, "b": 2}, {"b": 2, "a": 1}))
    assert first.integers(2**63) == second.integers(2**63)


def test_a_seed_is_the_same_on_every_machine():
    # Philox of SeedSequence(1, spawn_key=(words of the SHA-256 of {"a":1}, 2, 0)), spelled out.
    words = [0x015ABD7F, 0x5CC57A2D, 0xD94B7590, 0xF04AD808]
    expected = np.random.Generator(np.random.Philox(np.random.SeedSequence(1, spawn_key=(*words, 2, 0))))
    assert seeds.generator(1, {"a": 1}, 2).integers(2**63) == expected.integers(2**63)


def test_what_is_written_reads_back(small, plain, tmp_path):
    folder = tmp_path / "plain"
    store = engine.store_of(small, 2026, folder)
    paths = report.write(small, report.result(small, store, tuple(small.methods())), folder)
    assert {path.name for path in paths} == {"table.csv", "wrap-rate.png", "std-over-crlb.png"}
    assert all(path.stat().st_size > 0 for path in paths)
    written = pd.read_csv(folder / "table.csv").drop(columns="seconds_per_pixel")
    pd.testing.assert_frame_equal(written, plain, check_dtype=False)
    made = json.loads((folder / "manifest.json").read_text())
    assert made["design"]["seed"] == 2026
    assert made["parameters"]["snr"] == [0.0, 10.0]
    assert manifest.restored(type(small), made["parameters"]) == small


def test_traces_of_the_box_scene_read_back(tmp_path):
    study = replace(STUDIES["box-scene"](), far=220.0, windows=(9,), trials=1, block_trials=1)
    how = Run(methods=("interferogram",), jobs=1)
    engine.run(study, how, tmp_path)
    task = engine.tasks(study)[0]
    found = engine.store_of(study, how.seed, tmp_path).read_traces(task)
    direct = engine.measure(study, task, how.methods, how.seed).traces
    assert set(found) == set(direct) == {"slant range", "truth", "interferogram 1x1"}
    for name, values in direct.items():
        np.testing.assert_array_equal(found[name], values)


def test_failed_estimates_are_counted_and_in_no_other_statistic():
    facts = {"wrap": 2.0, "crlb": 0.1}
    errors = np.array([[0.2], [-0.2], [np.nan], [4.0]])
    measurement = measured({"estimator": "x"}, facts, errors, 3.0, Attempt(errors, "", 1.0))
    assert measurement.failure == "trial 2: not a finite number"
    found = row({"point": 1}, measurement)
    assert found["trials"] == 4
    assert found["failures"] == 1
    assert found["wrap_errors"] == 1
    assert found["wrap_rate"] == found["outlier_rate"] == pytest.approx(1 / 3)
    assert found["delay_std_in_wrap"] == pytest.approx(0.2)
    assert found["std_over_crlb"] == pytest.approx(2.0)
    assert found["rmse"] == pytest.approx(np.sqrt((0.04 + 0.04 + 16.0) / 3))


class Broken(CrossCorrelation):
    """Raises at low SNR, gives no number for one record otherwise."""

    def estimate(self, pair):
        found = super().estimate(pair)
        if np.median(found.coherence) < 0.7:
            raise RuntimeError("too\nnoisy")
        delay = found.delay.copy()
        delay[7] = np.nan
        return replace(found, delay=delay)


@pytest.fixture
def with_broken(monkeypatch):
    monkeypatch.setattr(wrap_errors, "METHODS", {**wrap_errors.METHODS, "broken": Broken})


def test_an_estimator_that_fails_becomes_rows_and_the_study_goes_on(small, plain, tmp_path, with_broken):
    folder = tmp_path / "failing"
    engine.run(small, Run(jobs=1, backend="sequential"), folder)
    found = report.result(small, engine.store_of(small, 2026, folder), tuple(small.methods()))
    others = found.table[found.table.estimator != "broken"].drop(columns="seconds_per_pixel").reset_index(drop=True)
    pd.testing.assert_frame_equal(others, plain, check_exact=True)
    broken = found.table[found.table.estimator == "broken"].set_index("snr_db")
    assert broken.failures.to_dict() == {0.0: 300, 10.0: 3}
    assert broken.trials.to_dict() == {0.0: 300, 10.0: 300}
    assert np.isnan(broken.wrap_rate[0.0])
    assert broken.wrap_rate[10.0] < 0.2
    report.write(small, found, folder)
    failures = pd.read_csv(folder / "failures.csv")
    assert list(failures.block) == [0, 1, 2, 0, 1, 2]
    assert list(failures["first"])[2:4] == ["trial 0: RuntimeError: too noisy", "trial 7: not a finite number"]


def test_fail_fast_ends_at_the_first_failure_and_keeps_what_is_done(small, tmp_path, with_broken):
    engine.run(small, Run(methods=("cross-correlation",), jobs=1), tmp_path)
    with pytest.raises(ValueError, match=r"^broken 1x9 failed at .*0\.0.*, block 0, trial 0: RuntimeError: too noisy"):
        engine.run(small, Run(jobs=1, backend="sequential", fail_fast=True), tmp_path)
    store = engine.store_of(small, 2026, tmp_path)
    assert all(store.read(task) for task in engine.tasks(small))
