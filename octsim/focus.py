"""Where the light is: the intensity over the focus, for one diameter and for several (figure 6)."""

import numpy as np
import xarray as xr

from octsim.config import Config
from octsim.datasets import flags, make
from octsim.light import AccuracyStatus
from octsim.simulation import mean_intensities, vogel_tracer
from octsim.threads import each


def focus_scan(config: Config, threads: int = 1) -> xr.Dataset:
    """Scan the focus for one diameter (figure 6).

    Rays are counted on the thesis's spiral, whatever the scheme of the intensity.

    Returns
    -------
    Dataset
        intensity(focus), the mean over the band, its estimated error and whether that is as asked,
        and rays_detected(focus).
    """
    foci, diameter = config.focus_scan.focus.values(), config.focus_scan.diameter
    diameters = np.full_like(foci, diameter)
    intensity, error, status = mean_intensities(config, diameters, foci, threads)
    trace_at = vogel_tracer(config)
    rays_detected = each(lambda z: trace_at(diameter, z).ray.size, foci.tolist(), threads)
    return make(
        "focus_scan",
        config,
        "Intensity and number of detected rays over the focus, for one diameter",
        {
            "intensity": ("focus", intensity),
            "intensity_error": ("focus", error),
            "accuracy_status": ("focus", *flags(AccuracyStatus, status)),
            "rays_detected": ("focus", np.array(rays_detected)),
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
        intensity, its estimated error and whether that is as asked, focus (diameter, fraction).
    """
    diameters, fractions = config.focus_law.diameters.values(), config.focus_law.fraction.values()
    foci = np.outer(diameters, fractions)
    intensity, error, status = mean_intensities(
        config, np.repeat(diameters, fractions.size), foci.ravel(), threads
    )
    dimensions = ("diameter", "fraction")
    return make(
        "focus_sweep",
        config,
        "Intensity over the focus, for the diameters of the focus law",
        {
            "intensity": (dimensions, intensity.reshape(foci.shape)),
            "intensity_error": (dimensions, error.reshape(foci.shape)),
            "accuracy_status": (dimensions, *flags(AccuracyStatus, status.reshape(foci.shape))),
            "focus": (dimensions, foci),
        },
        {"diameter": diameters, "fraction": fractions},
        __name__,
    )
