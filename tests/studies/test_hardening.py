"""What may go wrong around a run: other processes, few open files, code that changes, estimators that misbehave."""

import fcntl
import multiprocessing
import resource
from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

from estimators import CrossCorrelation
from sim import SONARS
from studies import engine, report
from studies.attempt import attempt
from studies.design import points, task
from studies.engine import Run
from studies.measure import echoes

PLAIN = Run(jobs=1, backend="sequential")


def read_and_compact_with_few_files(store, point, most):
    resource.setrlimit(resource.RLIMIT_NOFILE, (most, most))
    assert len(list(store.read(point))) == 300
    store.compact(point)


def test_few_open_files_lose_nothing(small, tmp_path, monkeypatch):
    study = small.of_estimators(["split-spectrum"]).with_values(
        {"patch.snr": [10], "trials.block": 3, "trials.count": 900}
    )
    monkeypatch.setattr(engine._Lack, "tidy", lambda self, store: None)
    engine.run(study, PLAIN, tmp_path)
    point = next(points(study))
    store = engine.store_of(study, 2026, tmp_path)
    assert len(list(store.folder.iterdir())) == 300
    process = multiprocessing.get_context("fork").Process(
        target=read_and_compact_with_few_files, args=(store, point, 64)
    )
    process.start()
    process.join()
    assert process.exitcode == 0
    found = engine.store_of(study, 2026, tmp_path)
    assert len(list(found.folder.iterdir())) == 1
    assert [block for block, _ in found.read(point)] == list(range(300))


def test_a_folder_has_one_writer(small, tmp_path):
    with (tmp_path / ".lock").open("w") as held:
        fcntl.flock(held, fcntl.LOCK_EX)
        with pytest.raises(OSError, match=r"is in use by another run; wait for it, or take another --out$"):
            engine.run(small, PLAIN, tmp_path)
    engine.run(small, PLAIN, tmp_path)


class RaisesAtSome(CrossCorrelation):
    """Raises where any record begins with a large value."""

    def estimate(self, pair):
        if (np.abs(pair.primary[:, 0]) > 1.8).any():
            raise RuntimeError("too bright")
        return super().estimate(pair)


class Overwrites(CrossCorrelation):
    """Writes into its input."""

    def estimate(self, pair):
        pair.primary[...] = 0
        return super().estimate(pair)


class OfAnotherType(CrossCorrelation):
    """Gives complex delays."""

    def estimate(self, pair):
        found = super().estimate(pair)
        return replace(found, delay=found.delay + 0j)


@pytest.fixture
def block(small):
    study = small.with_values({"trials.count": 2000, "trials.block": 2000})
    point = next(points(study))
    return study, echoes(task(study, point, 0), 2000, 2026), engine.methods(study, point)[0].window


def test_only_the_trials_at_fault_fail_however_large_the_block(block):
    _, pair, window = block
    made = attempt(RaisesAtSome(window), pair, window)
    at_fault = np.flatnonzero(np.abs(pair.primary[:, 0]) > 1.8)
    # |p|^2 > 3.24 with probability exp(-3.24) = 3.9 %.
    assert 40 < at_fault.size < 120
    assert [failure.trial for failure in made.raised] == list(at_fault)
    good = np.setdiff1d(np.arange(2000), at_fault)
    plain = CrossCorrelation(window).estimate(pair)
    # A sum over a part of the rows may round otherwise.
    np.testing.assert_allclose(made.estimate.delay[good], plain.delay[good], rtol=1e-12)


@pytest.mark.parametrize(
    ("kind", "said"), [(Overwrites, "ValueError: assignment destination is read-only"), (OfAnotherType, "ValueError: ")]
)
def test_an_estimator_that_misbehaves_fails_and_changes_nothing(block, kind, said):
    _, pair, window = block
    before = pair.primary.tobytes()
    made = attempt(kind(window), pair, window)
    assert len(made.raised) == 2000
    assert all(failure.error.startswith(said) for failure in made.raised)
    assert pair.primary.tobytes() == before


def test_the_echoes_do_not_depend_on_how_a_sonar_is_written(small):
    by_name = next(points(small))
    sonar = SONARS["hisas-100khz"]
    spelt = {name: getattr(sonar, name) for name in ("centre_frequency", "baseline", "altitude", "sound_speed")}
    tree = small.model_dump(exclude_unset=True)
    tree["sonar"] = spelt
    by_number = next(points(type(small).model_validate(tree)))
    assert by_number.key == by_name.key
    tree["patch"]["sampling"] = "direct"
    assert next(points(type(small).model_validate(tree))).key == by_name.key


