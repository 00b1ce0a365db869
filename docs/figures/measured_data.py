"""Draws `measured-data.png`: a simulated seabed that went through a file, samples lost, and came back."""

from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory

import matplotlib.pyplot as plt
import numpy as np
import xarray as xr

from sim import SONARS, Box, Scene, Wedge, simulate, write_pair
from studies.estimate_file import estimate_file

SONAR = SONARS["hisas-100khz"]
LOST = slice(60, 90), slice(780, 900)


def main():
    """Simulate, write, estimate in blocks, read, draw and save."""
    scene = Scene((25.0, 60.0), features=[Box(start=30.0, width=4.0, height=1.0), Wedge(45.0, 6.0, 1.0)])
    pair = simulate(scene, SONAR, rng=np.random.default_rng(2026), snr=15.0, rows=128)
    missing = np.zeros(pair.shape, dtype=bool)
    missing[LOST] = True
    series = {name: np.where(missing, 0, getattr(pair, name)) for name in ("primary", "secondary")}
    with TemporaryDirectory() as folder:
        write_pair(replace(pair, **series, missing=missing), f"{folder}/pair.nc")
        estimate_file(Path(folder, "pair.nc"), "CrossCorrelation", "5x17", Path(folder, "out.nc"), block=32)
        with xr.open_dataset(f"{folder}/out.nc", engine="h5netcdf") as file:
            found = file.load()
    trusted = (found.valid == 1) & (found.wrap_error_probability < 0.01)
    depth, true = found.depth.where(trusted), SONAR.altitude - pair.truth.height
    millis = 1e3 * found.time
    figure, (above, below) = plt.subplots(2, 1, figsize=(10, 6.5), sharex=True, layout="constrained")
    extent = (float(millis[0]), float(millis[-1]), float(found.along_track[0]), float(found.along_track[-1]))
    shown = above.imshow(depth, origin="lower", aspect="auto", extent=extent, cmap="viridis_r", vmin=13.9, vmax=15.1)
    above.set_facecolor("0.85")
    above.set_ylabel("along track [m]")
    above.set_title("Depth estimated from the file, in blocks of 32 rows; grey: not valid or doubted", loc="left")
    figure.colorbar(shown, ax=above, label="depth below the sonar [m]", pad=0.01)
    row = 64
    here, std = depth[row], 1.96 * found.depth_std[row]
    below.fill_between(millis, here - std, here + std, color="#56b4e9", label="95 % interval", linewidth=0)
    below.plot(millis, here, color="black", linewidth=0.8, label="estimate")
    below.plot(millis, true, color="#d55e00", linewidth=1.2, label="simulated")
    below.set_ylim(15.3, 13.7)
    below.set_ylabel("depth [m]")
    below.set_xlabel("time [ms]")
    below.set_title(f"Row {row}", loc="left")
    below.legend(ncols=3, loc="lower left")
    figure.savefig(Path(__file__).with_name("measured-data.png"), dpi=110)


if __name__ == "__main__":
    main()
