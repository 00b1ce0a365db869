import re
import sys
from dataclasses import replace

import numpy as np
import pytest
import xarray as xr
from matplotlib.image import imread
from typer.testing import CliRunner

from estimators import CrossCorrelation, FixedWindow, TwoWindow
from sim import SONARS, Box, PairFile, Scene, open_pair, read_pair, simulate, speckle_pair, write_pair
from studies.cli import app
from studies.estimate_file import estimate_file

ROWS = 30
HOLE = slice(10, 14), slice(300, 360)


@pytest.fixture(scope="module")
def simulated():
    scene = Scene(ground_range=(25.0, 35.0), features=[Box(start=28.0, width=3.0, height=0.5)])
    return simulate(scene, SONARS["hisas-100khz"], rng=np.random.default_rng(1), snr=15.0, rows=ROWS)


@pytest.fixture(scope="module")
def folder(simulated, tmp_path_factory):
    """The simulated pair in all kinds of files, whole in `whole.nc` and with a hole in the others."""
    folder = tmp_path_factory.mktemp("estimate")
    write_pair(simulated, folder / "whole.nc")
    missing = np.zeros(simulated.shape, dtype=bool)
    missing[HOLE] = True
    series = {name: np.where(missing, 0, getattr(simulated, name)) for name in ("primary", "secondary")}
    for kind in ("nc", "h5", "npz"):
        write_pair(replace(simulated, **series, missing=missing), folder / f"hole.{kind}")
    return folder


def loaded(path):
    with xr.open_dataset(path, engine="h5netcdf") as dataset:
        return dataset.load()


def command(*arguments):
    return CliRunner().invoke(app, ["estimate", *(str(argument) for argument in arguments)])


def test_a_simulated_seabed_comes_back(simulated, folder, tmp_path):
    """From the simulator through a file and the command to depths that are the true ones."""
    out = tmp_path / "out.nc"
    done = command(folder / "whole.nc", "--window", "5x9", "--search", "2e-5", "--block", "7", "--out", out)
    assert done.exit_code == 0, done.output
    found, truth = loaded(out), simulated.truth
    sonar = simulated.geometry.sonar
    # Windows that see one part of the seabed, away from walls.
    edges = ~np.isfinite(np.atleast_2d(truth.height)[0]) | (np.abs(np.gradient(np.atleast_2d(truth.height)[0])) > 1e-3)
    plain = np.convolve(edges, np.ones(21), mode="same") == 0
    kept = np.zeros(simulated.shape, dtype=bool)
    kept[2:-2, plain] = True
    assert kept.mean() > 0.3
    assert found.valid.to_numpy()[kept].mean() > 0.999
    error = found.depth - (sonar.altitude - np.atleast_2d(truth.height))
    score = (error / found.depth_std).to_numpy()[kept & (found.valid.to_numpy() == 1)]
    # 95 % intervals cover 93 to 97 % of errors (README): errors have .90 to 1.08 of the predicted spread; 4.9 standard
    # errors of a mean square of as many independent windows as hold all pixels, for a false-alarm rate of 1e-6.
    chance = 4.9 * np.sqrt(2 / (score.size / (5 * 9)))
    assert 0.90**2 - chance < np.mean(score**2) < 1.08**2 + chance
    # The file gives what the pair gives in memory, to the last bit.
    pair = read_pair(folder / "whole.nc")
    direct = CrossCorrelation(FixedWindow(5, 9), search=2e-5).estimate(pair)
    expected = np.where(found.valid == 1, direct.delay, np.nan)
    np.testing.assert_array_equal(found.delay, expected)


def test_bits_do_not_depend_on_the_block_nor_on_the_kind_of_file(folder, tmp_path):
    first = None
    for kind, block in (("nc", 1), ("nc", 10), ("h5", 17), ("npz", 1000), ("npz", None)):
        estimate_file(folder / f"hole.{kind}", "CrossCorrelation", "5x9", tmp_path / "out.nc", block=block)
        found = loaded(tmp_path / "out.nc")
        first = found if first is None else first
        xr.testing.assert_identical(found, first)


