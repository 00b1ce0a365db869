"""What `results/` keeps is what today's code gives: every shipped study measured again, with other random numbers.

Each of the tests alarms falsely one time in ten million, however much it compares (`Surprises.beyond`): all together
one time in a million.
"""

import io
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from reproduced import Surprises, binomials, differences, matched, of_errors_given, of_trials

from studies import catalogue, engine, manifest, predict, report
from studies.catalogue.scaling_stages import sweeps
from studies.design import columns_of, points
from studies.parallel import one_thread
from studies.plans import DECISIONS
from studies.prediction import sonar_of
from studies.section import resolved
from studies.timing import peak_bytes

RESULTS = Path(__file__).parents[1] / "results"
FALSE_ALARM = 1e-7
SEED = 1865
"""Of the fresh runs; those that are kept have 2026."""

TIMES = ("second", "ratio", "exponent", "copies", "bytes", "times")
"""What the names of measured costs, and of what follows from them, hold."""

HERE = {
    *("box-scene", "calibration", "extremes", "long-range", "neighbours", "quality", "reliability", "scaling"),
    *("scene-plans", "snr-versus-range", "wrap-errors"),
}
"""Studies with a comparison of their own below."""

LABELS = (
    "of",
    "stage",
    "variable",
    "task",
    "method",
    "estimator",
    "window",
    "setting",
    "looks",
    "coherence",
    "number",
    "x",
)
"""Columns that tell rows of other studies apart, where they have them."""

SOME_POINTS = {key: list(values)[2::7] for axis in catalogue.study("calibration").axes for key, values in axis.items()}
"""Points of the calibration of all looks, bandwidths and rates."""

TRIALS = {
    "wrap-errors": {"patch.snr": [-4, 4, 12, 20], "trials.count": 500, "trials.block": 500},
    "calibration": {**SOME_POINTS, "trials.count": 1000, "trials.block": 1000},
    "box-scene": {"trials.count": 4},
    # Of 80 m along track 8 m, where there are neither marks nor slopes.
    "long-range": {"scene.features": [], "scene.ground_range": [394, 406], "trials.count": 400},
}
"""A smaller sweep of each study of trials."""

ONE_BAND = {"sonar.bandwidth": ["30 kHz"], "patch.snr": [-4, 0, 4, 8, 12, 16, 20]}


def kept(name):
    return pd.read_csv(RESULTS / name / "table.csv")


def as_kept(table):
    """A table as it is read again."""
    return pd.read_csv(io.StringIO(table.to_csv(index=False)))


def measured(study, folder):
    """The table of a study, with random numbers of the test."""
    engine.run(study, engine.Run(seed=SEED, jobs=1, backend="sequential"), folder)
    return as_kept(report.result(study, engine.store_of(study, SEED, folder)).table)


def as_run(name):
    return manifest.study_of(RESULTS / name)[0]


def labels(study):
    varied = {column for point in points(study) for column in columns_of(point.varied)}
    ranged = ["ground_range"] if study.scene is not None and study.scene.bins is not None else []
    return [*sorted(varied - {"snr_profile"}), *ranged, "estimator", "window", "region"]


@pytest.mark.parametrize("name", catalogue.NAMES)
def test_every_shipped_study_is_kept_as_it_is_now(name):
    study, _ = manifest.study_of(RESULTS / name)
    today = catalogue.study(name)
    assert any(resolved(study) == resolved(one) for one in (today, today.for_a_first_look()))
    assert not kept(name).empty
    for section in study.figures:
        assert (RESULTS / name / "figures" / f"{section.name}.png").is_file()


def test_nothing_else_is_kept():
    assert {path.name for path in RESULTS.iterdir()} == {*catalogue.NAMES, "predict"}


def test_levels_are_reproduced(tmp_path):
    fresh = measured(as_run("snr-versus-range"), tmp_path)
    pd.testing.assert_frame_equal(fresh, kept("snr-versus-range"), rtol=1e-9, atol=1e-12)


