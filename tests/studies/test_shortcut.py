"""The comparison of a shortcut with the full model, by echoes of which the answer is known."""

import numpy as np
import pandas as pd
import pytest

from sim import SONARS, EchoPair, Geometry, Truth
from studies import shortcut
from studies.catalogue.scene_plans import answer
from studies.plans import COLUMNS, Plans
from studies.swath import Swath

SONAR = SONARS["hisas-1032"]
RATE = 4 / 3 * SONAR.bandwidth
EDGES = np.array([60.0, 70.0, 80.0])


def pair_of(coherence, error, level, rng, rows=12):
    """A registered pair of a true delay of half a wrap and an error on it [wraps], of white speckle."""
    start, samples = 2 * np.hypot(60.0, SONAR.altitude) / SONAR.sound_speed, 64 * 10
    truth = np.full(samples, 0.5 * SONAR.wrap)
    first, second = rng.standard_normal((2, 2, rows, samples)) @ np.eye(samples) * np.sqrt(level / 2)
    primary, other = first[0] + 1j * first[1], second[0] + 1j * second[1]
    secondary = (coherence * primary + np.sqrt(1 - coherence**2) * other) * np.exp(-2j * np.pi * (0.5 + error))
    nothing = np.zeros(samples, dtype=bool)
    return EchoPair(
        primary,
        secondary,
        RATE,
        SONAR.centre_frequency,
        SONAR.bandwidth,
        truth=Truth(truth, truth, nothing, nothing, truth[None]),
        geometry=Geometry(SONAR, start),
        circular=True,
    )


def test_statistics_are_those_that_the_echoes_have():
    """Six standard errors, each from its own theory."""
    pair = pair_of(0.8, 0.03, 4.0, np.random.default_rng(2), rows=60)
    sums = shortcut._sums(pair, SONAR, EDGES)[:, 0]
    windows = int(sums[:, 0].real.sum())
    looks = 64 * windows
    (coherence, delay, level), errors = shortcut._jackknifed(sums)
    # Var |g| = (1 - g^2)^2 / 2N, var phase = (1 - g^2) / (2 g^2 N), and power of two series with the correlation g^2.
    expected = [0.36 / np.sqrt(2 * looks), 0.75 / np.sqrt(2 * looks) / 2 / np.pi]
    expected.append(10 / np.log(10) * np.sqrt((1 + 0.64) / (2 * looks)))
    for value, true, error in zip((coherence, delay, level), (0.8, 0.03, 10 * np.log10(4.0)), expected, strict=True):
        assert value == pytest.approx(true, abs=6 * error)
    # A spread of 15 clusters is known to 1 / sqrt(2 14).
    np.testing.assert_allclose(errors, expected, rtol=5 / np.sqrt(28))


def test_the_full_model_has_a_section_for_each_row():
    rough = {"kind": "roughness", "rms": 0.02, "seed": 1, "period": 6.4}
    swath = Swath(ground_range=(60.0, 64.0), features=(rough,), plan={"sections": "one"})
    assert swath.required(SONAR, 2).sections == "one"
    assert shortcut.in_full(swath).required(SONAR, 2).sections == "each"


def test_windows_of_what_is_hidden_do_not_count():
    pair = pair_of(1.0, 0.0, 1.0, np.random.default_rng(3))
    whole = shortcut._sums(pair, SONAR, EDGES)[:, 0, 0].real
    # Sample 70 lies in the second window of 64; the first ends 6 samples before, beyond two resolution cells.
    pair.truth.delay[70] = np.nan
    pair.primary[:, 70] = 1e6
    hidden = shortcut._sums(pair, SONAR, EDGES)[:, 0]
    assert (whole - hidden[:, 0].real == 4).all()
    assert shortcut._jackknifed(hidden)[0][2] == pytest.approx(0.0, abs=1.0)


def test_a_comparison_has_the_tolerances_of_the_plan():
    rng = np.random.default_rng(4)
    planned, full = (shortcut._sums(pair_of(0.8, e, 1.0, rng), SONAR, EDGES)[:, 0] for e in (0.05, 0.0))
    (found,) = shortcut._compared(planned, full, (60.0, 70.0), 0.1)
    assert found.difference[1] == pytest.approx(0.05, abs=6 * found.error[1])
    # .1 of 1 - g^2 times g; the root of .2 times the spread of 64 looks; 10 log10(1.1).
    assert found.tolerance[0] == pytest.approx(0.1 * 0.8 * 0.36, rel=0.1)
    assert found.tolerance[1] == pytest.approx(np.sqrt(0.2) * 0.75 / np.sqrt(128) / 2 / np.pi, rel=0.2)
    assert found.tolerance[2] == pytest.approx(0.41393, abs=1e-5)
    assert list(shortcut._compared(0 * planned, full, (60.0, 70.0), 0.1)) == []


def test_the_full_model_is_full():
    scene = Swath(ground_range=(60.0, 70.0), sediment="sand")
    plan = shortcut.in_full(scene).required(SONAR, 2)
    assert (plan.delays, plan.shadow, plan.baseline, plan.level) == ("scatterers", True, True, "local")
    assert scene.required(SONAR, 2).delays == "warp"


def test_a_table_of_plans():
    scenes = {
        "flat": {"ground_range": [60, 70], "sediment": "sand"},
        "box": {"ground_range": [60, 70], "features": [{"kind": "box", "start": 64, "width": 1, "height": 1}]},
    }
    plans = Plans(scenes=scenes, rows=4, repeats=2, parts=2)
    table = plans.table(SONAR)
    assert tuple(table.columns) == COLUMNS == tuple(plans.columns(SONAR))
    assert table.scene.tolist() == ["flat", "flat", "box", "box"]
    assert table.delays.tolist() == ["warp", "warp", "scatterers", "scatterers"]
    assert table.near.tolist() == [60, 65, 60, 65]
    for name in shortcut.STATISTICS:
        # Of three clusters at the least: Student's t of two degrees of freedom is within 100 but for 1e-4.
        assert (table[f"{name}_difference"].abs() < 100 * table[f"{name}_se"]).all()


def test_the_answer_names_what_is_furthest_off():
    values = dict.fromkeys(COLUMNS, 1.0) | {"scene": "flat", "delays": "warp", "ratio": 5.2}
    values |= {
        f"{name}_{of}": value for name in shortcut.STATISTICS for of, value in (("difference", 0.1), ("se", 0.2))
    }
    table = pd.DataFrame([values, values | {"delay_difference": -0.9, "delay_se": 0.3, "delay_tolerance": 3.0}])
    assert answer(table).startswith("flat: warp, 5.2 times cheaper, off by 0.3 (standard error 0.1), all")
