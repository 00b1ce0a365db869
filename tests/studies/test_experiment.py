"""A study that is measured by a function of one's own."""

import sys

import numpy as np
import pandas as pd
import pytest

from studies import engine, report
from studies.study import made

STUDY = {
    "name": "own",
    "question": "What does it give?",
    "sonar": {"preset": "hisas-100khz"},
    "experiment": {"measure": "own_experiment:measure", "rows": 3},
}


@pytest.fixture
def module(tmp_path, monkeypatch):
    def write(body):
        (tmp_path / "own_experiment.py").write_text(
            f"import pandas as pd\n\n\ndef measure(sonar, rows, rng):\n    {body}\n"
        )
        monkeypatch.syspath_prepend(tmp_path)
        monkeypatch.delitem(sys.modules, "own_experiment", raising=False)
        return tmp_path

    return write


def test_the_function_gets_sonar_rows_and_random_numbers_and_gives_the_table(module):
    folder = module("return pd.DataFrame({'wrap': sonar.wrap, 'drawn': rng.normal(size=rows)})")
    study = made({**STUDY, "axes": [{"experiment.seed": [1, 2]}]}, "test")
    engine.check(study)
    table = report.result(study, engine.store_of(study, 2026, folder)).table
    drawn = [np.random.Generator(np.random.Philox(seed)).normal(size=3) for seed in (1, 2)]
    pd.testing.assert_frame_equal(
        table,
        pd.DataFrame({"seed": [1] * 3 + [2] * 3, "wrap": 1e-5, "drawn": np.concatenate(drawn)}),
        check_dtype=False,
    )


def test_what_it_does_wrong_is_said_in_one_line(module):
    folder = module("return 3")
    study = made(STUDY, "test")
    with pytest.raises(ValueError, match=r"^measure own_experiment:measure gives a int; it must give a DataFrame$"):
        report.result(study, engine.store_of(study, 2026, folder))


def test_it_has_no_trials():
    with pytest.raises(ValueError, match=r"^test: trials is given beside experiment; it must not be, .*$"):
        made({**STUDY, "trials": {"count": 1, "block": 1}}, "test")
