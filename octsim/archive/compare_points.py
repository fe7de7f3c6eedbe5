"""Which points two datasets share: positions along each dimension, and values there in blocks."""

from collections.abc import Iterator, Mapping
from typing import Any, NamedTuple

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from octsim.datasets.reader import RAGGED

RAY = "ray"
_BLOCK_BYTES = 16e6
Positions = NDArray[np.int64]


class Common(NamedTuple):
    """Positions along a dimension that two datasets share: those of the one and of the other."""

    first: Positions
    second: Positions
    sizes: tuple[int, int]
    """Number of positions that each has."""

    @property
    def is_all(self) -> bool:
        """Whether neither has a position that the other lacks."""
        return self.first.size == self.second.size == max(self.sizes)


def common_points(first: xr.Dataset, second: xr.Dataset) -> tuple[dict[str, Common], int]:
    """Match the dimensions that two datasets both have.

    Along a dimension with a coordinate, or along combinations of a grid, points are shared whose
    values are the same to the bit; along any other, those that are as many places from its start.
    Rays are those of the shared points, where both have as many.

    Returns
    -------
    common : dict
        By dimension.
    uneven : int
        Number of shared points that have not as many rays, which are not among the shared rays.
    """
    common = {
        str(d): _matched(_labels(first, str(d)), _labels(second, str(d)), size, second.sizes[d])
        for d, size in first.sizes.items()
        if d in second.sizes
    }
    if RAY not in common or RAGGED not in first or RAGGED not in second:
        return common, 0
    if first[RAGGED].dims != second[RAGGED].dims:  # one is of a grid: no ray has its like
        none = np.empty(0, np.int64)
        return common | {RAY: Common(none, none, common[RAY].sizes)}, 0
    rays, uneven = _common_rays(first, second, common)
    return common | {RAY: rays}, uneven


Labels = tuple[tuple[str, ...], list[tuple[Any, ...]]]


def _labels(dataset: xr.Dataset, dimension: str) -> Labels | None:
    """Return the names and values that tell positions along a dimension apart, if there are any."""
    named = [dimension] if dimension in dataset.indexes else []
    named = named or sorted(
        str(name)
        for name, coordinate in dataset.coords.items()
        if coordinate.dims == (dimension,) and "config_key" in coordinate.attrs
    )
    columns = [dataset[name].values.tolist() for name in named]
    return (tuple(named), list(zip(*columns, strict=True))) if named else None


def _matched(one: Labels | None, other: Labels | None, size: int, other_size: int) -> Common:
    if one == other or one is None or other is None:
        places = np.arange(min(size, other_size))
        return Common(places, places, (size, other_size))
    there = {row: place for place, row in enumerate(other[1])} if one[0] == other[0] else {}
    pairs = [(place, there[row]) for place, row in enumerate(one[1]) if row in there]
    first, second = np.array(pairs, np.int64).reshape(-1, 2).T
    return Common(first, second, (size, other_size))


def _common_rays(
    first: xr.Dataset, second: xr.Dataset, common: Mapping[str, Common]
) -> tuple[Common, int]:
    counts, starts = [], []
    for dataset, positions in ((first, 0), (second, 1)):
        every = dataset[RAGGED].values.clip(min=0)
        begin = (np.cumsum(every.ravel()) - every.ravel()).reshape(every.shape)
        chosen = np.ix_(*(common[str(d)][positions] for d in dataset[RAGGED].dims))
        counts.append(every[chosen].ravel())
        starts.append(begin[chosen].ravel())
    even = counts[0] == counts[1]
    count = counts[0][even]
    within = np.arange(count.sum()) - np.repeat(np.cumsum(count) - count, count)
    one, other = (np.repeat(start[even], count) + within for start in starts)
    return Common(one, other, common[RAY].sizes), int((~even).sum())


def blocks(
    first: xr.Variable, second: xr.Variable, common: Mapping[str, Common]
) -> Iterator[tuple[NDArray[Any], NDArray[Any]]]:
    """Read two variables of the same dimensions where they share points, block after block.

    No more of a variable is in memory than a few blocks along its first dimension.
    """
    if not first.dims:
        yield first.values, second.values
        return
    along, *others = (common[str(d)] for d in first.dims)
    if not all(other.first.size for other in others):
        return
    row = 8 * max(int(np.prod(variable.shape[1:])) for variable in (first, second))
    together = max(1, int(_BLOCK_BYTES / max(row, 8)))
    for start in range(0, along.first.size, together):
        span = slice(start, start + together)
        yield (
            _taken(first, along.first[span], [other.first for other in others]),
            _taken(second, along.second[span], [other.second for other in others]),
        )


def _taken(variable: xr.Variable, rows: Positions, others: list[Positions]) -> NDArray[Any]:
    """Read what lies between some rows at once, which is quick, and take what is asked for."""
    least = int(rows.min())
    values = variable[least : int(rows.max()) + 1].values
    for axis, positions in enumerate((rows - least, *others)):
        if not np.array_equal(positions, np.arange(values.shape[axis])):
            values = values.take(positions, axis)
    return values
