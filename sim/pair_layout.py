"""What a file with a pair holds, in netCDF, HDF5 and npz alike: names, units, axes (`docs/measured-data.md`)."""

from collections.abc import Mapping
from importlib import import_module
from types import MappingProxyType
from typing import Any

AXES = ("along_track", "time")

ATTRIBUTES: Mapping[str, Mapping[str, str]] = MappingProxyType(
    {
        "primary": {"units": "1", "long_name": "complex baseband of the primary receiver"},
        "secondary": {"units": "1", "long_name": "complex baseband of the secondary receiver"},
        "time": {"units": "s", "long_name": "time after transmission at the primary receiver", "axis": "X"},
        "along_track": {"units": "m", "long_name": "distance along track", "axis": "Y"},
        "sample_rate": {"units": "Hz", "long_name": "samples per second"},
        "centre_frequency": {"units": "Hz", "long_name": "carrier that was mixed down to zero"},
        "bandwidth": {"units": "Hz", "long_name": "width of the band"},
        "altitude": {"units": "m", "long_name": "height of the primary receiver above the reference plane"},
        "baseline": {"units": "m", "long_name": "vertical distance of the secondary receiver above the primary"},
        "sound_speed": {
            "units": "m s-1",
            "long_name": "speed of sound",
            "standard_name": "speed_of_sound_in_sea_water",
        },
        "row_looks": {"units": "1", "long_name": "independent looks in a row among many"},
    }
)
"""Units and words of every variable."""

NEEDED = ("sample_rate", "centre_frequency", "bandwidth")

PLACED = ("altitude", "baseline", "sound_speed")
"""What of the sonar places a pair: all or none of it is given."""


def xarray_with_h5netcdf() -> Any:
    """The module xarray; ImportError, in one line, where it or h5netcdf is not installed."""
    try:
        import_module("h5netcdf")
        return import_module("xarray")
    except ImportError as error:
        raise ImportError(
            f"{error.name} is not installed; netCDF and HDF5 need it: pip install 'twinecho[data]'"
        ) from None