@pytest.mark.filterwarnings("ignore::sim.ValidityWarning")
def test_the_prediction_is_reproduced():
    table = kept("predict")
    for seabed, rows in table.groupby("seabed"):
        rows = rows.iloc[::20]
        fresh = predict(sonar_of("hisas-1032"), rows.ground_range, sediment=seabed).assign(seabed=seabed)
        pd.testing.assert_frame_equal(as_kept(fresh), rows.reset_index(drop=True), rtol=1e-6, atol=1e-300)


@pytest.fixture(scope="module")
def part(tmp_path_factory):
    """A third of the study of wrap errors."""
    study = as_run("wrap-errors").with_values({**TRIALS["wrap-errors"], **ONE_BAND})
    return measured(study, tmp_path_factory.mktemp("wrap-errors")), labels(as_run("wrap-errors"))


def test_a_part_of_the_trials_is_reproduced(part):
    fresh, on = part
    assert of_trials(kept("wrap-errors"), fresh, on).beyond(FALSE_ALARM) == []


SHIFTS = {
    "predicted_wrap_rate": lambda table: table.predicted_wrap_rate * 1.0001,
    "crlb": lambda table: table.crlb * 1.0001,
    "wrap_rate": lambda table: np.minimum(1.25 * table.wrap_rate, 1),
    "coverage": lambda table: table.coverage - 0.03,
    "outlier_rate": lambda table: np.minimum(table.outlier_rate + 0.01, 1),
    "claimed_wrap_rate": lambda table: np.minimum(1.2 * table.claimed_wrap_rate, 0.99),
    "delay_std_in_wrap": lambda table: 1.1 * table.delay_std_in_wrap,
    "delay_bias": lambda table: table.delay_bias + 0.15 * table.delay_std_in_wrap,
    "rmse": lambda table: 1.1 * table.rmse,
    "delay_std_total": lambda table: 1.1 * table.delay_std_total,
    "failure_rate": lambda table: 0.2,
    "flagged_rate": lambda table: np.minimum(table.flagged_rate + 0.2, 1),
}


@pytest.mark.parametrize("column", SHIFTS)
def test_a_shifted_column_is_found(column, part):
    fresh, on = part
    shifted = kept("wrap-errors").assign(**{column: SHIFTS[column]})
    found = of_trials(shifted, fresh, on).beyond(FALSE_ALARM)
    assert found
    assert all(what.startswith(column) for what in found)


def test_a_single_wrong_row_is_found(part):
    fresh, on = part
    table = kept("wrap-errors")
    row = table.index[(table.relative_bandwidth == 0.3) & (table.looks == 33) & (table.snr == 0)][0]
    table.loc[row, "delay_std_in_wrap"] *= 1.4
    assert len(of_trials(table, fresh, on).beyond(FALSE_ALARM)) == 1


@pytest.mark.long
@pytest.mark.parametrize(
    ("name", "estimators", "clusters"),
    [
        ("wrap-errors", [], None),
        ("calibration", [], None),
        # A cluster is a row; of the latter, that of a metre, of pixels of 2 cm.
        ("box-scene", [], lambda table: 16),
        ("long-range", ["phase"], lambda table: table.trials / 50),
    ],
)
def test_trials_are_reproduced(name, estimators, clusters, tmp_path):
    study = as_run(name).with_values(TRIALS[name]).of_estimators(estimators)
    fresh = measured(study, tmp_path)
    if "ground_range" in fresh:
        fresh = fresh[(fresh.ground_range > 396) & (fresh.ground_range < 404)]
    assert list(fresh.columns) == list(kept(name).columns)
    found = of_trials(kept(name), fresh, labels(study), clusters=clusters)
    assert len(found.found) > 100
    assert found.beyond(FALSE_ALARM) == []
    wrong = kept(name).assign(delay_std_in_wrap=kept(name).delay_std_in_wrap * 2)
    assert of_trials(wrong, fresh, labels(study), clusters=clusters).beyond(FALSE_ALARM)


