import pickle
import sys
import zipfile

import h5py
import numpy as np
import pytest
import xarray as xr

from estimators import FixedWindow, VaryingWindow
from sim import EchoPair, Geometry, Sonar, open_pair, read_pair, write_pair

SONAR = Sonar(centre_frequency=100e3, bandwidth=30e3, baseline=0.4, altitude=15.0, sound_speed=1480.0)
KINDS = ("pair.nc", "pair.h5", "pair.npz")


def noise(shape, dtype=np.complex128, seed=1):
    real, imag = np.random.default_rng(seed).standard_normal((2, *shape))
    return (real + 1j * imag).astype(dtype)


def arrays(rows=4, samples=50):
    """A file's variables, as a user would write them; also what is expected when it is read."""
    return {
        "primary": noise((rows, samples)),
        "secondary": noise((rows, samples), seed=2),
        "sample_rate": 40e3,
        "centre_frequency": 100e3,
        "bandwidth": 30e3,
        "altitude": 15.0,
        "baseline": 0.4,
        "sound_speed": 1480.0,
        "time": 0.04 + np.arange(samples) / 40e3,
        "along_track": 7.0 + 0.03 * np.arange(rows),
    }


def saved(path, values):
    if path.suffix == ".npz":
        np.savez(path, **values)
    else:
        with h5py.File(path, "w") as file:
            for name, value in values.items():
                file[name] = value
    return path


def pair_of(dtype=np.complex128, missing=None):
    series = [noise((3, 40), dtype, seed) for seed in (1, 2)]
    if missing is not None:
        series = [np.where(missing, dtype(0), one) for one in series]
    return EchoPair(
        *series,
        sample_rate=40e3,
        centre_frequency=100e3,
        bandwidth=30e3,
        geometry=Geometry(SONAR, 0.04),
        row_spacing=0.03,
        row_looks=0.5,
        missing=missing,
    )


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("dtype", [np.complex64, np.complex128])
def test_what_is_written_is_read(kind, dtype, tmp_path):
    missing = np.zeros((3, 40), dtype=bool)
    missing[1, 5:9] = True
    for pair in (pair_of(dtype), pair_of(dtype, missing)):
        write_pair(pair, tmp_path / kind)
        read = read_pair(tmp_path / kind)
        for name in ("primary", "secondary"):
            assert getattr(read, name).dtype == dtype
            np.testing.assert_array_equal(getattr(read, name), getattr(pair, name))
        np.testing.assert_array_equal(read.missing, pair.missing)
        assert read.geometry == pair.geometry
        for name in ("sample_rate", "centre_frequency", "bandwidth", "row_looks"):
            assert getattr(read, name) == getattr(pair, name)
        assert read.row_spacing == pytest.approx(0.03, rel=1e-14)
        assert not read.circular


@pytest.mark.parametrize("kind", ["pair.h5", "pair.npz"])
@pytest.mark.parametrize("parts", [False, True])
def test_what_a_user_writes_is_read(kind, parts, tmp_path):
    values = arrays()
    stored = dict(values)
    if parts:
        for name in ("primary", "secondary"):
            whole = np.round(1000 * stored.pop(name))
            values[name] = whole
            stored[f"{name}_real"], stored[f"{name}_imag"] = whole.real.astype(np.int16), whole.imag.astype(np.int16)
    with open_pair(saved(tmp_path / kind, stored)) as file:
        assert file.shape == (4, 50)
        some = file.rows(slice(1, 3))
        np.testing.assert_array_equal(file.places(), values["along_track"])
    np.testing.assert_array_equal(some.primary, values["primary"][1:3])
    np.testing.assert_array_equal(some.secondary, values["secondary"][1:3])
    assert some.geometry == Geometry(SONAR, 0.04)
    assert some.row_spacing == pytest.approx(0.03, rel=1e-12)


