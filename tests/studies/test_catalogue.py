"""What the shipped studies say, in numbers that are not theirs."""

import numpy as np
import pandas as pd
import pytest

from studies import catalogue, engine, report
from studies.catalogue import calibration
from studies.design import points
from studies.replay import one_block


@pytest.fixture(scope="module")
def levels(tmp_path_factory):
    study, folder = catalogue.study("snr-versus-range"), tmp_path_factory.mktemp("levels")
    engine.run(study, engine.Run(), folder)
    found = report.result(study, engine.store_of(study, 2026, folder))
    report.write(study, found, folder)
    return study, found, folder


def test_snr_of_a_seabed_varies_by_more_than_40_db_as_paper_b_says(levels):
    _, found, _ = levels
    by_seabed = found.table.groupby(["scattering", "sediment"]).snr_db
    assert len(by_seabed) == 8
    assert (by_seabed.max() - by_seabed.min()).max() > 40
    tuned = found.table.query("scattering == 'small-slope' and sediment == 'coarse sand' and ground_range == 400")
    assert tuned.snr_db.item() == pytest.approx(-6.4, abs=0.01)


def test_the_terms_of_the_sonar_equation_add_up(levels):
    table = levels[1].table
    gains = [
        "source_level",
        "transmit_beam",
        "receive_beam",
        "scattering_strength",
        "area",
        "pulse_gain",
        "aperture_gain",
    ]
    total = table[gains].sum(axis=1) - table[["spreading", "absorption", "noise_level"]].sum(axis=1)
    np.testing.assert_allclose(total, table.snr_db, atol=1e-9)
    np.testing.assert_allclose(table.spreading, 40 * np.log10(np.hypot(table.ground_range, 42.0)), atol=1e-9)


def test_a_computed_study_writes_what_others_do(levels):
    study, found, folder = levels
    for name in ("table.csv", "manifest.json", "report.html", "figures/snr.png", "figures/scattering-strength.png"):
        assert (folder / name).is_file()
    assert "coarse sand 65 dB (to -6.4 dB)" in report.answer(study, found)
    with pytest.raises(ValueError, match="has no trials; it has no blocks"):
        one_block(study, 1, 0, 0)


def test_calibration_has_200_points_and_more_and_names_what_fails():
    study = catalogue.study("calibration")
    assert len(list(points(study))) * len(study.estimators) >= 200
    rates = [0.5, 0.1, 1e-3, 1e-6]
    table = pd.DataFrame(
        {
            "estimator": "x",
            "looks": 9.0,
            "relative_bandwidth": [0.1, 0.3, 0.6, 0.6],
            "predicted_wrap_rate": rates,
            # Inside its interval; outside, but within 5 %; outside both; inside.
            "wrap_rate": [0.5, 0.104, 1.5e-3, 1.2e-6],
            "wrap_rate_low": [0.49, 0.102, 1.4e-3, 0.9e-6],
            "wrap_rate_high": [0.51, 0.106, 1.6e-3, 1.5e-6],
            "delay_std_in_wrap": [1.0, 1.0, 1.1, 0.9],
            "predicted_delay_std": 1.0,
        }
    )
    assert list(calibration.holds(table)) == [True, True, False, True]
    said = calibration.answer(table)
    assert "in the 95 % interval at 50% of 4 points, within it or 5 % of it at 75% (not at 1 of B/fc = 0.6)" in said
    assert "at worst 1.50, for 9 looks, B/fc = 0.6 and a rate of 1.5e-03" in said
    assert "0.90 to 1.10 times the predicted one" in said


@pytest.mark.long
@pytest.mark.parametrize(("name", "rows"), [("reliability", 40), ("quality", 5), ("neighbours", 10)])
def test_experiments_are_measured_again_with_the_same_numbers(name, rows, tmp_path):
    study = catalogue.study(name).with_values({"experiment.rows": rows})
    engine.run(study, engine.Run(), tmp_path)
    found, again = (report.result(study, engine.store_of(study, 2026, tmp_path)) for _ in range(2))
    pd.testing.assert_frame_equal(found.table, again.table)
    paths = report.write(study, found, tmp_path)
    assert (tmp_path / "report.html") in paths
    assert len(report.answer(study, found)) > 100
    assert not report.summary(study, found).empty