def again(name, rows, times=1):
    """An experiment of few rows, done over and over: the mean of each number, and its standard error."""
    study = as_run(name).with_values({"experiment.rows": rows})
    sonar = study.sonar.sonar()
    runs = [study.experiment.model_copy(update={"seed": SEED + number}).table(sonar) for number in range(times)]
    assert list(as_kept(runs[0]).columns) == list(kept(name).columns)
    if times == 1:
        return as_kept(runs[0])
    numbers = [run.select_dtypes("number") for run in runs]
    mean = pd.DataFrame(np.mean(numbers, axis=0), columns=numbers[0].columns).assign(x=runs[0].x)
    error = pd.DataFrame(np.std(numbers, axis=0, ddof=1) / times**0.5, columns=mean.columns)
    return as_kept(pd.concat([runs[0].select_dtypes(exclude="number"), mean, error.add_suffix("_error")], axis=1))


@pytest.mark.long
def test_neighbours_are_reproduced():
    rows, times, on = 16, 14, ["estimator", "window", "what", "x"]
    both, found = matched(kept("neighbours"), again("neighbours", rows, times), on), Surprises()
    share = rows * times / as_run("neighbours").experiment.rows
    for column in ("value", "wrap_rate", "std"):
        value, fresh, error = (both[c].to_numpy() for c in (column, f"{column}_fresh", f"{column}_error"))
        z, p = differences(value, error * share**0.5, fresh, error, times - 1)
        found.add(column, both[np.isfinite(z)], on, p[np.isfinite(z)])
    assert found.beyond(FALSE_ALARM) == []


@pytest.mark.long
def test_quality_is_reproduced():
    """Areas under the ROC have a variance of `A (1 - A) / min(m, n)` at the most (Birnbaum and Klose 1957).

    Of pixels whose windows have a sample in common, and a resolution cell to either side, one counts.
    """
    on = ["scene", "estimator", "metric", "window"]
    both, found = (
        matched(kept("quality").fillna({"window": "1x17"}), again("quality", 8).fillna({"window": "1x17"}), on),
        Surprises(),
    )
    span = both.window.str.split("x").str[1].astype(int) + both.estimator.str.split("x").str[1].astype(int) + 4
    errors: dict[str, list] = {"right": [], "area": []}
    for end in ("", "_fresh"):
        right, pixels = both[f"right{end}"], both[f"pixels{end}"] / span
        errors["right"].append(np.sqrt(both.right * (1 - both.right) / pixels))
        errors["area"].append(np.sqrt(both.area * (1 - both.area) / (pixels * np.minimum(right, 1 - right))))
    for column, (error, error_fresh) in errors.items():
        p = differences(both[column].to_numpy(), error, both[f"{column}_fresh"].to_numpy(), error_fresh, np.inf)[1]
        found.add(column, both, on, p)
    assert found.beyond(FALSE_ALARM) == []


def test_what_estimates_say_of_themselves_is_reproduced():
    """Every number of it is a count, or a mean between two bounds."""
    on, study, rows = ["estimator", "looks", "coherence"], as_run("reliability"), 300
    small = study.with_values({"experiment.rows": rows, "experiment.seed": SEED})
    fresh, table, found = as_kept(small.experiment.table(small.sonar.sonar())), kept("reliability"), Surprises()
    assert list(fresh.columns) == list(table.columns)
    points = matched(
        *(of.drop_duplicates(on)[[*on, "wrap_rate", "claimed", "coverage", "right"]] for of in (table, fresh)), on
    )
    of, of_fresh = study.experiment.rows, rows
    wrong, wrong_fresh = (np.rint(points[c] * n) for c, n in (("wrap_rate", of), ("wrap_rate_fresh", of_fresh)))
    found.add("wrap_rate", points, on, binomials(wrong, of, wrong_fresh, of_fresh)[1])
    right, right_fresh = points.right, points.right_fresh
    covered, covered_fresh = np.rint(points.coverage * right), np.rint(points.coverage_fresh * right_fresh)
    found.add("coverage", points, on, binomials(covered, right, covered_fresh, right_fresh)[1])
    most = np.sqrt(points.claimed * (1 - points.claimed))
    errors = most / of**0.5, most / of_fresh**0.5
    found.add("claimed", points, on, differences(points.claimed, errors[0], points.claimed_fresh, errors[1], np.inf)[1])

    bins = table.merge(fresh, on=[*on, "low", "high"], suffixes=("", "_fresh"), how="outer")
    counts = bins[["estimates", "wrong_in_bin", "estimates_fresh", "wrong_in_bin_fresh"]].fillna(0).to_numpy().T
    found.add("estimates", bins, [*on, "low"], binomials(counts[0], of, counts[2], of_fresh)[1])
    found.add("wrong_in_bin", bins, [*on, "low"], binomials(counts[1], counts[0], counts[3], counts[2])[1])
    assert found.beyond(FALSE_ALARM) == []
    for column in ("claimed_in_bin", "claimed_in_bin_fresh"):
        assert (bins[column].isna() | bins[column].between(bins.low, bins.high)).all()


