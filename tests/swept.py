"""Intensities over the focus, as a sweep for the focus law."""

import numpy as np
import xarray as xr
from numpy.typing import NDArray

FOCI = np.linspace(0.4, 0.9, 41)


def xr_sweep(intensity: NDArray[np.float64]) -> xr.Dataset:
    """Return the intensities (D, 41) at `FOCI` as a dataset; diameters are 1 µm and so on."""
    return xr.Dataset(
        {
            "intensity": (("diameter", "fraction"), intensity),
            "focus": (("diameter", "fraction"), np.tile(FOCI, (len(intensity), 1))),
        },
        {"diameter": np.arange(1.0, 1.0 + len(intensity))},
    )
