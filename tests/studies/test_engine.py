"""The engine: nothing lost, nothing double, the same bits everywhere."""

import errno
import multiprocessing
import os
import resource
import signal
import subprocess
import time

import numpy as np
import pandas as pd
import pyarrow.parquet as pq
import pytest

from estimators import CrossCorrelation
from studies import catalogue, engine, manifest, report, seeds, shards
from studies.blocks import Store
from studies.design import points, task
from studies.engine import Run, Share

PLAIN = Run(jobs=1, backend="sequential")


@pytest.mark.parametrize("how", [Run(jobs=2), Run(jobs=2, backend="threading"), Run(jobs=1, backend="loky")])
def test_the_table_does_not_depend_on_how_it_ran(small, plain, table_of, tmp_path, how):
    pd.testing.assert_frame_equal(table_of(small, how, tmp_path / "other"), plain, check_exact=True)


def test_the_table_does_not_depend_on_the_order_of_the_blocks(small, plain, table_of, tmp_path, monkeypatch):
    in_order = engine._Lack.tasks

    def shuffled(self, study):
        found = list(in_order(self, study))
        np.random.default_rng(1).shuffle(found)
        return iter(found)

    monkeypatch.setattr(engine._Lack, "tasks", shuffled)
    pd.testing.assert_frame_equal(table_of(small, Run(jobs=1), tmp_path / "other"), plain, check_exact=True)


def test_a_second_run_computes_nothing(small, plain, table_of, tmp_path, monkeypatch):
    monkeypatch.setattr(engine, "measure", None)
    pd.testing.assert_frame_equal(table_of(small, PLAIN, tmp_path / "plain"), plain, check_exact=True)


def test_points_estimators_and_trials_come_later_as_well(small, plain, table_of, tmp_path):
    folder = tmp_path / "grown"
    first = small.with_values({"patch.snr": [10], "trials.count": 150})
    table_of(first.of_estimators(["split-spectrum"]), PLAIN, folder)
    more = first.with_values({"trials.count": 300})
    table_of(more.of_estimators(["cross-correlation", "split-spectrum"]), PLAIN, folder)
    pd.testing.assert_frame_equal(table_of(small, PLAIN, folder), plain, check_exact=True)


def test_a_short_block_has_the_first_trials_of_a_whole_one(small):
    point = next(points(small))
    whole, short = (
        engine.measure(task(small.with_values({"trials.count": n}), point, 0), [], 100, 1) for n in (100, 50)
    )
    assert not whole.measurements
    assert not short.measurements
    from studies.measure import echoes

    whole, short = (echoes(task(small.with_values({"trials.count": n}), point, 0), 100, 1) for n in (100, 50))
    np.testing.assert_array_equal(short.primary, whole.primary[:50])
    np.testing.assert_array_equal(short.truth.delay, whole.truth.delay[:50])


def test_another_seed_gives_other_numbers(small, plain, table_of, tmp_path):
    other = table_of(small, Run(jobs=1, seed=1), tmp_path / "other")
    assert not np.allclose(other.rmse, plain.rmse, rtol=1e-6)


def test_a_changed_design_is_refused_by_name(small, table_of, tmp_path):
    table_of(small, PLAIN, tmp_path)
    for values, how, message in [
        ({"patch.delay": 0.2}, PLAIN, "another design: patch.delay was 0.5, is 0.2; take --fresh"),
        ({"sonar.preset": "hisas-1032"}, PLAIN, "another design: sonar.preset was hisas-100khz, is hisas-1032;"),
        ({"trials.block": 50}, PLAIN, "another design: trials.block was 100, is 50;"),
        ({}, Run(jobs=1, seed=3), "another design: seed was 2026, is 3;"),
    ]:
        with pytest.raises(ValueError, match=message):
            engine.run(small.with_values(values), how, tmp_path)
    tree = small.model_dump(exclude_unset=True)
    tree["estimators"] = [{"name": "phase-slope", "method": "FullBandPhaseSlope", "options": {"refine": False}}]
    with pytest.raises(ValueError, match=r"estimators\.phase-slope was .*, is .*refine"):
        engine.run(small.with_values({"estimators": tree["estimators"]}), PLAIN, tmp_path)


def files_of(folder):
    return sorted(path for path in (folder / "blocks").iterdir())


def test_finished_points_are_one_file_each(small, plain, table_of, tmp_path):
    assert len(files_of(tmp_path / "plain")) == 2
    table_of(small.with_values({"trials.count": 500}), PLAIN, tmp_path / "plain")
    assert len(files_of(tmp_path / "plain")) == 2


