"""What the docs show, run."""

import re
import tomllib
from pathlib import Path

import pytest
from typer.testing import CliRunner

from studies import engine
from studies.cli import app
from studies.study import made

DOCS = sorted((Path(__file__).parents[1] / "docs").glob("*.md"))

COMMANDS = [
    (page, line)
    for page in DOCS
    for block in re.findall(r"```sh\n(.*?)```", page.read_text(encoding="utf-8"), re.DOTALL)
    for line in block.splitlines()
    if line.startswith("./run.sh ")
]


def blocks_of(language):
    found = [
        (page.name, code)
        for page in DOCS
        for code in re.findall(rf"```{language}\n(.*?)```", page.read_text(encoding="utf-8"), re.DOTALL)
    ]
    return pytest.mark.parametrize("code", [code for _, code in found], ids=[name for name, _ in found])


@blocks_of("toml")
def test_study_files_are_studies(code):
    study = made(tomllib.loads(code), "docs")
    assert engine.check(study)
    assert engine.check(study.for_a_first_look())


@pytest.fixture(scope="module")
def place(tmp_path_factory):
    folder = tmp_path_factory.mktemp("docs")
    (example,) = re.findall(r"```toml\n(.*?)```", (DOCS[-1].parent / "study-files.md").read_text(), re.DOTALL)
    (folder / "my-study.toml").write_text(example)
    return folder


def test_commands_do_what_they_say(place, monkeypatch):
    """In the order of the pages, at a fraction of their size."""
    monkeypatch.chdir(place)
    small = ["--set", "patch.looks=9", "--set", "sonar.bandwidth=30 kHz", "--set", "trials.block=50", "--trials", "100"]
    for _, line in COMMANDS:
        words = line.removeprefix("./run.sh ").split()
        if words[:2] == ["run", "my-study.toml"]:
            words += ["--trials", "2000", "--jobs", "1"]
        elif words[0] == "run":
            words += [*small, "--jobs", "1"]
        found = CliRunner().invoke(app, words)
        assert found.exit_code == 0, (line, found.output)
