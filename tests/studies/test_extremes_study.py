"""What the study of extremes says, on a few of its cases."""

import math

import numpy as np
import pandas as pd
import pytest

from estimators.estimate import DelayEstimate
from estimators.extremes import tally
from sim import SONARS
from studies.catalogue import extremes
from studies.catalogue.extremes_figures import right_wraps, verdicts
from studies.catalogue.extremes_functions import functions

SONAR = SONARS["hisas-100khz"]
FEW = ("SNR [dB]", "looks", "amplitude, single", "silent receiver", "relative bandwidth", "window [samples]")


@pytest.fixture(scope="module")
def measured():
    with pytest.MonkeyPatch.context() as patch:
        ends = {case: (make, (values[0], values[-1])) for case, (make, values) in extremes.CASES.items() if case in FEW}
        patch.setattr(extremes, "CASES", ends)
        chosen = ("interferogram", "cross-correlation", "split-spectrum")
        patch.setattr(extremes, "METHODS", {name: extremes.METHODS[name] for name in chosen})
        yield tuple(extremes.measure(SONAR, 40, np.random.default_rng(5)) for _ in range(2))


def test_the_same_seed_gives_the_same_bits(measured):
    pd.testing.assert_frame_equal(*measured, check_exact=True)


def test_verdicts_are_those_of_what_is_there(measured):
    verdict = measured[0].set_index(["case", "value", "estimator"]).verdict
    assert "fails" not in set(verdict)
    assert (verdict["silent receiver"] == "invalid").all()
    assert (verdict["amplitude, single"] == "exact").all()
    assert verdict["looks", 1.0, "split-spectrum"] == "refused"
    assert verdict["SNR [dB]", -60.0, "cross-correlation"] == "as claimed"


def test_statistics_are_within_five_standard_errors_of_theory(measured):
    found = measured[0].query("statistic == 'mean cosine of the phase'")
    assert len(found) == 3
    assert (found.standard_errors.abs() < 5).all()


def test_ranges_and_answer_are_read_from_the_table(measured):
    spans = extremes.ranges(measured[0]).set_index(["estimator", "case"])
    assert spans.holds["cross-correlation", "SNR [dB]"] == "-60 to 120"
    assert spans.right["cross-correlation", "SNR [dB]"] == "120"
    assert spans.right["cross-correlation", "silent receiver"] == "none"
    assert "and 0 fail" in extremes.answer(measured[0])
    for figure in (verdicts, right_wraps):
        assert len(figure(measured[0], []).axes) > 0


@pytest.mark.filterwarnings("default::sim.ValidityWarning")
def test_functions_are_those_of_50_digits():
    table = pd.DataFrame(functions(SONAR, np.random.default_rng(6)))
    assert set(table.verdict) == {"exact", "as claimed"}
    assert table.reference_error.max() < 1e-9
    # The Ziv-Zakai bound of a guess and of a known wrap, the wrap of none.
    at = table.set_index(["estimator", "value"]).found
    assert at["ziv-zakai", -60.0] == pytest.approx(20 * SONAR.wrap / math.sqrt(12), rel=1e-3)
    assert at["ziv-zakai", 120.0] == pytest.approx(at["coherent-delay-crlb", 120.0], rel=0.02)
    assert at["wrap-error-probability", -60.0] == pytest.approx(1.0, abs=1e-5)
    # Perturbation of a rough surface falls with the fourth power of the sine at the least angles.
    strength = [at["scattering-strength small-slope", angle] for angle in (0.01, 0.1)]
    assert strength[1] - strength[0] == pytest.approx(40.0, abs=0.01)


def claims(error, std, doubt, valid=True):
    """Of 1000 rows of one sample, errors in wraps."""
    ones = np.ones((1000, 1))
    shares = dict.fromkeys(("coherence", "debiased_coherence"), 0.5 * ones)
    return DelayEstimate(
        delay=np.asarray(error).reshape(-1, 1) * ones,
        phase=0 * ones,
        delay_std=std * ones,
        wrap_error_probability=doubt * ones,
        quality=(1 - doubt) * ones,
        valid=np.full(ones.shape, valid),
        **shares,
    )


@pytest.mark.parametrize(
    ("spread", "wrong", "doubt", "holds"),
    [
        (1.0, 0, 1e-9, True),
        (2.0, 0, 1e-9, True),
        (4.0, 0, 1e-9, False),
        (1.0, 100, 0.1, True),
        (1.0, 200, 0.1, True),
        (1.0, 400, 0.1, False),
        (1.0, 1, 1e-12, False),
        # Who says that the wrap is hardly known claims nothing.
        (9.0, 500, 0.9, True),
    ],
)
def test_a_tally_holds_claims_against_what_is_found(spread, wrong, doubt, holds):
    error = 0.01 * spread * np.random.default_rng(2).standard_normal(1000)
    error[:wrong] += 1.0
    found = tally(claims(error, 0.01, doubt), 0.0, 1.0, 0)
    assert found.wrong == wrong
    assert found.holds == holds


def test_what_cannot_be_is_broken_where_it_is_valid():
    for std, doubt in ((0.0, 0.1), (np.nan, 0.1), (0.01, 1.5), (0.01, np.nan)):
        assert not tally(claims(0.0, std, doubt), 0.0, 1.0, 0).holds
        assert tally(claims(0.0, std, doubt, valid=False), 0.0, 1.0, 0).holds