@pytest.mark.long
def test_what_holds_at_the_extremes_is_reproduced():
    """How many of the estimates are valid, in a wrong wrap, and outside their interval; what is refused, in its words.

    Too few valid ones, or rounding beside the limit, tell "invalid", "as claimed" and "exact" apart by chance.
    """
    study, on = as_run("extremes"), ["case", "value", "estimator"]
    small = study.with_values({"experiment.rows": 45, "experiment.seed": SEED})
    fresh, table = as_kept(small.experiment.table(small.sonar.sonar())), kept("extremes")
    assert list(fresh.columns) == list(table.columns)
    both = matched(table, fresh, on)
    assert len(both) == len(table)
    for verdict in ("fails", "refused"):
        np.testing.assert_array_equal(both.verdict == verdict, both.verdict_fresh == verdict)
    assert (both.said.fillna("") == both.said_fresh.fillna("")).all()

    def compared(of):
        found = Surprises()
        for column, total in (("valid", "estimates"), ("wrong", "valid"), ("outside", "sure")):
            rows = of.dropna(subset=[column])
            rows = rows[(rows[total] > 0) & (rows[f"{total}_fresh"] > 0)]
            counts = (rows[name].to_numpy() for name in (column, total, f"{column}_fresh", f"{total}_fresh"))
            found.add(column, rows, on, binomials(*counts)[1])
        return found.beyond(FALSE_ALARM)

    assert compared(both) == []
    for column in ("valid", "wrong", "outside"):
        assert compared(both.assign(**{column: 0}))


@pytest.mark.long
def test_the_memory_of_every_stage_is_reproduced():
    """Peaks of every size hardly depend on the echoes, by some 3 %; what Python's own objects take is below 16 kB."""
    study = as_run("scaling")
    kept_peaks = kept("scaling").query("of == 'memory'").groupby(["stage", "variable"], sort=False)
    peaks = {}
    with one_thread():
        for sweep in sweeps(study.sonar.sonar(), study.experiment.rows, np.random.default_rng(SEED)):
            if sweep.variable != "jobs":
                for case in sweep.cases:
                    case()
                peaks[sweep.stage, sweep.variable] = [peak_bytes(case) for case in sweep.cases]
    assert list(peaks) == [of for of, _ in kept_peaks]
    for of, rows in kept_peaks:
        np.testing.assert_allclose(peaks[of], rows.cost, rtol=0.05, atol=16e3, err_msg=str(of))
    assert set(kept("scaling").within.dropna()) == {"yes"}


@pytest.mark.long
@pytest.mark.parametrize("name", sorted(set(catalogue.NAMES) - HERE))
def test_other_studies_are_reproduced(name, tmp_path):
    study, table = as_run(name).for_a_first_look(), kept(name)
    if study.simulates:
        found = of_trials(table, measured(study, tmp_path), labels(study))
    else:
        study = study.with_values({"experiment.seed": SEED})
        fresh = as_kept(study.experiment.table(study.sonar.sonar()))
        assert list(fresh.columns) == list(table.columns)
        found = of_errors_given(table, fresh, [column for column in LABELS if column in table], TIMES)
    if name == "peers":
        add_peers(found, table, fresh, [8 * of.experiment.rows for of in (as_run(name), study)])
    assert found.beyond(FALSE_ALARM) == []


