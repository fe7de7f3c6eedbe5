"""Dimensions of a grid in datasets: their names, and the values along them."""

from functools import cache
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from octsim.config.grid import FIXED, Axis, Combination, as_text, value_at
from octsim.config.known_keys import known_keys
from octsim.config.messages import unit_of
from octsim.datasets.variables import MEANINGS


def axis_name(axis: Axis) -> str:
    """Return the name of an axis' dimension: that of its key, or combination of zipped ones."""
    return dimension_name(axis.keys[0]) if not axis.zipped else "combination"


def wavelengths(wavenumber: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the wavelengths of wavenumbers, µm, in vacuum, of their shape."""
    lengths: NDArray[np.float64] = 2 * np.pi / wavenumber
    return lengths


@cache
def dimension_name(key: str) -> str:
    """Name the dimension of a dotted key by its last part, or by as many as tell it from others.

    Examples
    --------
    >>> dimension_name("detector.core_diameter"), dimension_name("spectrum.wavelength.min")
    ('core_diameter', 'wavelength_min')
    """
    parts = key.split(".")
    if any(map(str.isdigit, parts)):  # in a list, whose other entries have the same keys
        return "_".join(parts[1:])
    if parts[0] in FIXED:  # of which a run has one, and no dimension
        return "_".join(parts)
    known = [
        parts
        for parts in (k.split(".") for k in known_keys())
        if parts[0] not in FIXED and not any(map(str.isdigit, parts))
    ]
    # below a subsection the last part alone says little: neuron, min
    for count in range(min(len(parts) - 1, 2), len(parts)):
        tail = parts[-count:]
        alike = sum(other[-count:] == tail for other in known)
        if alike <= 1 and "_".join(tail) not in MEANINGS:
            return "_".join(tail)
    return "_".join(parts)


def axis_coordinates(
    axes: tuple[Axis, ...], along: tuple[Combination, ...]
) -> dict[str, xr.Variable]:
    """Return the values of each varied key along its axis: numbers where they are, else text."""
    found: dict[str, xr.Variable] = {}
    for place, axis in enumerate(axes):
        # one combination for each row of this axis
        rows = {at.position[place]: at.config for at in reversed(along)}
        for number, key in enumerate(axis.keys):
            values: list[Any] = [value_at(rows[row], key) for row in range(len(axis.rows))]
            unit = unit_of(key)
            if not all(isinstance(v, int | float) and not isinstance(v, bool) for v in values):
                values, unit = [as_text(row[number]) for row in axis.rows], "1"
            words = key.replace(".", " ").replace("_", " ")
            attributes = {"units": unit, "long_name": words, "config_key": key}
            found[dimension_name(key)] = xr.Variable(
                (axis_name(axis),), np.array(values), attributes
            )
    return found
