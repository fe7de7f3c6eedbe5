"""What a dataset that is drawn says of its run: the config, and the point that stands for it."""

import json

import xarray as xr

from octsim.config.derive import validated
from octsim.config.models import Config


def config_in(dataset: xr.Dataset) -> Config:
    """Return the config that a dataset of this version was made from."""
    return validated(json.loads(dataset.attrs["config"]))


def middle_of(spectra: xr.Dataset) -> tuple[float, float]:
    """Return the middle diameter of a sweep and its focus, µm: the scene is drawn at these."""
    one = spectra.isel(diameter=spectra.sizes["diameter"] // 2)
    return float(one["diameter"]), float(one["focus"])
