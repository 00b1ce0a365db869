"""The pages that are run from top to bottom, in an empty folder, and what they say is printed."""

import contextlib
import io
import re
import shlex
import socket
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
from typer.main import get_command
from typer.testing import CliRunner

from sim import SONARS, Scene, simulate, write_pair
from studies import catalogue
from studies.cli import app

ROOT = Path(__file__).parents[1]
MARK = "run in order by tests/test_pages.py"
PAGES = [page for page in [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md"))] if MARK in page.read_text()]
LONG = ("clusters", "gallery")
BLOCKS = re.compile(r"^```(\w+)\n(.*?)^```", re.DOTALL | re.MULTILINE)
MAIN_JOB = shlex.split(re.search(r"set -- (.*)", (ROOT / "run.sh").read_text())[1])
SMALL = {
    name: shlex.split(options)
    for name, options in {
        "box-scene": "--trials 1 --set trials.block=1 --set scene.snr=15",
        "wrap-errors": "--trials 100 --set trials.block=100 --set patch.looks=9 --set patch.snr=0,8 "
        "--set 'sonar.bandwidth=30 kHz'",
        "calibration": "--trials 100 --set trials.block=100 --set patch.looks=9 --set patch.snr=5.9 "
        "--set 'sonar.bandwidth=30 kHz'",
        "long-range": "--trials 62 --set trials.block=62 --set scene.features=[] --set 'scene.ground_range=[99, 126]'",
        "reliability": "--set experiment.rows=40",
        "quality": "--set experiment.rows=2",
        "neighbours": "--set experiment.rows=10",
        "scene-plans": "--set plans.rows=2 --set plans.repeats=2",
        "speed-accuracy": "--set experiment.rows=8",
        "extremes": "--set experiment.rows=4",
        "scaling": "--set experiment.rows=1",
        "peers": "--set experiment.rows=8",
    }.items()
}
NUMBER = re.compile(r"[+-]?\d+(?:\.\d*)?(?:e[+-]?\d+)?")


def same(said, printed):
    """Whether two lines have the same words, and numbers that differ by one in the last place said at the most."""
    parts = [(NUMBER.split(line), NUMBER.findall(line)) for line in (" ".join(said.split()), " ".join(printed.split()))]
    (words, numbers), (words_printed, numbers_printed) = parts
    return words == words_printed and all(map(close, numbers, numbers_printed))


def close(said, printed):
    mantissa, _, exponent = said.partition("e")
    last_place = 10.0 ** (int(exponent or 0) - len(mantissa.partition(".")[2]))
    return abs(float(said) - float(printed)) < 1.01 * last_place


def check_printed(said, printed):
    """Every line that is said is printed, in this order; others may be between."""
    lines = iter(printed.splitlines())
    for line in said.splitlines():
        assert any(same(line, candidate) for candidate in lines), f"{line!r} is not among:\n{printed}"


def run_python(code, names):
    printed = io.StringIO()
    with contextlib.redirect_stdout(printed):
        exec(compile(code, "block", "exec"), names)
    return printed.getvalue()


def measured(name):
    """What a user of `estimate` has."""
    write_pair(simulate(Scene((30.0, 34.0)), SONARS["hisas-100khz"], rng=np.random.default_rng(1), rows=20), name)


def at_a_fraction(words):
    """A command as it is, or as those that run the same shipped studies, each with fewer points and trials."""
    if words[0] != "run":
        return [words]
    first_option = next((n for n, word in enumerate(words) if word.startswith("-")), len(words))
    names, options = words[1:first_option], [*words[first_option:], "--jobs", "1"]
    return [["run", name, *options, *SMALL.get(name, [])] for name in names]


def run_command(line, started):
    program, *words = shlex.split(line, comments=True)
    if program == "./test.sh":
        return ""
    if program == ".venv/bin/dask":
        started.append(dask(words))
        return ""
    assert program == "./run.sh", line
    output = ""
    for command in at_a_fraction(words or MAIN_JOB):
        found = CliRunner().invoke(app, command)
        assert found.exit_code == 0, (command, found.output)
        output += found.output
    return output


def dask(words):
    """A process of Dask; a scheduler answers by now."""
    process = subprocess.Popen(
        [Path(sys.executable).with_name("dask"), *words], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
    )
    if words[0] == "scheduler":
        host, port = words[words.index("--host") + 1], int(words[words.index("--port") + 1])
        for _ in range(600):
            with contextlib.suppress(OSError), socket.create_connection((host, port), timeout=1):
                break
            time.sleep(0.1)
    return process


@pytest.fixture
def started():
    """Processes that a page starts, ended after it."""
    processes = []
    yield processes
    for process in reversed(processes):
        process.terminate()
        process.wait(timeout=60)


@pytest.fixture
def free_port():
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        return str(free.getsockname()[1])


@pytest.mark.parametrize(
    "page",
    [
        pytest.param(page, id=str(page.relative_to(ROOT)), marks=[pytest.mark.long] if page.stem in LONG else [])
        for page in PAGES
    ],
)
def test_a_page_does_what_it_says(page, tmp_path, monkeypatch, started, free_port):
    monkeypatch.chdir(tmp_path)
    monkeypatch.syspath_prepend(tmp_path)
    if page.name == "README.md":
        measured("pair.nc")
    names, printed = {}, ""
    for language, code in BLOCKS.findall(page.read_text(encoding="utf-8")):
        file = re.match(r"# (\S+\.(?:toml|py))\n", code)
        if file:
            Path(file[1]).write_text(code)
        elif language == "python":
            printed = run_python(code, names)
        elif language == "sh":
            lines = code.replace("8786", free_port).splitlines()
            printed = "".join(run_command(line, started) for line in lines)
        elif language == "text":
            check_printed(code, printed)
        else:
            raise AssertionError(f"a block of {language} is not run: {code}")


def inline_commands():
    pages = [ROOT / "README.md", *(ROOT / "docs").rglob("*.md")]
    texts = [page.read_text(encoding="utf-8") for page in pages]
    return [(line, text) for text in texts for line in re.findall(r"`\./run\.sh ([^`]+)`", text)]


@pytest.mark.parametrize(("line", "page"), inline_commands(), ids=[line for line, _ in inline_commands()])
def test_commands_within_sentences_can_be_called(line, page):
    """Those of whole blocks are run; these have words and options that are there, and studies or files that are."""
    name, *words = shlex.split(line)
    context = get_command(app).commands[name].make_context(name, words)
    for given in [*context.params.get("names", []), context.params.get("file")]:
        if given not in {None, "FILE", "NAME-or-FILE", *catalogue.NAMES}:
            assert (ROOT / given).is_file() or f'name = "{Path(given).stem}"' in page, given
