"""Where the light is: the intensity over the focus, for one diameter and for several (figure 6)."""

import numpy as np
import xarray as xr

from octsim.config import Config
from octsim.datasets import make
from octsim.simulation import mean_intensities


def focus_scan(config: Config, threads: int = 1) -> xr.Dataset:
    """Scan the focus for one diameter (figure 6).

    Returns
    -------
    Dataset
        intensity(focus), the mean over the band, and rays_detected(focus).
    """
    foci = config.focus_scan.focus.values()
    diameters = np.full_like(foci, config.focus_scan.diameter)
    intensity, rays_detected = mean_intensities(config, diameters, foci, threads)
    return make(
        "focus_scan",
        config,
        "Intensity and number of detected rays over the focus, for one diameter",
        {
            "intensity": ("focus", intensity),
            "rays_detected": ("focus", rays_detected),
            "diameter": config.focus_scan.diameter,
        },
        {"focus": foci},
        __name__,
    )


def focus_sweep(config: Config, threads: int = 1) -> xr.Dataset:
    """Measure the intensity at fractions of the diameter, for the diameters of the focus law.

    Returns
    -------
    Dataset
        intensity, focus and rays_detected (diameter, fraction).
    """
    diameters, fractions = config.focus_law.diameters.values(), config.focus_law.fraction.values()
    foci = np.outer(diameters, fractions)
    intensity, rays_detected = mean_intensities(
        config, np.repeat(diameters, fractions.size), foci.ravel(), threads
    )
    dimensions = ("diameter", "fraction")
    return make(
        "focus_sweep",
        config,
        "Intensity over the focus, for the diameters of the focus law",
        {
            "intensity": (dimensions, intensity.reshape(foci.shape)),
            "rays_detected": (dimensions, rays_detected.reshape(foci.shape)),
            "focus": (dimensions, foci),
        },
        {"diameter": diameters, "fraction": fractions},
        __name__,
    )
