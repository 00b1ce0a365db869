"""The study of what settings cost and gain."""

import numpy as np
import pandas as pd
import pytest

from estimators import FixedWindow, Interferogram
from sim import SONARS
from studies import catalogue, engine, report
from studies.catalogue import speed_accuracy
from studies.catalogue.speed_accuracy_figures import pareto, pareto_wraps
from studies.patch import Patch
from studies.settings import WIDE, expected_wrap_rate, settings

SONAR = SONARS["hisas-100khz"]

MEASURED = ["seconds_per_pixel", "seconds_low", "seconds_high", "copies", "copies_low", "copies_high"]
MEASURED += ["peak_bytes_per_pixel", "dominated", "beaten_by"]

COLUMNS = """
estimator setting seconds_per_pixel seconds_low seconds_high copies peak_bytes_per_pixel delay_bias delay_std_in_wrap
delay_std_in_wrap_se crlb std_over_crlb wrap_errors wrap_rate wrap_rate_low wrap_rate_high predicted_wrap_rate rmse
rmse_se rmse_over_crlb trials dominated beaten_by
"""


@pytest.fixture(scope="module")
def tables():
    """Twice the same, at one window and coherence."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(speed_accuracy, "COHERENCES", (0.9,))
        patch.setattr(speed_accuracy, "LOOKS", (9,))
        patch.setattr(speed_accuracy, "REPEATS", 1)
        return [speed_accuracy.measure(SONAR, 12, np.random.default_rng(7)) for _ in range(2)]


def test_all_but_what_is_measured_is_the_same_to_the_bit(tables):
    assert set(COLUMNS.split()) <= set(tables[0].columns)
    rest = tables[0].columns.difference(MEASURED)
    pd.testing.assert_frame_equal(tables[0][rest], tables[1][rest], check_exact=True)


def test_every_method_and_knob_is_there(tables):
    found = tables[0][tables[0].of == "estimator"]
    assert found.estimator.nunique() == 7
    for words in ("lags", "search", "no refinement", "bands", "b = ", "complex64"):
        assert found.setting.str.contains(words, regex=False).any(), words
    simulator = tables[0][tables[0].of == "simulator"].set_index("setting")
    # The non-uniform transforms are as accurate as they say, to a factor of a few (sim.Plan).
    for accuracy in (1e-4, 1e-2):
        assert 0.1 * accuracy < simulator.series_error[f"accuracy {accuracy:g}"] < 2 * accuracy
    assert simulator.series_error["accuracy 1e-12"] < 2e-12
    # Half the digits of single precision, 2^-24, in root mean square.
    assert simulator.series_error["complex64"] < 3e-7


def test_who_beats_whom_is_what_the_table_says(tables):
    found = tables[0][tables[0].of == "estimator"].reset_index(drop=True)
    names = found.estimator + ", " + found.setting
    for row, name in zip(found.itertuples(), names, strict=True):
        strictly = found[(found.seconds_per_pixel < row.seconds_per_pixel) & (found.rmse < row.rmse)]
        assert row.dominated or strictly.empty, name
        if row.dominated:
            (by,) = found[names == row.beaten_by].itertuples()
            assert by.seconds_per_pixel <= row.seconds_per_pixel
            assert by.rmse < 1.01 * row.rmse


def test_statistics_are_those_of_the_errors(tables):
    # An interferogram of delays within 1.5 wraps is right for a third of them; 12 rows, false alarm 1e-6.
    row = tables[0].iloc[0]
    assert (row.estimator, row.setting, row.trials) == ("interferogram", "default", 12 * 28)
    assert row.wrap_errors == pytest.approx(row.wrap_rate * row.trials)
    assert abs(row.wrap_rate - 2 / 3) < 4.9 * np.sqrt(2 / 9 / 12)
    # sqrt((1 - g^2) / (2 N g^2)) over 2 pi sqrt(fc^2 + B^2 / 12), theory section 2.
    crlb = np.sqrt(0.19 / (18 * 0.81)) / (2 * np.pi * np.sqrt(1e10 + 9e8 / 12))
    assert row.crlb == pytest.approx(crlb)
    assert row.rmse_over_crlb == pytest.approx(row.rmse / crlb)


def test_figures_and_answer(tables):
    table = tables[0]
    said = speed_accuracy.answer(table)
    assert "at 9 looks and a coherence of 0.9" in said
    found = table[table.of == "estimator"]
    assert f"{found.dominated.sum()} of {len(found)} settings are beaten" in said
    for draw in (pareto, pareto_wraps):
        (panel,) = draw(table, []).axes
        (listed,) = (text.get_text() for text in panel.texts if "\n" in text.get_text() or "," in text.get_text())
        front = found[~found.dominated].sort_values("seconds_per_pixel")
        assert listed.splitlines() == [f"{n} {r.estimator}, {r.setting}" for n, r in enumerate(front.itertuples(), 1)]


def test_the_shipped_study_can_be_run(tables):
    study = catalogue.study("speed-accuracy")
    assert engine.check(study) == []
    found = report.Result(tables[0], pd.DataFrame(), pd.DataFrame(), [])
    assert found.warnings == []
    assert len(report.summary(study, found)) == (~tables[0].dominated & (tables[0].of == "estimator")).sum()
    assert study.for_a_first_look().experiment.rows < study.experiment.rows


@pytest.mark.parametrize("looks", [3, 4, 5, 8, 33])
def test_every_setting_fits_the_window(looks):
    found = settings(SONAR, looks, delay=0.5)
    assert len({one.name for one in found}) == len(found)
    for one in found:
        held = looks if one.wide == 1 else WIDE * looks | 1
        patch = Patch(looks=held, coherence=0.9)
        record = FixedWindow(*patch.record())
        estimator = one.build(record if one.wide == 1 else FixedWindow(1, looks), record)
        pair = patch.simulate(SONAR, 3, np.random.default_rng(1))
        assert np.isfinite(estimator.estimate(pair).delay).all(), one.name


def test_an_interferogram_errs_where_phase_and_delay_leave_the_wrap():
    estimator = Interferogram(FixedWindow(1, 9))
    # Of three wraps it takes one to be right: what is carried out of it over its edges is carried in as often.
    assert expected_wrap_rate(estimator, 9, 0.7, SONAR, 1.5) == pytest.approx(2 / 3, abs=1e-6)
    # Without coherence any phase is as likely: E|phase| / 2 pi = 1/4.
    assert expected_wrap_rate(estimator, 9, 0.0, SONAR, 0.5) == pytest.approx(0.25, abs=1e-6)
    # With many looks the phase is normal with the spread of the bound: E|phase| = sqrt(2 / pi) sigma.
    sigma = np.sqrt((1 - 0.81) / (2 * 2000 * 0.81))
    expected = np.sqrt(2 / np.pi) * sigma / (2 * np.pi)
    assert expected_wrap_rate(estimator, 2000, 0.9, SONAR, 0.5) == pytest.approx(expected, rel=2e-3)
    assert expected_wrap_rate(estimator, 9, 0.7, SONAR, 0.0) == 0.0
