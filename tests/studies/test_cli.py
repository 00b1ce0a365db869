import subprocess
import sys

import pytest
from typer.testing import CliRunner

from studies.cli import app

RUNNER = CliRunner()


def command(*arguments):
    return RUNNER.invoke(app, [str(argument) for argument in arguments])


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["box-scen"], "study is 'box-scen'; it must be one of box-scene, wrap-errors; did you mean box-scene?"),
        (["nothing"], "study is 'nothing'; it must be one of box-scene, wrap-errors"),
        (["box-scene", "--estimator", "magic"], "estimator is 'magic'; of box-scene it must be one of interferogram, "),
        (["box-scene", "--set", "bandwidth=-3e4"], "bandwidth is -30000 Hz; it must be above 0 Hz"),
        (["box-scene", "--set", "baseline=0"], "baseline is 0 m; it must be above 0 m"),
        (["box-scene", "--set", "altitude=2"], "altitude is 2 m; it must be above the scene, 3 m"),
        (["box-scene", "--set", "snr=nan"], "snr is nan; it must be finite"),
        (["box-scene", "--set", "windows=0"], "samples of the window is 0; it must be a whole number of at least 1"),
        (
            ["box-scene", "--set", "windows=100000"],
            "windows holds 100000 samples; it must not exceed the series, 10648 ",
        ),
        (["box-scene", "--set", "far=soon"], "far is 'soon'; it must be a number"),
        (["box-scene", "--set", "far"], "--set is 'far'; it must be KEY=VALUE"),
        (["box-scene", "--set", "colour=red"], "parameter is 'colour'; of box-scene it must be one of "),
        (["wrap-errors", "--set", "looks=9,2"], "looks is 2; it must be a whole number of at least 3"),
        (
            ["wrap-errors", "--set", "relative_bandwidth=2"],
            "relative_bandwidth is 2; it must lie between 0.001 and 1.9",
        ),
        (["wrap-errors", "--trials", "0"], "trials is 0; it must be a whole number of at least 1"),
        (["wrap-errors", "--seed", "-1"], "seed is -1; it must lie between 0 and 2^128 - 1"),
        (["wrap-errors", "--backend", "mpi"], "backend is 'mpi'; it must be one of loky, threading, sequential, dask"),
        (
            ["wrap-errors", "--backend", "dask"],
            "scheduler is None; the backend dask needs one, such as tcp://host:8786",
        ),
        (["wrap-errors", "--jobs", "0"], "jobs is 0; it must be 1 or more, or -1 for one a processor"),
    ],
)
def test_bad_input_is_one_line_and_status_2(arguments, message, tmp_path):
    found = command("run", "--quick", "--jobs", "1", *arguments, "--out", tmp_path)
    assert found.exit_code == 2
    last = found.stderr.strip().splitlines()[-1]
    assert last.startswith(f"twinecho: {message}")
    assert "Traceback" not in found.output
    assert not any(tmp_path.rglob("*.csv"))


def test_nothing_runs_before_everything_is_checked(tmp_path):
    found = command("run", "box-scene", "no-such-study", "--quick", "--out", tmp_path)
    assert found.exit_code == 2
    assert not list(tmp_path.iterdir())


def test_a_folder_that_cannot_be_written_is_one_line(tmp_path):
    (tmp_path / "file").write_text("")
    small = ["--trials", "50", "--set", "snr=10", "--set", "looks=9", "--set", "relative_bandwidth=0.3", "--jobs", "1"]
    found = command("run", "wrap-errors", *small, "--out", tmp_path / "file")
    assert found.exit_code == 2
    assert found.stderr.strip().splitlines()[-1].startswith("twinecho: ")


def test_run_ends_with_a_table_and_the_paths_of_what_it_wrote(tmp_path):
    small = ["--trials", "200", "--set", "snr=10", "--set", "looks=9", "--set", "relative_bandwidth=0.3", "--jobs", "1"]
    found = command("run", "wrap-errors", *small, "--out", tmp_path)
    assert found.exit_code == 0, found.output
    assert "cross-correlation" in found.stdout
    assert found.stderr.splitlines()[0] == "wrap-errors: 0 of 1 blocks in 0 s"
    assert found.stderr.splitlines()[-1].startswith("wrap-errors: 1 of 1 blocks in ")
    for line in found.stdout.strip().splitlines()[-4:]:
        assert (tmp_path / "wrap-errors").joinpath(line.split("wrap-errors/")[-1]).is_file()


def test_status_report_and_replay_of_a_run(tmp_path):
    small = [
        "--trials",
        "200",
        "--set",
        "snr=0,10",
        "--set",
        "looks=9",
        "--set",
        "relative_bandwidth=0.3",
        "--jobs",
        "1",
    ]
    assert command("run", "wrap-errors", *small, "--out", tmp_path).exit_code == 0
    folder = tmp_path / "wrap-errors"
    written = (folder / "table.csv").read_bytes()
    (folder / "table.csv").unlink()
    assert command("report", folder).exit_code == 0
    assert (folder / "table.csv").read_bytes() == written
    assert "2 of 2 blocks are there" in command("status", folder).stdout
    next((folder / "blocks").glob("*-000000.parquet")).unlink()
    assert "1 of 2 blocks are there" in command("status", folder).stdout
    shown = command("replay", folder, 1, 0)
    assert shown.exit_code == 0
    assert "cross-correlation" in shown.stdout
    for arguments, message in [
        (["replay", folder, 2, 0], "point is 2; it must lie between 0 and 1"),
        (["replay", folder, 0, 1], "block is 1; it must lie between 0 and 0"),
        (["status", tmp_path], f"{tmp_path} is no folder of a run; it must hold a manifest.json"),
    ]:
        found = command(*arguments)
        assert found.exit_code == 2
        assert found.stderr.strip().startswith(f"twinecho: {message}")


def test_a_changed_design_is_refused_and_fresh_starts_beside(tmp_path):
    small = ["--trials", "50", "--set", "snr=10", "--set", "looks=9", "--set", "relative_bandwidth=0.3", "--jobs", "1"]
    assert command("run", "wrap-errors", *small, "--out", tmp_path).exit_code == 0
    refused = command("run", "wrap-errors", *small, "--seed", "7", "--out", tmp_path)
    assert refused.exit_code == 2
    assert "another design: seed was 2026, is 7" in refused.stderr
    assert command("run", "wrap-errors", *small, "--seed", "7", "--fresh", "--out", tmp_path).exit_code == 0
    assert (tmp_path / "wrap-errors-2" / "table.csv").is_file()


def test_list_names_studies_and_estimators():
    found = command("list")
    assert found.exit_code == 0
    for name in ("box-scene", "wrap-errors", "phase-slope-refined", "--set altitude=15"):
        assert name in found.stdout


def test_the_module_runs_as_a_command():
    found = subprocess.run(
        [sys.executable, "-c", "from studies.cli import main; main()", "run", "box"],
        capture_output=True,
        text=True,
        check=False,
    )
    assert found.returncode == 2
    assert found.stderr.startswith("twinecho: study is 'box'")
