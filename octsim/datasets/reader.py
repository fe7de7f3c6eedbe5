"""Datasets over a grid, read part by part: each part looks like the dataset of a plain config."""

from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from octsim.base.errors import DatasetError
from octsim.config.grid import Combination, as_text
from octsim.config.models import Config
from octsim.datasets.axes import axis_name
from octsim.datasets.files import guarded
from octsim.datasets.keys import stage_axes
from octsim.datasets.layout import OF_ITS_OWN, Layout, filling

RAGGED = "rays_detected"
"""How many values each point has along the ragged dimension ``ray``."""


class Stored:
    """A stage's dataset, in memory or in an open file.

    Parameters
    ----------
    dataset : Dataset
        As a stage gives it.
    stage : str
        That stage.
    config : Config
        The run that it is of.
    like : Layout, optional
        Whose coordinates it has to have, where both have one.
    """

    def __init__(
        self, dataset: xr.Dataset, stage: str, config: Config, like: Layout | None = None
    ) -> None:
        self._axes = stage_axes(stage, config)
        self._stage, self._like = stage, like
        self._rows = [
            {as_text(list(row)): place for place, row in enumerate(axis.rows)}
            for axis in self._axes
        ]
        self.dataset = dataset
        with guarded(dataset.encoding.get("source", stage)):
            counts = dataset[RAGGED].values.clip(min=0) if "ray" in dataset.dims else None
        if counts is not None:
            self._ends = np.append(0, np.cumsum(counts.ravel()))
            self._shape = counts.shape

    def part(
        self,
        at: Combination,
        points: slice | None = None,
        swept: str = "diameter",
        names: tuple[str, ...] = (),
    ) -> xr.Dataset:
        """Read what there is of a combination, which may be one of a finer grid.

        Parameters
        ----------
        at : Combination
            The combination.
        points : slice, optional
            Some of the points along the swept dimension.
        swept : str
            That dimension.
        names : tuple of str
            Variables that are read; without any all are.

        Raises
        ------
        DatasetError
            If the file can't be read, or is of other points.
        """
        place = {
            axis_name(axis): rows[as_text([at.values[key] for key in axis.keys])]
            for axis, rows in zip(self._axes, self._rows, strict=True)
        }
        file = self.dataset.encoding.get("source", self._stage)
        with guarded(file):
            part = self._own(place, points, swept, names).load()
        own = self._like.own[at.position] if self._like else {}
        for name in set(own) & set(map(str, part.coords)):
            asked = own[name][1][points or slice(None)] if name == swept else own[name][1]
            if not np.array_equal(part[name].values, asked):
                raise DatasetError(
                    f"{file}: its {name} is not that of the config; give the whole dataset, and "
                    "the config that it was made from"
                )
        return part

    def _own(
        self, place: dict[str, int], points: slice | None, swept: str, names: tuple[str, ...]
    ) -> xr.Dataset:
        chosen = self.dataset[list(names)] if names else self.dataset
        one = chosen.isel(place, missing_dims="ignore").drop_vars(
            [name for name, c in chosen.coords.items() if "config_key" in c.attrs]
        )
        own = [str(d) for d in one.dims if str(d).endswith(OF_ITS_OWN)]
        plain = {dimension: dimension.removesuffix(OF_ITS_OWN) for dimension in own}
        lengths = {d: slice(int(_there(one[name].values).sum())) for d, name in plain.items()}
        one = _renamed(one.isel(lengths), plain) if plain else one
        if "ray" in one.dims:
            count = one.sizes[swept]
            row = int(np.ravel_multi_index(tuple(place.values()), self._shape[:-1])) if place else 0
            asked = range(count)[points or slice(None)]
            first = row * self._shape[-1]
            ends = self._ends[first + asked.start], self._ends[first + asked.stop]
            one = one.isel(ray=slice(*map(int, ends)))
        return one if points is None else one.isel({swept: points})


def _there(values: NDArray[Any]) -> NDArray[np.bool_]:
    """Return which of a coordinate's values are this combination's own."""
    nothing = filling(values.dtype)
    found: NDArray[np.bool_] = ~np.isnan(values) if nothing != nothing else values != nothing
    return found


def _renamed(dataset: xr.Dataset, names: Mapping[str, str]) -> xr.Dataset:
    """Rename dimensions; their coordinates may have the new names already."""
    variables = {}
    for name, variable in dataset.variables.items():
        renamed = variable.to_base_variable().copy(deep=False)
        renamed.dims = tuple(names.get(str(d), d) for d in variable.dims)
        variables[name] = renamed
    return xr.Dataset(variables, attrs=dataset.attrs).set_coords(list(dataset.coords))
