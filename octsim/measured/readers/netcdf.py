"""Recordings in netCDF, with NaN where no value stands."""

import warnings
from collections.abc import Iterator
from contextlib import ExitStack
from pathlib import Path
from typing import Any

import netCDF4
import numpy as np

from octsim.measured.readers.blocks import Block, Key, Source
from octsim.measured.readers.inside import Container, Held, recording_of
from octsim.measured.readers.netcdf_classic import require_whole
from octsim.measured.recording import Recording, Wanted

_MARKS = {"_FillValue", "missing_value", "valid_min", "valid_max", "valid_range"}
"""Attributes that say where there is no value."""
_SCALES = {"scale_factor", "add_offset"}


class _Variable:
    """A variable of netCDF as a source.

    Whole numbers stay so, unless an attribute marks some of them as no value or scales them. The
    library's own fill value of whole numbers is not looked for: of uint16 it is 65535, which is
    what a camera that is full says.
    """

    def __init__(self, variable: Any) -> None:
        attributes = set(variable.ncattrs())
        dtype = _dtype(variable)
        self._marked = dtype.kind == "f" or bool(attributes & _MARKS)
        variable.set_auto_mask(self._marked)
        self._variable = variable
        self.shape = tuple(variable.shape)
        self.dtype = _read_as(dtype, attributes)

    def __getitem__(self, key: Key, /) -> Block:
        """Read a part."""
        with warnings.catch_warnings():
            warnings.simplefilter("error")  # what the library can't apply, it warns of
            found = self._variable[key]
        if not self._marked:
            return np.asarray(found)
        return np.asarray(np.ma.filled(np.ma.asarray(found, self.dtype), np.nan))


def _dtype(variable: Any) -> np.dtype[Any]:
    """Return what numbers of a variable are, with those that stand for unsigned ones as such."""
    dtype: np.dtype[Any] = np.dtype(variable.dtype)
    unsigned = "_Unsigned" in variable.ncattrs() and str(variable.getncattr("_Unsigned"))
    if dtype.kind == "i" and str(unsigned).casefold() == "true":
        return np.dtype(f"u{dtype.itemsize}")
    return dtype


def _read_as(dtype: np.dtype[Any], attributes: set[str]) -> np.dtype[Any]:
    if attributes & _SCALES or (dtype.kind in "iu" and attributes & _MARKS):
        return np.dtype(np.float64)
    return dtype


def netcdf_recording(path: Path, wanted: Wanted, stack: ExitStack) -> Recording:
    """Return the recording in a netCDF file, each block of which is read when it is asked for."""
    require_whole(path)
    file = stack.enter_context(netCDF4.Dataset(str(path)))
    variables = dict(_variables(file, ""))
    held = [_held(name, variable) for name, variable in variables.items()]

    def source(one: Held) -> Source:
        return _Variable(variables[one.name])

    return recording_of(Container(path, held, source), wanted)


def _variables(group: Any, folder: str) -> Iterator[tuple[str, Any]]:
    for name, variable in group.variables.items():
        yield folder + name, variable
    for name, one in group.groups.items():
        yield from _variables(one, f"{folder}{name}/")


def _held(name: str, variable: Any) -> Held:
    shape, dims = tuple(variable.shape), tuple(variable.dimensions)
    if variable.dtype is str:
        return Held(name, shape, None, kind="text")
    if not isinstance(variable.dtype, np.dtype) or isinstance(variable.datatype, netCDF4.VLType):
        return Held(name, shape, None, kind="a type of the user's own")
    unit = variable.getncattr("units") if "units" in variable.ncattrs() else ""
    dtype = _read_as(_dtype(variable), set(variable.ncattrs()))
    return Held(name, shape, dtype, unit if isinstance(unit, str) else "", dims)