def test_npz_compressed_and_by_columns(tmp_path):
    values = arrays()
    np.savez_compressed(tmp_path / "a.npz", **values)
    np.savez(tmp_path / "b.npz", **{**values, "primary": np.asfortranarray(values["primary"])})
    for name in ("a.npz", "b.npz"):
        with open_pair(tmp_path / name) as file:
            np.testing.assert_array_equal(file.rows(slice(2, 4)).primary, values["primary"][2:4])


@pytest.mark.parametrize("dtype", [">c16", ">c8", np.clongdouble])
def test_other_numbers_become_native_ones(dtype, tmp_path):
    values = arrays()
    np.savez(tmp_path / "pair.npz", **{**values, "primary": values["primary"].astype(dtype)})
    read = read_pair(tmp_path / "pair.npz").primary
    assert read.dtype == (np.complex64 if dtype == ">c8" else np.complex128)
    np.testing.assert_array_equal(read, values["primary"].astype(read.dtype))


def test_a_vector_is_a_row_and_places_may_be_unknown(tmp_path):
    values = {name: value for name, value in arrays(1).items() if name in ("sample_rate", "centre_frequency")}
    series = noise((50,))
    values |= {"bandwidth": 30e3, "primary": series, "secondary": series}
    pair = read_pair(saved(tmp_path / "pair.h5", values))
    assert pair.shape == (1, 50)
    assert pair.geometry is None
    assert pair.row_spacing is None


def test_netcdf_has_cf_names_units_and_attributes(tmp_path):
    write_pair(pair_of(), tmp_path / "pair.nc")
    with xr.open_dataset(tmp_path / "pair.nc", engine="h5netcdf") as dataset:
        assert dataset.attrs["Conventions"].startswith("CF-")
        assert dataset.primary_real.dims == ("along_track", "time")
        units = {name: dataset[name].attrs["units"] for name in dataset.variables}
        assert all(dataset[name].attrs["long_name"] for name in dataset.variables)
        assert dataset.sound_speed.attrs["standard_name"] == "speed_of_sound_in_sea_water"
        np.testing.assert_array_equal(dataset.secondary_imag, pair_of().secondary.imag)
    assert units == {
        **dict.fromkeys(("primary_real", "primary_imag", "secondary_real", "secondary_imag", "row_looks"), "1"),
        **dict.fromkeys(("sample_rate", "centre_frequency", "bandwidth"), "Hz"),
        **dict.fromkeys(("altitude", "baseline", "along_track"), "m"),
        "time": "s",
        "sound_speed": "m s-1",
    }


def test_samples_that_are_not_finite_are_missing(tmp_path):
    values = arrays()
    values["primary"][1, 10] = np.nan
    values["secondary"][2, 20] = complex(0, np.inf)
    expected = np.zeros((4, 50), dtype=bool)
    expected[1, 10] = expected[2, 20] = True
    pair = read_pair(saved(tmp_path / "pair.npz", values))
    np.testing.assert_array_equal(pair.missing, expected)
    for series, name in ((pair.primary, "primary"), (pair.secondary, "secondary")):
        np.testing.assert_array_equal(series, np.where(expected, 0, values[name]))


def test_windows_near_missing_samples_are_not_inside():
    missing = np.zeros((7, 30), dtype=bool)
    missing[3, 12] = True
    pair = EchoPair(*(np.ones((2, 7, 30)) + 0j), 40e3, 100e3, 30e3, missing=missing)
    inside = FixedWindow(3, 5).inside(pair)
    expected = np.zeros((7, 30), dtype=bool)
    expected[1:6, 2:28] = True
    # Half a window, and ceil(40 / 30) = 2 samples of a resolution cell, to either side.
    expected[2:5, 8:17] = False
    np.testing.assert_array_equal(inside, expected)
    varying = VaryingWindow(np.full(30, 3), np.full(30, 5)).inside(pair)
    np.testing.assert_array_equal(varying, expected)


def without(name):
    return lambda values: values.pop(name)


def given(**changed):
    return lambda values: values.update(changed)