def add_peers(found, table, fresh, records):
    """Spreads and wrap rates of so many records; errors of what has no chance in it but the draw."""
    both, (of, of_fresh) = matched(table, fresh, ["task", "method"]), records
    delays = both[both.std_over_crlb.notna()]
    # Of a spread of n the standard error is 1 / sqrt(2 n) of itself.
    error, error_fresh = (delays.std_over_crlb / np.sqrt(2 * n) for n in records)
    values = delays.std_over_crlb, error, delays.std_over_crlb_fresh, error_fresh
    found.add("std_over_crlb", delays, ["method"], differences(*map(np.asarray, values), np.inf)[1])
    wrong, wrong_fresh = (np.rint(delays[c] * n) for c, n in (("wrap_rate", of), ("wrap_rate_fresh", of_fresh)))
    found.add("wrap_rate", delays, ["method"], binomials(wrong, of, wrong_fresh, of_fresh)[1])
    exact = both[both.task.isin(["phase slope", "echoes"]) & (both.error > 0)]
    # Over as many products and scatterers; the largest phase error of an image grows with its pixels.
    assert len(exact) == 5
    assert (np.abs(np.log(exact.error_fresh / exact.error)) < np.log(2)).all()


def test_a_shifted_table_of_an_experiment_is_found():
    rows = pd.DataFrame(
        {"method": list("abc"), "trials": 4000, "wrap_errors": [40, 400, 2000], "rmse": [1.0, 2.0, 3.0]}
    )
    rate, error = rows.wrap_errors / 4000, np.sqrt(rows.wrap_errors * (4000 - rows.wrap_errors) / 4000) / 4000
    rows = rows.assign(wrap_rate=rate, wrap_rate_low=rate - 1.96 * error, wrap_rate_high=rate + 1.96 * error)
    table = rows.assign(rmse_se=0.02 * rows.rmse, seconds=1.0, seconds_se=1e-3)
    fresh = table.assign(
        rmse=table.rmse * 1.03, wrap_rate=table.wrap_rate + np.array([0.002, -0.005, 0.012]), seconds=2.0
    )
    assert of_errors_given(table, fresh, ["method"], TIMES).beyond(FALSE_ALARM) == []
    for wrong in (table.assign(rmse=[1.0, 2.5, 3.0]), table.assign(wrap_rate=[0.035, 0.1, 0.5])):
        assert len(of_errors_given(wrong, fresh, ["method"], TIMES).beyond(FALSE_ALARM)) == 1


@pytest.mark.long
def test_what_plans_leave_out_is_reproduced(tmp_path):
    study, on = as_run("scene-plans"), ["scene", "near", "far"]
    small = study.with_values({"plans.rows": 10, "plans.repeats": 2, "plans.seed": SEED})
    fresh, table, found = measured(small, tmp_path), kept("scene-plans"), Surprises()
    assert list(fresh.columns) == list(table.columns)
    both = matched(table, fresh, on)
    # In more rows there may be more shadow.
    for name, swath in study.plans.scenes.items():
        plan = swath.required(study.sonar.sonar(), study.plans.rows)
        for decision in DECISIONS:
            assert set(table[table.scene == name][decision]) == {getattr(plan, decision)}
    share = (2 * 10) / (study.plans.repeats * study.plans.rows)
    for name in ("coherence", "delay", "level"):
        value, value_fresh = both[f"{name}_difference"], both[f"{name}_difference_fresh"]
        error, error_fresh = both[f"{name}_se"], np.fmax(both[f"{name}_se_fresh"], both[f"{name}_se"] / share**0.5)
        # The errors are by leaving out each of a hundred clusters of rows, or more.
        found.add(name, both, on, differences(value, error, value_fresh, error_fresh, 99)[1])
    assert len(both) == len(table)
    assert found.beyond(FALSE_ALARM) == []
    np.testing.assert_allclose(both.level_tolerance_fresh, both.level_tolerance, rtol=1e-12)
