"""What numbers were computed with: versions of libraries, and the kind of processor."""

import platform
from collections.abc import Mapping
from functools import cache
from importlib.metadata import version

import llvmlite.binding
import netCDF4

_COMPUTE = ("numpy", "scipy", "numba", "llvmlite", "xarray", "netCDF4")


@cache
def environment() -> Mapping[str, str]:
    """Give the version of Python and of each library that the last bits of a result may hang on.

    Returns
    -------
    mapping
        Version by name; ``system`` and ``processor`` are those that numba compiles for.
    """
    return {
        "python": platform.python_version(),
        **{name: version(name) for name in _COMPUTE},
        "netcdf-c": str(netCDF4.__netcdf4libversion__),
        "hdf5": str(netCDF4.__hdf5libversion__),
        "system": f"{platform.system()} {platform.machine()}",
        "processor": str(llvmlite.binding.get_host_cpu_name()),
    }