def test_a_default_that_is_changed_is_another_design(small, tmp_path):
    tree = small.model_dump(exclude_unset=True)
    del tree["patch"]["delay"]
    engine.run(type(small).model_validate(tree), PLAIN, tmp_path)
    with pytest.raises(ValueError, match=r"another design: patch\.delay was 0\.5, is 0\.2;"):
        engine.run(small.with_values({"patch.delay": 0.2}), PLAIN, tmp_path)
    with pytest.raises(ValueError, match=r"another design: sonar\.baseline was None, is 0\.5;"):
        engine.run(small.with_values({"sonar.baseline": 0.5}), PLAIN, tmp_path)


def test_an_estimator_whose_file_was_edited_is_another_design(small, tmp_path, monkeypatch):
    monkeypatch.syspath_prepend(tmp_path)
    module = tmp_path / "edited_estimator.py"
    module.write_text("from estimators import CrossCorrelation as Mine\n")
    own = tmp_path / "own_estimator.py"
    own.write_text("import estimators\n\n\nclass Mine(estimators.CrossCorrelation):\n    pass\n")
    study = small.with_values({"estimators": [{"name": "own", "method": "own_estimator:Mine"}]})
    engine.run(study, PLAIN, tmp_path / "out")
    engine.run(study, PLAIN, tmp_path / "out")
    own.write_text(own.read_text() + "\n# changed\n")
    with pytest.raises(ValueError, match=r"estimators\.own was .*source.*, is .*source"):
        engine.run(study, PLAIN, tmp_path / "out")


def test_what_is_missing_or_hidden_is_said(small, tmp_path):
    engine.run(small, PLAIN, tmp_path)
    store = engine.store_of(small, 2026, tmp_path)
    assert report.result(small, store).warnings == []
    longer = small.with_values({"trials.count": 500})
    assert report.result(longer, store).warnings[0].startswith("12 of 30 blocks are missing")
    one = small.with_values({"patch.snr": [0]})
    assert report.result(one, store).warnings == ["blocks of 1 other design points are stored and not shown"]


def test_columns_of_figures_are_checked_before_anything_runs(small):
    figure = {"name": "f", "x": "snr", "y": "wrap_rat"}
    with pytest.raises(ValueError, match=r"figure f has the column 'wrap_rat'; .* did you mean wrap_rate"):
        engine.check(small.with_values({"figures": [figure]}))
    with pytest.raises(ValueError, match="figures has two of the name 'f'"):
        small.with_values({"figures": [figure, figure]})


def test_intervals_of_dependent_trials_are_cautious():
    # 16 rows of 500 pixels of which 1 % err, all pixels of a row together in one row of a hundred: most studies see
    # nothing, and must not say that they know it to a ten-thousandth.
    from studies import statistics
    from studies.moments import of_errors

    nothing = of_errors(np.zeros((16, 500)), np.zeros((16, 500), dtype=bool))[0]
    # Wilson's interval of none of 16: z^2 / (16 + z^2).
    assert statistics.wilson(nothing, "wrong").high == pytest.approx(1.96**2 / (16 + 1.96**2), rel=1e-3)
    one = of_errors(np.zeros((1, 500)), np.zeros((1, 500), dtype=bool))[0]
    assert np.isnan(statistics.wilson(one, "wrong").high)
    rng, covered = np.random.default_rng(5), []
    for _ in range(2000):
        rates = rng.beta(1.0, 9.0, (8, 1))
        errors = 1.0 * (rng.random((8, 200)) < rates)
        found = statistics.wilson(of_errors(errors, errors > 2)[0], "wrong")
        covered.append(found.low <= 0.1 <= found.high)
    # 2,000 repetitions: a standard error of .5 %.
    assert np.mean(covered) > 0.925


def test_a_figure_of_one_column_of_panels_keeps_its_legend_within(small, tmp_path):
    engine.run(small, PLAIN, tmp_path)
    found = report.result(small, engine.store_of(small, 2026, tmp_path))
    figure = small.figures[0].drawn(found.table, found.examples)
    figure.canvas.draw()
    legend = figure.legends[0].get_window_extent()
    assert legend.x0 >= 0
    assert legend.x1 <= figure.bbox.width
    assert isinstance(found.table, pd.DataFrame)
