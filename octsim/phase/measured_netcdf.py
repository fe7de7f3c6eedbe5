"""Measured data in netCDF: its variables, and NaN where no value stands."""

import warnings
from pathlib import Path

import netCDF4
import numpy as np
import xarray as xr
from numpy.typing import NDArray

from octsim.base.failures import said_in_a_line
from octsim.base.file_digest import require_undamaged

Array = NDArray[np.float64]


def read_variables(path: Path) -> xr.Dataset:
    """Read the variables of numbers in a netCDF file, with their units.

    The netCDF library says where there is no value: what was never written (its default fill,
    9.97e36 of a float), what is marked by _FillValue or missing_value, and what is out of
    valid_min, valid_max or valid_range. It applies scale_factor and add_offset.

    Raises
    ------
    FileError
        If the file can't be read.
    """
    found = {}
    with said_in_a_line(str(path), "give netCDF or CSV", of_memory=True):
        require_undamaged(path)
        with netCDF4.Dataset(path) as file, warnings.catch_warnings():
            warnings.simplefilter("error")  # what the library can't apply, it warns of
            for name, variable in file.variables.items():
                if variable.dtype is not str and np.dtype(variable.dtype).kind in "iuf":
                    values: Array = np.ma.filled(np.ma.asarray(variable[...], float), np.nan)
                    units = {"units": variable.units} if "units" in variable.ncattrs() else {}
                    found[name] = (variable.dimensions, values, units)
            return xr.Dataset(found)
