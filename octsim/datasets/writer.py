"""Stages written part by part to a netCDF file, with memory for one part alone."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import netCDF4
import numpy as np
import xarray as xr
from numpy.typing import NDArray

from octsim.base.file_digest import add_digest
from octsim.base.files import whole
from octsim.datasets.files import CHUNK_CACHE, attributes
from octsim.datasets.layout import Layout, filling
from octsim.datasets.streams import Stream, pour

_RAGGED_CHUNK = 8192  # values


class _File:
    """An open netCDF file that a stage's parts are put in."""

    def __init__(self, file: netCDF4.Dataset, layout: Layout) -> None:
        self._file, self._layout = file, layout
        self._lengths: dict[str, int] = {}  # of ragged variables, so far
        self._coordinates = layout.coordinates
        for dimension, size in layout.sizes.items():
            file.createDimension(dimension, size)
        for name, variable in self._coordinates.items():
            self.create(name, tuple(map(str, variable.dims)), variable.dtype, variable.attrs)
            if variable.dims:
                file[name][:] = variable.values
            else:
                file[name].assignValue(variable.values)
        described = attributes(layout.stage, layout.config, layout.title)
        file.setncatts({**described, **layout.further})

    def create(
        self,
        name: str,
        dimensions: tuple[str, ...],
        dtype: np.dtype[Any],
        attributes: Mapping[str, Any],
    ) -> None:
        ragged = self._layout.is_ragged(dimensions)
        for dimension in dimensions:
            if dimension not in self._file.dimensions:
                self._file.createDimension(dimension, None)
        text = dtype.kind in "UO"
        empty = any(self._layout.sizes.get(d) == 0 for d in dimensions)
        variable = self._file.createVariable(
            name, str if text else dtype, dimensions,
            # whole numbers shrink to a twentieth; what light adds up to hardly shrinks
            compression="zlib" if ragged and dtype.kind == "i" else None, complevel=1,
            chunksizes=(_RAGGED_CHUNK,) if ragged else None,
            contiguous=not (ragged or text or empty) and bool(dimensions),
            fill_value=False if dtype.kind in "fi" else None,
        )  # fmt: skip
        variable.set_auto_maskandscale(False)
        if ragged:
            variable.set_var_chunk_cache(size=CHUNK_CACHE)  # or it would hold 64 MB of what is done
        beside = [n for n, c in self._coordinates.items() if _is_beside(n, c, dimensions)]
        if beside and name not in self._coordinates:
            attributes = dict(attributes) | {"coordinates": " ".join(beside)}
        variable.setncatts(attributes)
        partly = self._layout.lacks_some and name not in self._coordinates
        if not ragged and (partly or any(d in self._layout.padded for d in dimensions)):
            # not by the file's own fill value, which would make readers turn whole numbers to NaN
            variable[:] = filling(dtype)

    def put(self, name: str, place: tuple[Any, ...], values: NDArray[Any]) -> None:
        if place:
            self._file[name][place] = values
        else:
            self._file[name].assignValue(values)

    def append(self, name: str, values: NDArray[Any]) -> None:
        there = self._lengths.get(name, 0)
        self._lengths[name] = there + values.size
        self._file[name][there : there + values.size] = values


def _is_beside(name: str, coordinate: xr.Variable, dimensions: tuple[str, ...]) -> bool:
    """Return whether a coordinate is an auxiliary one of a variable with some dimensions."""
    return coordinate.dims != (name,) and set(map(str, coordinate.dims)) <= set(dimensions)


def write_stream(stream: Stream, path: str | Path) -> None:
    """Write a stage so that the file is there whole or not at all.

    Raises
    ------
    FileError
        If it can't be written; what stood at `path` before is still there.
    """
    with whole(Path(path)) as temporary:
        with netCDF4.Dataset(temporary, "w") as file:
            pour(stream, _File(file, stream.layout))
        add_digest(temporary)
