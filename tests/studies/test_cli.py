import re
import subprocess
import sys

import pytest
from typer.testing import CliRunner

from studies.cli import app

RUNNER = CliRunner()

SMALL = [
    *("--set", "patch.snr=10", "--set", "patch.looks=9", "--set", "sonar.bandwidth=30 kHz"),
    *("--set", "trials.block=50", "--trials", "100", "--jobs", "1"),
]


def command(*arguments):
    return RUNNER.invoke(app, [str(argument) for argument in arguments])


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (
            ["box-scen"],
            "study is 'box-scen'; it must be a study file, or one of box-scene, .*; did you mean box-scene?",
        ),
        (["nothing"], "study is 'nothing'; it must be a study file, or one of box-scene, .*wrap-errors"),
        (["no-such.toml"], "[Errno 2] No such file or directory: 'no-such.toml'"),
        (["box-scene", "--estimator", "magic"], "estimator is 'magic'; of box-scene it must be one of interferogram, "),
        (
            ["box-scene", "--estimator", "phase-slop"],
            "estimator is 'phase-slop'; of box-scene it must be .*did you mean phase-slope?",
        ),
        (
            ["box-scene", "--set", "sonar.bandwidth=-3e4"],
            "box-scene: sonar: bandwidth is -30000 Hz; it must be above 0 Hz",
        ),
        (["box-scene", "--set", "sonar.baseline=0"], "box-scene: sonar: baseline is 0 m; it must be above 0 m"),
        (
            ["box-scene", "--set", "sonar.altitude=2"],
            "box-scene: scene: altitude is 2 m; it must be above the highest point of the scene, 3 m",
        ),
        (["box-scene", "--set", "scene.snr=nan"], "box-scene: scene.snr = nan: "),
        (["box-scene", "--set", "scene.ground_range=[9, 5]"], "box-scene: scene: ground_range is (9, 5) m; "),
        (["box-scene", "--set", "scene.ground_range=soon"], "box-scene: scene.ground_range = 'soon': "),
        (["box-scene", "--set", "altitude"], "--set is 'altitude'; it must be KEY=VALUE"),
        (["box-scene", "--set", "scene.colour=red"], "there is no 'scene.colour' in box-scene; it must be one of "),
        (["wrap-errors", "--set", "patch.looks=9,2"], "wrap-errors: patch.looks = 2: it must be greater than or equal"),
        (
            ["wrap-errors", "--set", "sonar.bandwidth=200 kHz"],
            "wrap-errors: sonar: bandwidth is 200000 Hz; it must be below twice the centre frequency, 200000 Hz",
        ),
        (["wrap-errors", "--trials", "0"], "wrap-errors: trials.count = 0: it must be greater than or equal to 1"),
        (["wrap-errors", "--seed", "-1"], "seed is -1; it must lie between 0 and 2^128 - 1"),
        (["wrap-errors", "--shard", "3"], "shard is '3'; it must be K/N, such as 3/10"),
        (["wrap-errors", "--shard", "3/2"], "shard is 3/2; it must be K/N with K between 1 and N"),
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
    assert re.match(re.escape(f"twinecho: {message}").replace(r"\.\*", ".*"), last), last
    assert "Traceback" not in found.output
    assert not any(tmp_path.rglob("*.csv"))


def test_a_window_longer_than_the_series_is_one_line(tmp_path):
    from studies import catalogue

    text = catalogue.path_of("box-scene").read_text().replace("[1, 81]]", "[1, 100000]]")
    (tmp_path / "mine.toml").write_text(text)
    found = command("run", tmp_path / "mine.toml", "--out", tmp_path / "out")
    assert found.exit_code == 2
    expected = (
        "twinecho: box-scene: a window of cross-correlation has 100000 samples; a block of the echoes has 10648, "
    )
    assert found.stderr.startswith(expected)


def test_nothing_runs_before_everything_is_checked(tmp_path):
    found = command("run", "box-scene", "no-such-study", "--quick", "--out", tmp_path)
    assert found.exit_code == 2
    assert not list(tmp_path.iterdir())


def test_a_folder_that_cannot_be_written_is_one_line(tmp_path):
    (tmp_path / "file").write_text("")
    found = command("run", "wrap-errors", *SMALL, "--out", tmp_path / "file")
    assert found.exit_code == 2
    assert found.stderr.strip().splitlines()[-1].startswith("twinecho: ")


def test_run_ends_with_a_table_and_the_paths_of_what_it_wrote(tmp_path):
    found = command("run", "wrap-errors", *SMALL, "--out", tmp_path)
    assert found.exit_code == 0, found.output
    assert "cross-correlation" in found.stdout
    assert found.stderr.splitlines()[0] == "wrap-errors: 0 of 2 blocks in 0 s"
    assert found.stderr.splitlines()[-1].startswith("wrap-errors: 2 of 2 blocks in ")
    for line in found.stdout.strip().splitlines()[-6:]:
        assert (tmp_path / "wrap-errors").joinpath(line.split("wrap-errors/")[-1]).is_file()


