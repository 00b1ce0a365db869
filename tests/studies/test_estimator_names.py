"""Estimators of installed packages, found by their entry points in a folder that is made like a site directory."""

import subprocess
import sys

import numpy as np
import pytest
from typer.testing import CliRunner

from estimators import FixedWindow
from studies import catalogue, engine, manifest, report
from studies.cli import app
from studies.estimator_names import estimator_class, source_of
from studies.method import EstimatorSection, Method

MODULE = """
from estimators import CrossCorrelation

class Plain(CrossCorrelation):
    pass

class Mirrored(CrossCorrelation):
    def estimate(self, pair):
        from dataclasses import replace
        estimate = super().estimate(pair)
        return replace(estimate, delay=-estimate.delay)
"""


@pytest.fixture
def install(tmp_path, monkeypatch):
    """Put a package with entry points into a site directory."""
    site = tmp_path / "site"
    site.mkdir()
    (site / "of_a_package.py").write_text(MODULE)
    monkeypatch.syspath_prepend(site)
    monkeypatch.delitem(sys.modules, "of_a_package", raising=False)

    def put(package, **names):
        folder = site / f"{package}-1.5.dist-info"
        folder.mkdir()
        (folder / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {package}\nVersion: 1.5\n")
        entries = "".join(f"{name} = {value}\n" for name, value in names.items())
        (folder / "entry_points.txt").write_text(f"[twinecho.estimators]\n{entries}")
        return site

    return put


def build(name):
    return Method(EstimatorSection(name="own", method=name), FixedWindow(1, 33)).build(np.random.default_rng(1))


def test_an_estimator_of_a_package_is_known_by_its_name(install, tmp_path):
    site = install("delays", plain="of_a_package:Plain", gone="no_such_module:thing")
    assert type(build("plain")).__name__ == "Plain"
    digest = source_of("of_a_package:Plain")
    assert len(digest) == 16
    assert source_of("plain") == f"delays 1.5 {digest}"
    study = catalogue.study("wrap-errors").with_values(
        {
            "estimators": [{"name": n, "method": m} for n, m in (("own", "plain"), ("shipped", "CrossCorrelation"))],
            "patch.looks": [9],
            "patch.snr": [8],
            "sonar.bandwidth": ["30 kHz"],
            "trials": {"count": 100, "block": 100},
        }
    )
    engine.run(study, engine.Run(jobs=1, backend="sequential"), tmp_path / "out")
    table = report.result(study, engine.store_of(study, 2026, tmp_path / "out")).table.set_index("estimator")
    assert table.rmse["own"] == table.rmse["shipped"] > 0
    assert manifest.read(tmp_path / "out")["fixed"]["estimators.own"]["source"] == f"delays 1.5 {digest}"
    # A new process finds it by itself.
    call = [sys.executable, "-c", "from studies.cli import main; main()", "check-estimator", "plain", "--window", "1x9"]
    done = subprocess.run(call, env={"PYTHONPATH": str(site), "PATH": ""}, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout.startswith(
        "plain: 0 findings, with a window of 1x9 pixels, on 9 x 256 samples of simulated spec"
    )


@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("plan", "method is 'plan'; it must be module:object, or one of .*, plain, .*; did you mean plain?"),
        ("SplitSpectrum", "method is 'SplitSpectrum', of twinecho and of delays 1.5; it must be of one package alone"),
        ("twice", "method is 'twice', of (delays|others) 1.5 and of (others|delays) 1.5; it must be of one package"),
        ("gone", "method is 'gone' of delays 1.5, which cannot be imported: ModuleNotFoundError: No module named 'no_"),
        ("absent", "method is 'absent' of delays 1.5, which cannot be imported: AttributeError: .* 'Absent'"),
        ("garbled", "method is 'garbled' of delays 1.5, which cannot be imported: "),
        ("module", "module cannot be made with {}: TypeError: 'module' object is not callable"),
    ],
)
def test_a_name_that_is_no_estimator_is_one_line(install, name, said):
    install(
        "delays",
        plain="of_a_package:Plain",
        SplitSpectrum="of_a_package:Plain",
        twice="of_a_package:Plain",
        gone="no_such_module:thing",
        absent="of_a_package:Absent",
        garbled="of a package! Plain",
        module="of_a_package",
    )
    install("others", twice="of_a_package:Plain")
    with pytest.raises(ValueError, match=said.replace("{}", r"\{\}").replace("?", r"\?")):
        build(name)
    found = CliRunner().invoke(app, ["check-estimator", name])
    assert found.exit_code == 2
    assert found.stderr.count("\n") == 1
    # What is not named does no harm.
    assert estimator_class("CrossCorrelation").__name__ == "CrossCorrelation"


def test_check_estimator_says_what_fails(install):
    install("delays", mirrored="of_a_package:Mirrored")
    found = CliRunner().invoke(app, ["check-estimator", "mirrored", "--window", "3x33"])
    assert found.exit_code == 1
    lines = found.stdout.splitlines()
    # The second receiver's delay is negated: by 0.2 wraps more it falls by as much.
    assert lines[:-1] == [
        "a delay of -0.2 wraps more moves the median estimate by 0.2 wraps",
        "a delay of 0.2 wraps more moves the median estimate by -0.2 wraps",
    ]
    assert lines[-1].startswith("mirrored: 2 findings, with a window of 3x33 pixels, on 9 x 256 samples of")
    assert "receivers swapped" in lines[-1]
    assert "missing samples" in lines[-1]


@pytest.mark.parametrize(
    ("window", "said"),
    [
        ("9", "window is '9'; it must be ROWSxSAMPLES, such as 9x9"),
        ("0x9", "rows of the window is 0; it must be"),
        ("1x99999", "window has 99999 pixels; it must have 10000 at the most"),
    ],
)
def test_a_bad_window_is_one_line(window, said):
    found = CliRunner().invoke(app, ["check-estimator", "CrossCorrelation", "--window", window])
    assert found.exit_code == 2
    assert found.stderr.startswith(f"twinecho: {said}")
    assert found.stderr.count("\n") == 1