def test_a_long_point_has_few_files_while_it_runs(small, table_of, tmp_path, monkeypatch):
    monkeypatch.setattr(engine, "LOOSE", 8)
    study = small.with_values({"patch.snr": [10], "trials.count": 640, "trials.block": 10})
    most = []

    def count(done, total):
        most.append(len(list((tmp_path / "a" / "blocks").glob("*"))) if done else 0)

    found = table_of(study.of_estimators(["split-spectrum"]), PLAIN, tmp_path / "a", progress=count)
    assert max(most) <= 8 + 64 // 8 + 1
    assert most[-1] == 1
    monkeypatch.setattr(engine, "LOOSE", 512)
    plain = table_of(study.of_estimators(["split-spectrum"]), PLAIN, tmp_path / "b")
    pd.testing.assert_frame_equal(found, plain, check_exact=True)


HARMS = {
    "cut off": lambda content, other: content[: len(content) // 2],
    "emptied": lambda content, other: b"",
    "bits flipped": lambda content, other: (
        content[:200] + bytes(byte ^ 0x55 for byte in content[200:260]) + content[260:]
    ),
    "of another point": lambda content, other: other,
    "not Parquet": lambda content, other: b"seconds,values\n",
}


@pytest.mark.parametrize("harm", HARMS)
def test_a_harmed_file_is_found_and_computed_again(small, plain, table_of, tmp_path, harm):
    path, other = files_of(tmp_path / "plain")
    path.write_bytes(HARMS[harm](path.read_bytes(), other.read_bytes()))
    store = engine.store_of(small, 2026, tmp_path / "plain")
    assert sum(len(list(store.read(point))) for point in points(small)) < 6
    pd.testing.assert_frame_equal(table_of(small, PLAIN, tmp_path / "plain"), plain, check_exact=True)


def test_a_number_that_was_changed_is_found(small, plain, table_of, tmp_path):
    path = files_of(tmp_path / "plain")[0]
    table = pq.read_table(path)
    column = table.schema.get_field_index("wrap_errors")
    forged = table.set_column(column, table.schema.field(column), [[n + 1 for n in table["wrap_errors"].to_pylist()]])
    pq.write_table(forged, path)
    pd.testing.assert_frame_equal(table_of(small, PLAIN, tmp_path / "plain"), plain, check_exact=True)


def test_blocks_of_another_design_are_not_used(small, plain, table_of, tmp_path):
    other = tmp_path / "other"
    table_of(small, Run(jobs=1, seed=5), other)
    for mine, foreign in zip(files_of(tmp_path / "plain"), files_of(other), strict=True):
        mine.write_bytes(foreign.read_bytes())
    pd.testing.assert_frame_equal(table_of(small, PLAIN, tmp_path / "plain"), plain, check_exact=True)


@pytest.mark.long
def test_runs_killed_at_random_moments_go_on_to_the_same_bits(small, table_of, tmp_path):
    larger = small.with_values({"trials.count": 4000, "trials.block": 50})
    plain = table_of(larger, PLAIN, tmp_path / "plain")
    how, folder, rng = Run(jobs=2, backend="threading"), tmp_path / "killed", np.random.default_rng(5)
    context = multiprocessing.get_context("forkserver")
    context.set_forkserver_preload(["studies.engine", "studies.catalogue"])

    def stored():
        return len(list((folder / "blocks").glob("*-*.parquet")))

    kills = 0
    while kills < 20:
        process = context.Process(target=engine.run, args=(larger, how, folder))
        enough = stored() + rng.integers(0, 6)
        process.start()
        while process.is_alive() and stored() < enough:
            time.sleep(0.001)
        time.sleep(rng.uniform(0.0, 0.02))
        process.kill()
        process.join()
        kills += process.exitcode == -signal.SIGKILL
        assert process.exitcode in (-signal.SIGKILL, 0)
    assert stored() > 20
    pd.testing.assert_frame_equal(table_of(larger, how, folder), plain, check_exact=True)
    assert not list((folder / "blocks").glob(".*"))


def test_a_killed_worker_costs_its_block_only(small, table_of, tmp_path):
    killed = []

    def kill_one(done, total):
        if done == 2 and not killed:
            listed = subprocess.run(
                ["ps", "-ww", "-o", "pid,args", "--ppid", str(os.getpid())], capture_output=True, text=True, check=True
            ).stdout.splitlines()
            killed.extend(int(line.split()[0]) for line in listed if "popen_loky_posix" in line)
            os.kill(killed[0], signal.SIGKILL)

    longer = small.with_values({"trials.count": 900})
    found = table_of(longer, Run(jobs=2), tmp_path / "other", progress=kill_one)
    assert killed
    pd.testing.assert_frame_equal(found, table_of(longer, PLAIN, tmp_path / "plain"), check_exact=True)


def no_space(*_):
    raise OSError(errno.ENOSPC, "No space left on device")


def test_a_full_disk_is_an_error_and_the_next_run_goes_on(small, plain, table_of, tmp_path, monkeypatch):
    with monkeypatch.context() as full:
        write = Store.write

        def until_full(self, what, block):
            if what.point.number == 1:
                full.setattr("studies.blocks.pq.ParquetWriter", no_space)
            write(self, what, block)

        full.setattr(Store, "write", until_full)
        with pytest.raises(OSError, match="No space left on device"):
            engine.run(small, PLAIN, tmp_path / "full")
    monkeypatch.setattr(engine, "measure", refuse_the_first_point(engine.measure))
    pd.testing.assert_frame_equal(table_of(small, PLAIN, tmp_path / "full"), plain, check_exact=True)


def refuse_the_first_point(measure):
    def only_others(what, *rest):
        assert what.point.number > 0, "what is stored is not measured again"
        return measure(what, *rest)

    return only_others


def limited_run(study, folder, most_bytes):
    resource.setrlimit(resource.RLIMIT_FSIZE, (most_bytes, most_bytes))
    signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    try:
        engine.run(study, PLAIN, folder)
    except OSError:
        os._exit(17)


def test_a_file_that_the_system_refuses_leaves_nothing_half_written(small, plain, table_of, tmp_path):
    # A limit on the size of a file is refused by the kernel half-way through the write, as a full disk is.
    process = multiprocessing.get_context("fork").Process(target=limited_run, args=(small, tmp_path / "x", 6000))
    process.start()
    process.join()
    assert process.exitcode == 17
    blocks = tmp_path / "x" / "blocks"
    assert not blocks.exists() or not [path for path in blocks.iterdir() if not path.name.endswith(".traces.parquet")]
    pd.testing.assert_frame_equal(table_of(small, PLAIN, tmp_path / "x"), plain, check_exact=True)


def test_shards_are_joined_to_the_same_bits_and_what_is_missing_is_listed(small, plain, table_of, tmp_path):
    parts = [tmp_path / f"part-{k}" for k in (1, 2, 3)]
    for k, part in enumerate(parts, 1):
        engine.run(small, Run(jobs=1, backend="sequential", share=Share(k, 3)), part)
    missing = shards.merge(tmp_path / "whole", parts[:2])
    assert list(zip(missing.point, missing.block, strict=True)) == [(0, 2), (1, 2)]
    assert shards.merge(tmp_path / "whole", parts[2:]).empty
    found = report.result(small, engine.store_of(small, 2026, tmp_path / "whole")).table
    pd.testing.assert_frame_equal(found.drop(columns="seconds_per_pixel"), plain, check_exact=True)
    other = tmp_path / "other"
    engine.run(small, Run(jobs=1, backend="sequential", seed=9), other)
    with pytest.raises(ValueError, match="another design: seed was 2026, is 9"):
        shards.merge(tmp_path / "whole", [other])


def test_seeds_differ_by_point_block_and_stream():
    draws = {
        seeds.generator(root, {"a": a, "b": b}, block, stream).random()
        for root in (1, 2)
        for a in (1, 2)
        for b in (1, 2)
        for block in (0, 1)
        for stream in (0, 1)
    }
    assert len(draws) == 32
    again = seeds.generator(1, {"b": 1, "a": 1}, 0).random()
    assert again == seeds.generator(1, {"a": 1, "b": 1}, 0).random()


def test_a_seed_is_that_of_the_words_of_the_digest():
    import hashlib
    import json

    point = {"a": 1.5, "b": [1, 2]}
    text = json.dumps(point, sort_keys=True, separators=(",", ":"))
    digest = hashlib.sha256(text.encode()).digest()
    words = [int.from_bytes(digest[4 * i : 4 * i + 4], "big") for i in range(4)]
    sequence = np.random.SeedSequence(2**127 + 3, spawn_key=(*words, 7, 1))
    expected = np.random.Generator(np.random.Philox(sequence)).random()
    assert seeds.generator(2**127 + 3, point, 7, 1).random() == expected


def test_the_manifest_says_where_the_numbers_come_from(small, plain, tmp_path):
    found = manifest.read(tmp_path / "plain")
    assert found["seed"] == 2026
    assert {"study", "fixed", "digest", "runs"} <= set(found)
    (here,) = found["runs"]
    assert {"commit", "python", "machine", "numpy", "finufft"} <= set(here)
    assert found["fixed"]["trials.block"] == 100
    assert manifest.study_of(tmp_path / "plain") == (small, 2026)


def test_traces_of_a_scene_come_back(tmp_path):
    study = catalogue.study("box-scene").with_values({"scene.ground_range": [30, 60], "scene.features": []})
    study = study.of_estimators(["interferogram"]).with_values({"trials.count": 2, "scene.snr": [15]})
    engine.run(study, PLAIN, tmp_path)
    point = next(points(study))
    found = engine.store_of(study, 2026, tmp_path).read_traces(point)
    direct = engine.measure(task(study, point, 0), engine.methods(study, point), 2, 2026).traces
    assert set(found) == set(direct) == {"slant range", "truth", "interferogram 1x1"}
    for name, values in direct.items():
        np.testing.assert_array_equal(found[name], values)


class Broken(CrossCorrelation):
    """Raises where it meets a certain kind of record, and gives no number for another."""

    def estimate(self, pair):
        from dataclasses import replace

        first = pair.primary[:, 0].real
        if (first > 1.5).any():
            raise RuntimeError("too\nbright")
        found = super().estimate(pair)
        return replace(found, delay=np.where(first[:, None] < -1.5, np.nan, found.delay))


@pytest.fixture
def with_broken(small):
    sections = small.model_dump(exclude_unset=True)["estimators"]
    return small.with_values({"estimators": [*sections, {"name": "broken", "method": f"{__name__}:Broken"}]})


def at_fault(study, bright):
    """Point, block and trial of the records that the broken estimator cannot take."""
    from studies.measure import echoes

    found = []
    for point in points(study):
        for block in range(3):
            first = echoes(task(study, point, block), 100, 2026).primary[:, 0].real
            found += [(point.number, block, int(t)) for t in np.flatnonzero(first > 1.5 if bright else first < -1.5)]
    return found


def test_an_estimator_that_fails_becomes_rows_and_the_study_goes_on(small, plain, with_broken, tmp_path):
    engine.run(with_broken, PLAIN, tmp_path)
    found = report.result(with_broken, engine.store_of(with_broken, 2026, tmp_path))
    others = found.table[found.table.estimator != "broken"].drop(columns="seconds_per_pixel").reset_index(drop=True)
    pd.testing.assert_frame_equal(others, plain, check_exact=True)
    raised, nameless = (at_fault(small, bright) for bright in (True, False))
    assert raised
    assert nameless
    failures = found.failures
    assert (failures.estimator == "broken").all()
    by_error = failures.assign(point=failures.snr.map({0.0: 0, 10.0: 1})).groupby("error")
    for error, expected in (("RuntimeError: too bright", raised), ("not a finite number", nameless)):
        rows = by_error.get_group(error)
        assert list(zip(rows.point, rows.block, rows.trial, strict=True)) == expected
    broken = found.table[found.table.estimator == "broken"]
    assert broken.failures.sum() == len(raised) + len(nameless)
    assert list(broken.trials) == [300, 300]
    assert broken.failure_rate.iloc[0] == broken.failures.iloc[0] / 300
    # Trials that did not fail are those of the estimator that does not.
    good = found.table[found.table.estimator == "cross-correlation"]
    assert np.all(broken.wrap_errors.to_numpy() <= good.wrap_errors.to_numpy())
    report.write(with_broken, found, tmp_path)
    assert len(pd.read_csv(tmp_path / "failures.csv")) == len(failures)


def test_fail_fast_ends_at_the_first_failure_and_keeps_what_is_done(small, with_broken, plain, tmp_path, table_of):
    table_of(small, PLAIN, tmp_path / "x")
    with pytest.raises(ValueError, match=r"^broken 1x9 failed at .*, block \d, trial \d+: "):
        engine.run(with_broken, Run(jobs=1, backend="sequential", fail_fast=True), tmp_path / "x")
    pd.testing.assert_frame_equal(table_of(small, PLAIN, tmp_path / "x"), plain, check_exact=True)