def test_a_file_of_ones_own_runs(tmp_path):
    from studies import catalogue

    text = catalogue.path_of("wrap-errors").read_text().replace('name = "wrap-errors"', 'name = "mine"', 1)
    (tmp_path / "mine.toml").write_text(text)
    checked = command("check", tmp_path / "mine.toml")
    assert "153 design points of up to 20000 trials, in blocks of 2000" in checked.stdout
    found = command("run", tmp_path / "mine.toml", *SMALL, "--out", tmp_path)
    assert found.exit_code == 0, found.output
    assert (tmp_path / "mine" / "table.csv").is_file()


def test_status_report_and_replay_of_a_run(tmp_path):
    assert command("run", "wrap-errors", *SMALL, "--set", "patch.snr=0,10", "--out", tmp_path).exit_code == 0
    folder = tmp_path / "wrap-errors"
    written = {name: (folder / name).read_bytes() for name in ("table.csv", "differences.csv", "report.html")}
    for name in written:
        (folder / name).unlink()
    assert command("report", folder).exit_code == 0
    for name, content in written.items():
        assert (folder / name).read_bytes() == content
    assert "4 of 4 blocks are there" in command("status", folder).stdout
    next((folder / "blocks").glob("*.parquet")).unlink()
    assert "2 of 4 blocks are there" in command("status", folder).stdout
    shown = command("replay", folder, 1, 0)
    assert shown.exit_code == 0
    assert "cross-correlation" in shown.stdout
    shown = command("replay", folder, 1, 0, 7)
    assert shown.exit_code == 0
    assert len(shown.stdout.strip().splitlines()) == 4
    assert "wrap_error_probability" in shown.stdout
    for arguments, message in [
        (["replay", folder, 2, 0], "point is 2; it must lie between 0 and 1"),
        (["replay", folder, 0, 2], "block is 2; it must lie between 0 and 1"),
        (["replay", folder, 0, 0, 50], "trial is 50; it must lie between 0 and 49"),
        (["status", tmp_path], f"{tmp_path} is no folder of a run; it must hold a manifest.json"),
    ]:
        found = command(*arguments)
        assert found.exit_code == 2
        assert found.stderr.strip().startswith(f"twinecho: {message}")


def test_a_changed_design_is_refused_and_fresh_starts_beside(tmp_path):
    assert command("run", "wrap-errors", *SMALL, "--out", tmp_path).exit_code == 0
    refused = command("run", "wrap-errors", *SMALL, "--seed", "7", "--out", tmp_path)
    assert refused.exit_code == 2
    assert "another design: seed was 2026, is 7" in refused.stderr
    assert command("run", "wrap-errors", *SMALL, "--seed", "7", "--fresh", "--out", tmp_path).exit_code == 0
    assert (tmp_path / "wrap-errors-2" / "table.csv").is_file()


def test_shards_are_run_and_merged(tmp_path):
    for k in (1, 2):
        assert command("run", "wrap-errors", *SMALL, "--shard", f"{k}/2", "--out", tmp_path).exit_code == 0
    parts = [tmp_path / f"wrap-errors-shard-{k}-of-2" for k in (1, 2)]
    found = command("merge", tmp_path / "whole", parts[0])
    assert found.exit_code == 0, found.output
    assert "1 blocks are missing:" in found.stdout
    found = command("merge", tmp_path / "whole", *parts)
    assert "nothing is missing" in found.stdout
    assert command("run", "wrap-errors", *SMALL, "--out", tmp_path).exit_code == 0
    tables = [(tmp_path / name / "differences.csv").read_bytes() for name in ("whole", "wrap-errors")]
    assert tables[0] == tables[1]


def test_the_page_stands_alone(tmp_path):
    assert command("run", "wrap-errors", *SMALL, "--out", tmp_path).exit_code == 0
    page = (tmp_path / "wrap-errors" / "report.html").read_text()
    assert "How often does each estimator pick the wrong wrap" in page
    assert page.count("<svg ") == 2
    assert not re.search(r"(?:src|href)\s*=\s*[\"'](?!data:|#)", page)
    assert "twinecho run manifest.json --seed 2026 --out again" in page
    again = command("run", tmp_path / "wrap-errors" / "manifest.json", "--jobs", "1", "--out", tmp_path / "again")
    assert again.exit_code == 0, again.output
    tables = [(folder / "wrap-errors" / "differences.csv").read_bytes() for folder in (tmp_path, tmp_path / "again")]
    assert tables[0] == tables[1]


def test_list_names_studies_and_estimators():
    found = command("list")
    assert found.exit_code == 0
    for name in ("box-scene", "wrap-errors", "phase-slope-refined", "--set scene.snr=inf,15"):
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