@pytest.mark.parametrize("kind", ["pair.h5", "pair.npz"])
@pytest.mark.parametrize(
    ("change", "message"),
    [
        (without("sample_rate"), "sample_rate is missing; it must be given, in Hz"),
        (without("secondary"), "secondary and secondary_real are missing; a series must be complex, or have two parts"),
        (without("sound_speed"), "sound_speed missing beside altitude, baseline; all or none must be given"),
        (without("time"), "time missing beside altitude, baseline, sound_speed; all or none must be given"),
        (given(primary=np.ones((4, 50))), "primary is of type float64; it must be complex, or two variables"),
        (given(primary=noise((4, 49))), "primary has the shape (4, 49) and secondary (4, 50); they must be equal"),
        (given(primary=noise((0, 50))), "primary has the shape (0, 50); it must be (along_track, time), not empty"),
        (given(sample_rate=20e3, time=0.04 + np.arange(50) / 20e3), "bandwidth is 30000 Hz; it must not exceed"),
        (given(sample_rate=0.0), "sample_rate is 0 Hz; it must be above 0 Hz"),
        (given(sample_rate=np.ones(2)), "sample_rate has the shape (2,) and type float64; it must be one number"),
        (given(centre_frequency=10e3), "bandwidth is 30000 Hz; it must be below twice the centre frequency"),
        (given(time=np.arange(50.0)), "time is up to "),
        (given(time=np.full(50, np.nan)), "time is up to nan s off even steps of 2.5e-05 s; it must rise evenly"),
        (given(time=np.arange(9.0)), "time has the shape (9,); the series have 50 there"),
        (
            given(along_track=np.array([0.0, 1.0, 5.0, 6.0])),
            "along_track is up to 1 m off even steps of 2 m",
        ),
        (given(time=np.full(50, 1j)), "time is of type complex128; it must be of real numbers"),
        (given(along_track=np.zeros(4)), "along_track is up to 0 m off even steps of 0 m; it must rise"),
        (given(altitude=-1.0), "altitude is -1 m; it must be above 0 m"),
        (given(primary=np.full((4, 50), np.nan + 0j)), "no sample is finite; some must be"),
    ],
)
def test_bad_files_are_one_line(kind, change, message, tmp_path):
    values = arrays()
    change(values)
    with pytest.raises(ValueError, match=r".*") as raised:
        read_pair(saved(tmp_path / kind, values))
    assert str(raised.value).startswith(f"{tmp_path / kind}: {message}")
    assert "\n" not in str(raised.value)


def test_other_axes_and_units_are_refused(tmp_path):
    write_pair(pair_of(), tmp_path / "pair.nc")
    with xr.open_dataset(tmp_path / "pair.nc", engine="h5netcdf") as file:
        dataset = file.load()
    dataset.transpose().to_netcdf(tmp_path / "turned.nc", engine="h5netcdf")
    with pytest.raises(ValueError, match=r"primary_real has the axes \(time, along_track\); they must be"):
        read_pair(tmp_path / "turned.nc")
    dataset.bandwidth.attrs["units"] = "kHz"
    dataset.to_netcdf(tmp_path / "kilo.nc", engine="h5netcdf")
    with pytest.raises(ValueError, match="bandwidth is in kHz; it must be in Hz"):
        read_pair(tmp_path / "kilo.nc")


def test_what_is_no_such_file_is_one_line(tmp_path):
    with pytest.raises(FileNotFoundError):
        read_pair(tmp_path / "no.nc")
    (tmp_path / "text.nc").write_text("hello")
    with pytest.raises(ValueError, match="it is neither netCDF-4, HDF5 nor npz"):
        read_pair(tmp_path / "text.nc")
    (tmp_path / "zip.npz").write_bytes(b"PK and nothing")
    with pytest.raises(ValueError, match="it is not an npz file"):
        read_pair(tmp_path / "zip.npz")
    (tmp_path / "cut.nc").write_bytes(b"\x89HDF\r\n\x1a\n and nothing")
    with pytest.raises(ValueError, match=r"cut\.nc: it cannot be read, OSError: .*(truncated|signature|open)"):
        read_pair(tmp_path / "cut.nc")
    with pytest.raises(ValueError, match=r"it must end with \.nc, \.h5, \.hdf5 or \.npz"):
        write_pair(pair_of(), tmp_path / "pair.mat")


