"""The measured series that an expansion records, as it was read."""

import xarray as xr

from octsim.base.errors import DatasetError


def series_in(found: xr.Dataset) -> xr.Dataset:
    """Return the measured series that an expansion records, as `read_series` reads it from netCDF.

    Raises
    ------
    DatasetError
        If it records none, as those of octsim 0.1.0.
    """
    names = {f"measured_{name}": name for name in ("phase", "phase_error")}
    if "band" in found.dims:
        return _series_of_bands_in(found)
    held = {name: plain for name, plain in names.items() if name in found}
    if "phase" not in held.values():
        raise DatasetError("its measured series is not recorded in it")
    return found[list(held)].rename(held).drop_attrs(deep=False)


def _series_of_bands_in(found: xr.Dataset) -> xr.Dataset:
    """Return them as `octsim.phase.measured_bands.read_series_of_bands` reads them."""
    series = {
        f"{name}_{band + 1}": found[f"measured_{name}"].isel(band=band, drop=True)
        for name in ("phase", "phase_error")
        if f"measured_{name}" in found
        for band in range(found.sizes["band"])
    }
    return xr.Dataset(series).drop_attrs(deep=False)
