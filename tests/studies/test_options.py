"""Estimators of a study that are made of others, and options that are windows."""

import json
import tomllib
from dataclasses import dataclass, replace

import numpy as np
import pytest

from estimators import (
    CombinedNeighbours,
    CrossCorrelation,
    Estimator,
    FixedWindow,
    FullBandPhaseSlope,
    MaximumLikelihood,
    SplitSpectrum,
    TwoWindow,
    WrapSafeWindow,
    bounds,
)
from estimators.windows import WindowPolicy
from studies import engine, manifest
from studies.design import methods, points
from studies.study import made

PATCH = """
name = "made-of"
question = "Which?"
[sonar]
preset = "hisas-100khz"
[patch]
looks = 33
snr = "6 dB"
[[estimators]]
name = "e"
windows = [[1, 33]]
%s
[trials]
count = 40
block = 20
"""
WIDE = FixedWindow(1, 33)


@dataclass(frozen=True)
class Halved:
    """Another estimator's delays, by half."""

    window: WindowPolicy
    of: Estimator

    def estimate(self, pair):
        found = self.of.estimate(pair)
        return replace(found, delay=found.delay / 2)


def study(lines):
    return made(tomllib.loads(PATCH % lines), "mine")


def built(lines):
    asked = study(lines)
    # The same from what a manifest keeps of it.
    again = made(asked.model_dump(exclude_unset=True), "again")
    assert again == asked
    json.dumps(manifest.fixed(asked, 1))
    (method,) = methods(asked, next(points(asked)))
    return method.build(np.random.default_rng(1))


@pytest.mark.parametrize(
    ("lines", "estimator"),
    [
        ('method = "TwoWindow"', TwoWindow(CrossCorrelation(WIDE))),
        (
            'method = "TwoWindow"\noptions = { phase = [1, 3], lags_per_resolution = 4 }',
            TwoWindow(CrossCorrelation(WIDE), FixedWindow(1, 3), 4),
        ),
        (
            'method = "TwoWindow"\noptions = { wrap = { method = "MaximumLikelihood", options = { search = 1e-5 } } }',
            TwoWindow(MaximumLikelihood(WIDE, search=1e-5)),
        ),
        (
            'method = "TwoWindow"\noptions.wrap = { method = "SplitSpectrum", window = [1, 25] }',
            TwoWindow(SplitSpectrum(FixedWindow(1, 25))),
        ),
        ('method = "CombinedNeighbours"', CombinedNeighbours(FullBandPhaseSlope(WIDE))),
        (
            'method = "CombinedNeighbours"\n'
            "options = { std = 1e-8, windows = [[1, 3], [1, 9]], "
            'estimator = { method = "TwoWindow", options = { phase = [1, 1] } } }',
            CombinedNeighbours(TwoWindow(CrossCorrelation(WIDE)), 1e-8, (FixedWindow(1, 3), FixedWindow(1, 9))),
        ),
        (
            f'method = "{__name__}:Halved"\noptions.of.method = "CrossCorrelation"',
            ("Halved", CrossCorrelation(WIDE)),
        ),
    ],
)
def test_tables_are_estimators_and_lists_windows(lines, estimator):
    found = built(lines)
    assert ((type(found).__name__, found.of) if isinstance(estimator, tuple) else found) == estimator


@pytest.mark.parametrize(
    ("lines", "message"),
    [
        (
            'method = "TwoWindow"\noptions.phase = [0, 3]',
            r"mine: estimators\[0\].options.phase = \[0, 3\]: it must be a number, .* or a table of a method",
        ),
        (
            'method = "TwoWindow"\noptions.wrap = { methd = "CrossCorrelation" }',
            r"mine: estimators\[0\].options.wrap: methd: there is no such key; .* did you mean method\?",
        ),
        (
            'method = "TwoWindow"\noptions.wrap = { method = "CrossCorrelation", window = 3 }',
            r"mine: estimators\[0\].options.wrap: window = 3: it must be \[rows, samples\], .*",
        ),
        (
            'method = "TwoWindow"\noptions.wrap = { method = "CrossCorelation" }',
            r".*method is 'CrossCorelation'; .* did you mean CrossCorrelation\?",
        ),
        (
            'method = "TwoWindow"\noptions.wrap = { method = "CrossCorrelation", options = { serach = 1 } }',
            r".*option serach is not one of CrossCorrelation; .* did you mean search\?",
        ),
        ('method = "TwoWindow"\noptions.search = 1e-5', r".*option search is not one of TwoWindow; .*"),
        ('method = "TwoWindow"\noptions.wrap = "CrossCorrelation"', r".*wrap is 'CrossCorrelation'; it must be an .*"),
        ('method = "CombinedNeighbours"\noptions.std = 0', r".*std is 0 s; it must be above 0 s"),
    ],
)
def test_what_cannot_be_is_one_line(lines, message):
    with pytest.raises(ValueError, match=f"^{message}$") as found:
        engine.check(study(lines))
    assert "\n" not in str(found.value)


def test_a_run_of_two_windows(table_of, tmp_path):
    asked = study('method = "TwoWindow"\noptions = { phase = [1, 5] }')
    row = table_of(asked, engine.Run(jobs=1, backend="sequential"), tmp_path / "out").iloc[0]
    assert (row.window, row.looks, row.failures) == ("1x33", 33, 0)
    rate = bounds.cross_correlation_wrap_error_probability(33, row.coherence, row.relative_bandwidth)
    assert row.predicted_wrap_rate == pytest.approx(rate)
    assert np.isnan(row.predicted_delay_std)
    # Five looks: the phase of 33 would have the bound of 33.
    five = np.sqrt(33 / 5) * row.crlb
    assert 0.7 * five < row.delay_std_in_wrap < 2 * five


def test_a_policy_is_that_of_the_wrap():
    tree = tomllib.loads(PATCH % 'method = "TwoWindow"')
    del tree["patch"]
    tree["sonar"] = {"preset": "hisas-1032"}
    tree["scene"] = {"ground_range": [100, 104], "snr": "10 dB"}
    tree["estimators"][0]["windows"] = [{"policy": "wrap-safe", "kappa": 0, "max_wrap_probability": 0.01}]
    asked = made(tree, "mine")
    (method,) = methods(asked, next(points(asked)))
    found = method.build(np.random.default_rng(1))
    assert isinstance(found.wrap.window, WrapSafeWindow)
    assert found.phase == FixedWindow(1, 1)