# Of a file that it could not open h5netcdf says so once more when it is collected.
@pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning")
def test_a_damaged_file_is_a_value_error_that_names_it(tmp_path):
    """Bytes overwritten anywhere give samples or one line."""
    import h5py

    write_pair(pair_of(), tmp_path / "pair.nc")
    whole = (tmp_path / "pair.nc").read_bytes()
    rng = np.random.default_rng(11)
    refused = []
    for place in [8, 100, len(whole) - 200, *rng.integers(8, len(whole) - 16, 60)]:
        (tmp_path / "damaged.nc").write_bytes(whole[:place] + b"\xff" * 16 + whole[place + 16 :])
        try:
            read_pair(tmp_path / "damaged.nc")
        except ValueError as error:
            refused.append(str(error))
    assert len(refused) > 2
    assert all("damaged.nc" in said for said in refused)
    with h5py.File(tmp_path / "pair.nc", "a") as file:
        del file["time"]
    with pytest.raises(ValueError, match=r"pair\.nc: it cannot be read, "):
        read_pair(tmp_path / "pair.nc")


class Trap:
    """Says so when it is made of a pickle."""

    made = False

    def __setstate__(self, state):
        Trap.made = True


def test_no_pickle_is_read(tmp_path):
    values = arrays()
    trap = Trap()
    trap.text = "x"
    for name in ("primary", "sample_rate"):
        np.savez(tmp_path / "pair.npz", **{**values, name: np.array([trap], dtype=object)})
        with pytest.raises(ValueError, match=f"{name} is pickled; it must be an array of numbers"):
            read_pair(tmp_path / "pair.npz")
    with zipfile.ZipFile(tmp_path / "raw.npz", "w") as archive:
        archive.writestr("primary.npy", pickle.dumps(trap))
    with pytest.raises(ValueError, match="magic string"):
        read_pair(tmp_path / "raw.npz")
    assert not Trap.made


def test_without_the_extra_it_says_so(monkeypatch, tmp_path):
    write_pair(pair_of(), tmp_path / "pair.nc")
    monkeypatch.setitem(sys.modules, "xarray", None)
    for act in (lambda: read_pair(tmp_path / "pair.nc"), lambda: write_pair(pair_of(), tmp_path / "other.h5")):
        with pytest.raises(ImportError, match=r"netCDF and HDF5 need it: pip install 'twinecho\[data\]'"):
            act()
    write_pair(pair_of(), tmp_path / "pair.npz")
    assert read_pair(tmp_path / "pair.npz").shape == (3, 40)


def test_a_name_that_is_nearly_one_is_not_ignored(tmp_path):
    """`row_looks` misspelled would make every claimed spread too small."""
    for wrong, meant in (("rowlooks", "row_looks"), ("center_frequency", "centre_frequency"), ("altitud", "altitude")):
        given = {name: value for name, value in arrays().items() if name != meant}
        np.savez(tmp_path / "pair.npz", **given, **{wrong: 0.5})
        with pytest.raises(ValueError, match=f"{wrong} is no variable of a pair; it must be {meant}, or"):
            read_pair(tmp_path / "pair.npz")
    np.savez(tmp_path / "pair.npz", **arrays(), depth_of_the_wreck=3.0)
    read_pair(tmp_path / "pair.npz")


def test_a_sonar_above_all_of_its_echoes_is_refused(tmp_path):
    np.savez(tmp_path / "pair.npz", **(arrays() | {"altitude": 1500.0}))
    with pytest.raises(ValueError, match=r"altitude is 1500 m; it must be below the largest slant range, 30\.5"):
        read_pair(tmp_path / "pair.npz")
