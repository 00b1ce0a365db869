"""The README's own words, run."""

import re
from pathlib import Path

import pytest

README = (Path(__file__).parents[1] / "README.md").read_text(encoding="utf-8")


@pytest.mark.parametrize("code", re.findall(r"```python\n(.*?)```", README, re.DOTALL))
def test_python_examples_run(code, capsys):
    exec(compile(code, "README.md", "exec"), {})
    printed = capsys.readouterr().out
    centimetres = float(re.search(r"median height error ([\d.]+) cm", printed).group(1))
    # The bound of 25 looks at 15 dB and 45 m is 0.9 cm; boxes and near range make it no more than three times that.
    assert 0.2 < centimetres < 2.7


def test_pictures_are_kept():
    pictures = re.findall(r"!\[[^\]]+\]\(([^)]+)\)", README)
    assert len(pictures) == 9
    assert all((Path(__file__).parents[1] / picture).is_file() for picture in pictures)
