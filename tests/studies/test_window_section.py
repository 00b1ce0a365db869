"""Policies as windows of a study."""

import re
import tomllib

import numpy as np
import pytest

from estimators import AdaptiveWindow, FixedWindow, KnownCoherence, MeasuredCoherence, ModelledCoherence, WrapSafeWindow
from studies import engine
from studies.design import methods, points
from studies.replay import one_trial
from studies.study import made
from studies.window_section import PolicySection

SCENE = """
name = "windows"
question = "Which?"
[sonar]
preset = "hisas-1032"
[scene]
ground_range = [100, 104]
features = [{ kind = "box", start = 101.5, width = 1, height = 0.2 }]
snr = "10 dB"
[[estimators]]
name = "interferogram"
method = "Interferogram"
windows = [[3, 3], WINDOW]
[trials]
count = 40
block = 20
"""
ADAPTIVE = '{ policy = "adaptive", kappa = 1.0, largest = 9 }'


def study(window=ADAPTIVE):
    return made(tomllib.loads(SCENE.replace("WINDOW", window)), "mine")


def test_a_table_is_a_policy():
    tables = {
        ADAPTIVE: AdaptiveWindow(1.0, largest=9, coherence=MeasuredCoherence()),
        '{ policy = "adaptive", kappa = 2, first_window = [5, 7], smoothing = "50 cm" }': AdaptiveWindow(
            2.0, coherence=MeasuredCoherence(5, 7, smoothing=0.5)
        ),
        '{ policy = "wrap-safe", kappa = 0, max_wrap_probability = 0.1, sediment = "silt" }': WrapSafeWindow(
            0.0, 0.1, coherence=ModelledCoherence("silt")
        ),
    }
    for table, policy in tables.items():
        asked = study(table)
        fixed, varies = methods(asked, next(points(asked)))
        assert fixed.window == FixedWindow(3, 3)
        assert varies.window == policy
        # The same from what a manifest keeps of it.
        assert made(asked.model_dump(exclude_unset=True), "again") == asked
    known = PolicySection(policy="constant-std", std=0.1, coherence=0.5).window()
    assert isinstance(known.coherence, KnownCoherence)
    assert str(known) == "ConstantStdWindow(coherence=KnownCoherence(coherence=0.5, ground_range=0.0), std=0.1)"


@pytest.mark.parametrize(
    ("window", "message"),
    [
        ('{ policy = "adaptive" }', ": kappa is missing; policy 'adaptive' must have it"),
        (
            '{ policy = "adaptve", kappa = 1 }',
            ": policy = 'adaptve': it must be 'constant-std', 'adaptive' or 'wrap-safe'",
        ),
        (
            '{ policy = "adaptive", kapa = 1 }',
            ": kapa: there is no such key; it must be one of .* mean kappa\\?",
        ),
        ('{ policy = "adaptive", kappa = -1 }', ": kappa is -1; it must be above 0"),
        ('{ policy = "adaptive", kappa = 1, std = 1 }', ": std is given; policy 'adaptive' must have kappa alone"),
        ('{ policy = "adaptive", kappa = 1, largest = 8 }', ": largest is 8; it must be odd"),
        (
            '{ policy = "constant-std", std = "3 Hz" }',
            ": std = '3 Hz': its unit is 'Hz'; it must be one of m, mm, cm, km",
        ),
        ('{ policy = "adaptive", kappa = 1, coherence = 2 }', ": coherence = 2: it must be less than or equal to 1"),
        (
            '{ policy = "adaptive", kappa = 1, coherence = 0.5, sediment = "silt" }',
            ": coherence and sediment are both given; it must be one of them, or none to measure it",
        ),
        ('{ policy = "adaptive", kappa = 1, sediment = "snow" }', ": sediment is 'snow'; it must be one of .*"),
        (
            '{ policy = "wrap-safe", kappa = 1, max_wrap_probability = 2 }',
            ": max_wrap_probability is 2; it must lie between 1e-12 and 1",
        ),
        ('"all"', " = 'all': it must be 'record', .rows, samples., .* or a table with a policy"),
    ],
)
def test_what_is_wrong_with_a_policy_is_one_line(window, message):
    with pytest.raises(ValueError, match=rf"^mine: estimators\[0\].windows\[1\]{message}$") as found:
        study(window)
    assert "\n" not in str(found.value)


def test_a_policy_needs_ranges():
    tree = tomllib.loads(SCENE.replace("WINDOW", ADAPTIVE).replace("[3, 3], ", ""))
    del tree["scene"]
    tree["patch"] = {"looks": 9, "snr": 3}
    said = (
        "a window of interferogram is a policy, which needs ranges; in a patch it must be 'record' or [rows, samples]"
    )
    tree["name"] = "mine"
    with pytest.raises(ValueError, match=f"^{re.escape('mine: ' + said)}$"):
        engine.check(made(tree, "mine"))


def test_a_run_with_a_policy(table_of, tmp_path):
    asked = study('{ policy = "adaptive", kappa = 1.0, largest = 9, coherence = 0.1 }, ' + ADAPTIVE)
    how = engine.Run(jobs=1, backend="sequential")
    table = table_of(asked, how, tmp_path / "out")
    outside = table[table.region == "outside"].set_index("window")
    fixed, known, measured = outside.iloc[0], outside.iloc[1], outside.iloc[2]
    # At a coherence of .1 every window is the largest, of 9 rows: two blocks of 20 rows hold two such each.
    assert known.trials % 4 == 0
    assert fixed.trials / 14 >= known.trials / 4
    # No number stands for looks that vary, or for what follows from them; what was counted is there.
    assert np.isnan(measured[["looks", "crlb", "predicted_wrap_rate", "std_over_crlb"]].astype(float)).all()
    assert np.isfinite(measured[["wrap_rate", "rmse", "claimed_wrap_rate", "coherence"]].astype(float)).all()
    assert measured.failures == 0
    trial = one_trial(asked, how.seed, 0, 0, 4)
    assert set(trial.window) > {"AdaptiveWindow(largest=9, kappa=1.0)"}
