"""The README's own words, run."""

import re
from pathlib import Path

import pandas as pd
import pytest

ROOT = Path(__file__).parents[1]
README = (ROOT / "README.md").read_text(encoding="utf-8")
SAID = " ".join(README.split())


@pytest.mark.parametrize("code", re.findall(r"```python\n(.*?)```", README, re.DOTALL))
def test_python_examples_run(code, capsys):
    exec(compile(code, "README.md", "exec"), {})
    printed = capsys.readouterr().out
    centimetres = float(re.search(r"median height error ([\d.]+) cm", printed).group(1))
    # The bound of 25 looks at 15 dB and 45 m is 0.9 cm; boxes and near range make it no more than three times that.
    assert 0.2 < centimetres < 2.7


def test_pictures_are_kept():
    pictures = re.findall(r"!\[[^\]]+\]\(([^)]+)\)", README)
    assert len(pictures) == 13
    assert all((ROOT / picture).is_file() for picture in pictures)


def kept(study):
    return pd.read_csv(ROOT / f"results/{study}/table.csv")


def test_what_is_said_of_boxes_is_in_the_kept_table():
    outside = kept("box-scene").query("estimator == 'phase-slope' and region == 'outside'").set_index("snr_db")
    quiet, noisy = 100 * (1 - outside.wrap_rate[[float("inf"), 15.0]])
    assert (
        f"{quiet:.0f} % of pixels outside layover are in the right wrap without noise, {noisy:.0f} % at 15 dB" in SAID
    )


def test_what_is_said_of_wrap_errors_is_in_the_kept_table():
    table = kept("wrap-errors").query("estimator == 'cross-correlation'")
    within = table.predicted_wrap_rate.between(table.wrap_rate_low, table.wrap_rate_high)
    assert f"at {within.sum()} of the {len(table)} design points for the cross-correlation" in SAID


def test_what_is_said_of_long_range_is_in_the_kept_table():
    paper = kept("long-range").query("estimator == 'phase' and sediment.isna()")
    far = paper[paper.ground_range.between(395, 406)]
    for window, reached in (("9x9", 322), ("AdaptiveWindow(kappa=2.0)", 428)):
        over = paper[(paper.window == window) & (paper.depth_std_in_wrap > 0.5)]
        # The figure smooths over 11 m; single metres are off by a few per cent of a slope of about 1 % a metre.
        assert abs(over.ground_range.iloc[:5].median() - reached) < 6
        assert f"{reached} m" in SAID
    adaptive = far[far.window == "AdaptiveWindow(kappa=2.0)"]
    assert round(adaptive.window_rows.mean()) == 39
    # 11 m by 80 m hold 1450 windows of 78 cm: a standard error of 1.9 %, 7 mm; four of them.
    assert adaptive.depth_std_in_wrap.mean() == pytest.approx(0.39, abs=0.03)
    assert "39 x 39 pixels at 400 m and an STD of 39 cm" in SAID