def test_missing_samples_make_invalid_estimates_and_no_others(simulated, folder, tmp_path):
    out = tmp_path / "out.nc"
    said = estimate_file(folder / "hole.nc", "CrossCorrelation", "5x9", out)
    rows, samples = simulated.shape
    share = 4 * 60 / (rows * samples)
    assert f"{100 * share:.3g} % of samples NaN" in said
    found = loaded(out)
    assert found.valid.attrs["missing_share"] == pytest.approx(share)
    estimate_file(folder / "whole.nc", "CrossCorrelation", "5x9", tmp_path / "whole.nc")
    whole = loaded(tmp_path / "whole.nc")
    # Half a window, and a resolution cell of two samples, to either side of the hole.
    cell = int(np.ceil(simulated.sample_rate / simulated.bandwidth))
    near = np.zeros(simulated.shape, dtype=bool)
    near[8:16, 300 - 4 - cell : 360 + 4 + cell] = True
    assert not found.valid.to_numpy()[near].any()
    # Elsewhere a hole takes side lobes of the echoes away: what is found changes by little of its spread.
    away = ~near & (whole.valid.to_numpy() == 1) & (whole.wrap_error_probability.to_numpy() < 1e-3)
    assert found.valid.to_numpy()[away].all()
    moved = np.abs(found.delay - whole.delay) / whole.delay_std
    assert moved.to_numpy()[away].max() < 2.0
    for name in ("delay", "delay_std", "coherence", "wrap_error_probability", "depth", "depth_std", "ground_range"):
        assert np.isfinite(found[name].to_numpy()[found.valid == 1]).all(), name
        assert np.isnan(found[name].to_numpy()[near]).all(), name


def test_the_file_says_what_it_holds(folder, tmp_path):
    done = command(
        folder / "whole.nc", "--estimator", "SplitSpectrum", "--window", "3x15", "--out", tmp_path / "out.nc"
    )
    assert re.fullmatch(
        r"wrote .*out.nc and .*out.png: 30 x \d+ pixels, [\d.]+ % valid, 0 % of samples NaN\n", done.stdout
    )
    found = loaded(tmp_path / "out.nc")
    assert found.attrs["Conventions"].startswith("CF-")
    assert found.attrs["source"] == "SplitSpectrum with a window of 3x15 pixels"
    assert {name: found[name].attrs["units"] for name in found.variables} == {
        **{"time": "s", "along_track": "m", "intensity": "dB", "delay": "s", "delay_std": "s", "coherence": "1"},
        **{"wrap_error_probability": "1", "valid": "1", "depth": "m", "depth_std": "m", "ground_range": "m"},
    }
    assert found.valid.attrs["flag_meanings"] == "not_valid valid"
    np.testing.assert_array_equal(found.valid.attrs["flag_values"], [0, 1])
    with open_pair(folder / "whole.nc") as file:
        np.testing.assert_array_equal(found.time, file.times)
        np.testing.assert_array_equal(found.along_track, file.places())
    height, width, _ = imread(tmp_path / "out.png").shape
    assert height > 800
    assert width > 1000


BROKEN = """
class Broken:
    def __init__(self, window):
        pass

    def estimate(self, pair):
        return 1 / 0


class Leaves(Broken):
    def estimate(self, pair):
        raise SystemExit(0)


class Speaks(Broken):
    def estimate(self, pair):
        return "no delay"
"""


def test_without_a_geometry_there_is_no_depth(tmp_path):
    shape, rates = (12, 64), {"centre_frequency": 100e3, "bandwidth": 30e3, "sample_rate": 40e3}
    pair = speckle_pair(shape, coherence=0.99, delay=2e-6, **rates, rng=np.random.default_rng(2))
    np.savez(tmp_path / "pair.npz", primary=pair.primary, secondary=pair.secondary, **rates)
    estimate_file(tmp_path / "pair.npz", "CrossCorrelation", "5x9", tmp_path / "out.nc")
    found = loaded(tmp_path / "out.nc")
    assert "depth" not in found
    valid = found.valid == 1
    # All windows that lie within the record: 8 rows of 56 samples.
    assert int(valid.sum()) == 8 * 56
    assert float(found.delay.where(valid).mean()) == pytest.approx(2e-6, abs=2e-8)


