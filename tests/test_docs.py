"""What the docs show, run."""

import contextlib
import re
import shlex
import tomllib
from itertools import islice
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from typer.testing import CliRunner

import studies
from estimators import FixedWindow, conformance
from sim import SONARS, speckle_pair
from studies import engine, predict, report
from studies.catalogue import scaling
from studies.cli import app
from studies.named import imported
from studies.study import made
from studies.tuning import Effort

DOCS = [
    page
    for page in sorted((Path(__file__).parents[1] / "docs").rglob("*.md"))
    if "run in order by tests/test_pages.py" not in page.read_text(encoding="utf-8")
]

FEW = Effort(timed=2**9, sorting=2**12, confirming=2**18, repeats=1)
"""How much `tune` measures here."""

COMMANDS = [
    (page, line)
    for page in DOCS
    for block in re.findall(r"```sh\n(.*?)```", page.read_text(encoding="utf-8"), re.DOTALL)
    for line in block.splitlines()
    if line.startswith("./run.sh ")
]


def found_in(language):
    return [
        (page.name, code)
        for page in DOCS
        for code in re.findall(rf"```{language}\n(.*?)```", page.read_text(encoding="utf-8"), re.DOTALL)
    ]


STUDIES = [(name, code) for name, code in found_in("toml") if "[project]" not in code]


@pytest.mark.parametrize("code", [code for _, code in STUDIES], ids=[name for name, _ in STUDIES])
def test_study_files_are_studies(code, place, monkeypatch):
    monkeypatch.syspath_prepend(place)
    study = made(tomllib.loads(code), "docs")
    assert bool(engine.check(study)) == study.simulates
    assert bool(engine.check(study.for_a_first_look())) == study.simulates


def test_the_estimator_of_ones_own_is_one(place, monkeypatch, tmp_path):
    monkeypatch.syspath_prepend(place)
    made_by_docs = imported("my_estimator:Whitened", "method")(FixedWindow(1, 33))
    assert conformance.findings(made_by_docs) == []
    (code,) = (code for _, code in STUDIES if '"my_estimator:Whitened"' in code)
    study = made(tomllib.loads(code), "docs")
    engine.run(study, engine.Run(jobs=1, backend="sequential"), tmp_path / "out")
    found = report.result(study, engine.store_of(study, 2026, tmp_path / "out"))
    table = found.table.set_index("estimator")
    assert table.failures.sum() == 0
    # Amplitudes carry part of what is known: without them the spread is wider, but not by much.
    assert 1.0 < table.delay_std_in_wrap["own"] / table.delay_std_in_wrap["plain"] < 1.6
    report.write(study, found, tmp_path / "out")
    assert (tmp_path / "out" / "figures" / "spread.png").is_file()


def test_the_depth_map_is_one(capsys):
    (code,) = (code for _, code in found_in("python") if "depth_map" in code)
    found = {}
    exec(code, found)
    depths = found["depths"]
    assert depths.valid.any()
    # A flat floor at 6 dB: heights are right to a spread, which is that of a window of some tens of looks.
    kept = found["Thresholds"](height_std=0.5, wrap_error_probability=0.1).mask(depths)
    on_floor = kept & (depths.plane_range > 201.0) & (depths.plane_range < 209.0)
    assert on_floor.mean() > 0.2
    assert abs(np.median(depths.height[on_floor])) < 0.1
    assert "valid_range=" in capsys.readouterr().out


def test_the_tuned_estimator_is_one(monkeypatch, capsys):
    (code,) = (code for _, code in found_in("python") if "studies.tune" in code)
    monkeypatch.setitem(studies.tune.__kwdefaults__, "effort", FEW)
    found = {}
    exec(code, found)
    pair = speckle_pair(
        (5, 33),
        coherence=0.9,
        delay=0.0,
        centre_frequency=1e5,
        bandwidth=3e4,
        sample_rate=3e4,
        rng=np.random.default_rng(1),
    )
    # The bound is .01 wraps.
    assert np.all(np.abs(found["estimator"].estimate(pair).delay) < 0.1e-5)
    assert "Interval(value=" in capsys.readouterr().out


def test_the_answer_for_silt_at_300_m():
    found = predict(SONARS["hisas-1032"], 300.0, sediment="silt", kappa=0.0, most_wrap_errors=0.01)
    assert found.best_window.item() == 13


@pytest.fixture(scope="module")
def place(tmp_path_factory):
    folder = tmp_path_factory.mktemp("docs")
    examples = re.findall(
        r"```toml\n(.*?)```", (Path(__file__).parents[1] / "docs/study-files.md").read_text(), re.DOTALL
    )
    (scene,) = (example for example in examples if example.startswith('name = "trawl-marks"'))
    for name, example in (("my-study.toml", examples[0]), ("my-scene.toml", scene)):
        (folder / name).write_text(example)
    (estimator,) = (code for _, code in found_in("python") if "class Whitened" in code)
    (folder / "my_estimator.py").write_text(estimator)
    (package,) = (tomllib.loads(code)["project"] for _, code in found_in("toml") if "[project]" in code)
    # What an installer makes of it.
    installed = folder / f"{package['name'].replace('-', '_')}-{package['version']}.dist-info"
    installed.mkdir()
    (installed / "METADATA").write_text(
        f"Metadata-Version: 2.1\nName: {package['name']}\nVersion: {package['version']}\n"
    )
    entries = [
        f"[{group}]\n" + "".join(f"{name} = {value}\n" for name, value in points.items())
        for group, points in package["entry-points"].items()
    ]
    (installed / "entry_points.txt").write_text("\n".join(entries))
    (code,) = (code for _, code in found_in("python") if "write_pair" in code)
    with contextlib.chdir(folder):
        exec(code, {})
    return folder


def test_commands_do_what_they_say(place, monkeypatch):
    """In the order of the pages, at a fraction of their size."""
    monkeypatch.chdir(place)
    monkeypatch.setattr("studies.commands.tune.QUICK", FEW)
    monkeypatch.syspath_prepend(place)
    all_sweeps = scaling.sweeps
    monkeypatch.setattr(scaling, "sweeps", lambda *given: islice(all_sweeps(*given), 2))
    small = ["--set", "patch.looks=9", "--set", "sonar.bandwidth=30 kHz", "--set", "trials.block=50", "--trials", "100"]
    for _, line in COMMANDS:
        words = shlex.split(line.removeprefix("./run.sh "), comments=True)
        if words[:2] == ["run", "my-study.toml"]:
            words += ["--trials", "2000", "--jobs", "1"]
        elif words[:2] in (["run", "scaling"], ["run", "peers"]):
            words += ["--set", "experiment.rows=1"]
        elif words[0] == "run":
            words += [*small, "--jobs", "1"]
        elif words[0] == "tune":
            words.append("--quick")
        found = CliRunner().invoke(app, words)
        assert found.exit_code == 0, (line, found.output)
    for name in ("pair-estimate", "ml", "whitened"):
        with xr.open_dataset(f"{name}.nc", engine="h5netcdf") as estimates:
            floor = estimates.depth.where((estimates.valid == 1) & (estimates.wrap_error_probability < 1e-3))
            # A floor 15 m below the sonar, and on it a box of 1 m.
            assert abs(float(floor.median()) - 15.0) < 0.05
            assert abs(float(floor.quantile(0.05)) - 14.0) < 0.1
        assert Path(f"{name}.png").stat().st_size > 20_000
