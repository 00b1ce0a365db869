"""Paper B's numbers from simulated echoes, 80 m along track at some ranges, over a flat floor."""

import numpy as np
import pytest

from estimators import bounds
from studies import catalogue, engine, report
from studies.drawing import SummarySection

FALSE_ALARM = 4.9
"""Standard errors that a normal deviate exceeds one time in a million."""

FIXED, ADAPTIVE = "9x9", "AdaptiveWindow(kappa=2.0)"


def stretch(near, far, folder):
    """The table of the study between two ranges, without relief, in the SNR profile that the paper implies."""
    bare = {"figures": (), "answer": None, "points": (), "summary": SummarySection()}
    study = catalogue.study("long-range").model_copy(update=bare)
    profile = [[320, -0.7], [400, -6.4]]
    study = study.with_values(
        {"scene.ground_range": [near, far], "scene.features": [], "scene.snr_profile": profile}
    ).of_estimators(["phase"])
    engine.run(study, engine.Run(jobs=1, backend="sequential"), folder)
    table = report.result(study, engine.store_of(study, 2026, folder)).table
    return table[(table.ground_range > near + 2) & (table.ground_range < far - 2)]


def pooled(rows):
    """Root mean square over metres of the measured spread, and its standard error."""
    square, error = rows.depth_std_in_wrap**2, 2 * rows.depth_std_in_wrap * rows.depth_std_in_wrap_se
    spread = np.sqrt(square.mean())
    # Windows reach into the next metre: neighbours count as one.
    return spread, np.sqrt(2 * (error**2).sum()) / len(rows) / (2 * spread)


@pytest.mark.long
def test_at_400_m_the_adaptive_window_gives_the_expected_39_cm(tmp_path):
    rows = stretch(392, 408, tmp_path).query("window == @ADAPTIVE")
    assert abs(rows.window_rows.mean() - 39) < 2
    measured, error = pooled(rows)
    rho = 10 ** ((-6.4 - 0.07125 * (rows.ground_range - 400)) / 10)
    gamma, slant = rho / (1 + rho), np.hypot(rows.ground_range, 42.0)
    exact = bounds.multilook_depth_std(rows.looks, gamma, 122e3, slant, 0.3, 1480.0)
    assert exact.mean() == pytest.approx(0.39, abs=0.02)
    assert abs(measured - exact.mean()) < FALSE_ALARM * error + 0.02 * exact.mean()
    assert measured == pytest.approx(exact.mean(), rel=0.1)


@pytest.mark.long
def test_the_fixed_window_crosses_50_cm_near_320_m(tmp_path):
    rows = stretch(306, 334, tmp_path).query("window == @FIXED")
    for spread in (rows.predicted_depth_std, rows.depth_std_in_wrap):
        slope, at_320 = np.polyfit(rows.ground_range - 320, spread, 1)
        assert abs((0.5 - at_320) / slope) < 10