def test_no_more_than_a_block_is_read_at_a_time(folder, tmp_path, monkeypatch):
    read, rows = [], PairFile.rows
    monkeypatch.setattr(PairFile, "rows", lambda file, chosen: read.append(chosen) or rows(file, chosen))
    estimate_file(folder / "whole.nc", "CrossCorrelation", "3x9", tmp_path / "out.nc", block=6)
    # One row to check the file, then blocks with a window of rows to either side.
    assert read == [slice(0, 1), *(slice(max(at - 3, 0), min(at + 9, ROWS)) for at in range(0, ROWS, 6))]


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["no.nc"], "[Errno 2] No such file or directory: 'no.nc'"),
        (["text.nc"], "text.nc: it is neither netCDF-4, HDF5 nor npz; it must be one of them"),
        (["bare.npz"], "bare.npz: sample_rate is missing; it must be given, in Hz"),
        (["nan.npz"], "nan.npz: no sample is finite; some must be"),
        (["good.npz", "--window", "9"], "window is '9'; it must be ROWSxSAMPLES, such as 9x9"),
        (["good.npz", "--window", "0x9"], "rows of the window is 0; it must be a whole number of at least 1"),
        (["good.npz", "--window", "99x9"], "good.npz: the window has 99 rows; the pair has 12, and it must not"),
        (["good.npz", "--estimator", "Cross"], "method is 'Cross'; it must be module:object, or one of "),
        (["good.npz", "--estimator", "my_broken:Broken"], "good.npz: Broken failed: ZeroDivisionError: "),
        (
            ["good.npz", "--estimator", "my_broken:nothing"],
            "method is 'my_broken:nothing'; it must be an object",
        ),
        (["good.npz", "--estimator", "my_broken:Leaves"], "good.npz: Leaves failed: SystemExit: 0"),
        (["good.npz", "--estimator", "my_broken:Speaks"], "good.npz: Speaks gave what is no estimate: it gives a str"),
        (["good.npz", "--window", "999999999x999999999"], "good.npz: the window has 999999999 rows; the pair has 12"),
        (["good.npz", "--out", "folder.nc"], "out is folder.nc, a folder; it must be a file"),
        (["good.npz", "--search", "-1"], "good.npz: search is -1 s; it must be above 0 s"),
        (["good.npz", "--search", "1"], "good.npz: search is 1 s; it must not exceed half the record"),
        (["good.npz", "--block", "0"], "good.npz: block is 0; it must be a whole number of at least 1"),
        (["good.npz", "--out", "out.txt"], "out is out.txt; it must end with .nc"),
        (["good.npz", "--out", "no/such/out.nc"], "[Errno 2] "),
    ],
)
def test_bad_input_is_one_line_and_status_2(arguments, message, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    rates = {"centre_frequency": 100e3, "bandwidth": 30e3, "sample_rate": 40e3}
    good = np.ones((12, 64)) + 0j
    np.savez("good.npz", primary=good, secondary=good, **rates)
    np.savez("nan.npz", primary=np.nan * good, secondary=good, **rates)
    np.savez("bare.npz", primary=good, secondary=good)
    (tmp_path / "text.nc").write_text("hello")
    (tmp_path / "my_broken.py").write_text(BROKEN)
    (tmp_path / "folder.nc").mkdir()
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.setattr(sys, "dont_write_bytecode", True)
    before = set(tmp_path.iterdir())
    found = command(*arguments)
    assert found.exit_code == 2, found.output
    assert found.stderr.strip().splitlines()[-1].startswith(f"twinecho: {message}")
    assert "Traceback" not in found.output
    assert set(tmp_path.iterdir()) == before


def test_the_file_that_is_read_is_not_written_over(folder):
    found = command(folder / "whole.nc", "--out", folder / "whole.nc")
    assert found.exit_code == 2
    assert "the file that is read; it must be another" in found.stderr


def test_two_windows_give_the_same_bits_whatever_the_block(folder, tmp_path):
    """A phase over more rows than the wrap, too: blocks and the rows around them hold whole windows of both."""
    pair = read_pair(folder / "whole.nc")
    direct = TwoWindow(CrossCorrelation(FixedWindow(3, 9), search=2e-5), FixedWindow(4, 1)).estimate(pair)
    chosen = ("--estimator", "TwoWindow", "--window", "3x9", "--search", "2e-5", "--option", "phase=[4, 1]")
    for block in (1, 13, 1000):
        out = tmp_path / "out.nc"
        done = command(folder / "whole.nc", *chosen, "--block", block, "--out", out)
        assert done.exit_code == 0, done.output
        found = loaded(out)
        np.testing.assert_array_equal(found.delay, np.where(found.valid == 1, direct.delay, np.nan))
    assert found.valid.to_numpy().mean() > 0.5


def test_an_option_that_cannot_be_is_one_line(folder, tmp_path):
    for option, said in (("phase", "it must be NAME=VALUE"), ("phse=[1, 1]", "did you mean phase?")):
        done = command(folder / "whole.nc", "--estimator", "TwoWindow", "--option", option, "--out", tmp_path / "o.nc")
        assert done.exit_code == 2
        assert said in " ".join(done.output.split())
