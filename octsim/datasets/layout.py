"""What a stage's dataset looks like before its values are known: its axes and coordinates."""

from collections.abc import Callable, Iterable, Iterator, Mapping
from functools import cached_property
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from octsim.config.grid import Axis, Combination, combinations
from octsim.config.models import Config
from octsim.datasets.axes import axis_coordinates, axis_name, wavelengths
from octsim.datasets.catalog import CATALOG
from octsim.datasets.keys import keys_behind, light_of, stage_axes
from octsim.datasets.variables import meaning

Coordinate = tuple[str, NDArray[Any]]
"""A dimension and the values along it."""
OF_ITS_OWN = "_index"
"""Ends the name of a dimension whose coordinate differs between combinations."""


class Layout:
    """The shape of one stage's dataset over the grid.

    Parameters
    ----------
    stage : str
        Name of the stage.
    config : Config
        The run.
    title : str
        One line on what is held.
    own : callable
        Returns the coordinates of a combination's config, by name.
    swept : str, optional
        Dimension along which a part may hold some of a combination's points only.
    bare : callable, optional
        Returns the lengths of a config's dimensions that have no coordinate.
    further : mapping, optional
        What else the dataset says of itself, as attributes.
    """

    def __init__(
        self,
        stage: str,
        config: Config,
        title: str,
        own: Callable[[Config], Mapping[str, Coordinate]],
        swept: str | None = None,
        bare: Callable[[Config], Mapping[str, int]] = lambda _: {},
        further: Mapping[str, str] | None = None,
    ) -> None:
        self.stage, self.config, self.title = stage, config, title
        self.further = further or {}
        self.swept = swept
        self.axes: tuple[Axis, ...] = stage_axes(stage, config)
        self.combinations = tuple(combinations(config, *keys_behind(stage, config)))
        seen: dict[tuple[str, bytes], NDArray[Any]] = {}
        self.own: dict[tuple[int, ...], dict[str, Coordinate]] = {
            at.position: {
                # most combinations share theirs
                name: (dimension, seen.setdefault((name, _digest(values)), values))
                for name, (dimension, values) in own(at.config).items()
            }
            for at in self.combinations
        }
        self._bare = [bare(at.config) for at in self.combinations]

    @property
    def grid_shape(self) -> tuple[int, ...]:
        """Number of positions along each axis."""
        return tuple(len(axis.rows) for axis in self.axes)

    @property
    def grid_dimensions(self) -> tuple[str, ...]:
        """Name of each axis."""
        return tuple(map(axis_name, self.axes))

    def count(self, at: Combination) -> int:
        """Return how many points a combination has along the swept dimension."""
        assert self.swept is not None
        return int(self.own[at.position][self.swept][1].size)

    @property
    def points(self) -> int:
        """Number of points of all combinations."""
        return sum(map(self.count, self.combinations)) if self.swept else len(self.combinations)

    def blocks(self, most: Callable[[Config], int]) -> Iterator[tuple[Combination, slice]]:
        """Return every combination's points in order, not more at once than its config allows."""
        for at in self.combinations:
            count, together = self.count(at), most(at.config)
            for first in range(0, count, together):
                yield at, slice(first, min(first + together, count))

    def dimension(self, name: str) -> str:
        """Return the name that a stage's dimension has in the whole dataset."""
        return name + OF_ITS_OWN if name in self._differing else name

    @cached_property
    def padded(self) -> frozenset[str]:
        """The whole dataset's dimensions whose length is not that of every combination."""
        return frozenset(self.dimension(d) for d, sizes in self._lengths.items() if len(sizes) > 1)

    @cached_property
    def sizes(self) -> Mapping[str, int]:
        """Length of each of the whole dataset's dimensions, but for ragged ones."""
        own = {self.dimension(name): max(sizes) for name, sizes in self._lengths.items()}
        return dict(zip(self.grid_dimensions, self.grid_shape, strict=True)) | own

    @cached_property
    def lacks_some(self) -> bool:
        """Whether some combinations have no values, as their light is of another kind."""
        row = CATALOG.get(self.stage)
        return row is not None and bool(row.light) and len(light_of(self.config)) > 1

    def is_ragged(self, dimensions: Iterable[str]) -> bool:
        """Return whether a variable along these has its parts one after the other, in no shape."""
        return any(dimension not in self.sizes for dimension in dimensions)

    @property
    def coordinates(self) -> dict[str, xr.Variable]:
        """Coordinates of the whole dataset: the axes' values and the stage's own."""
        found = {name: self._merged(name) for name in next(iter(self.own.values()))}
        if "wavenumber" in found and "wavelength" not in found:
            found["wavelength"] = xr.Variable(
                found["wavenumber"].dims, wavelengths(found["wavenumber"].values)
            )
        for name, variable in found.items():
            variable.attrs = meaning(name)
        return {**axis_coordinates(self.axes, self.combinations), **found}

    @cached_property
    def _lengths(self) -> dict[str, set[int]]:
        lengths: dict[str, set[int]] = {}
        for own in self.own.values():
            for dimension, values in own.values():
                if values.ndim:
                    lengths.setdefault(dimension, set()).add(values.size)
        for sizes in self._bare:
            for dimension, size in sizes.items():
                lengths.setdefault(dimension, set()).add(size)
        return lengths

    @cached_property
    def _differing(self) -> frozenset[str]:
        """Dimensions whose own coordinate is not the same everywhere."""
        distinct: dict[str, set[int]] = {}
        for own in self.own.values():
            for name, (dimension, values) in own.items():
                if name == dimension:
                    distinct.setdefault(name, set()).add(id(values))
        return frozenset(name for name, arrays in distinct.items() if len(arrays) > 1)

    def _merged(self, name: str) -> xr.Variable:
        every = [own[name] for own in self.own.values()]
        dimension, first = every[0]
        named = (self.dimension(dimension),) if first.ndim else ()
        if all(values is first for _, values in every):
            return xr.Variable(named, first)
        longest = max(values.size for _, values in every)
        stacked = np.full((len(every), longest), filling(first.dtype), first.dtype)
        for row, (_, values) in zip(stacked, every, strict=True):
            row[: values.size] = values
        grid = stacked.reshape(*self.grid_shape, longest)
        kept = list(self.grid_dimensions)
        for place in reversed(range(len(kept))):
            alone = grid.take([0], place)
            if np.array_equal(grid, np.broadcast_to(alone, grid.shape), equal_nan=True):
                grid = alone.squeeze(place)
                del kept[place]
        return xr.Variable((*kept, *named), grid if named else grid[..., 0])


def _digest(values: NDArray[Any]) -> bytes:
    return repr((values.shape, values.dtype.str)).encode() + values.tobytes()


def filling(dtype: np.dtype[Any]) -> Any:
    """Return what stands where a combination has nothing: NaN, −1 or an empty text."""
    return {"f": np.nan, "i": -1, "u": 0, "b": False}.get(dtype.kind, "")
