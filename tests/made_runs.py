"""Small runs, made in memory or written to a folder."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
import xarray as xr

import octsim
from octsim.datasets.files import write
from octsim.datasets.keys import stages_of
from octsim.studies.calibration import parameters, scheme
from octsim.studies.calibration.parameter import Parameter
from octsim.studies.calibration.parameters import PARAMETERS

TINY = {
    "run": "tiny",
    "tracing": {"rays": 200},
    "focus_scan": {"focus": {"num": 5}},
    "spectrum": {"samples": 64},
    "sweep": {"diameters": {"num": 9}, "focus": {"slope": 0.58, "intercept": "69 nm"}},
}
WHOLE = {
    "run": "whole",
    "tracing": {"rays": 300},
    "focus_scan": {"focus": {"num": 21}},
    "focus_law": {"diameters": {"num": 3}, "fraction": {"num": 11}},
    "sweep": {"diameters": {"num": 9}},
}
"""The config of the fixture `stages`."""
SWEEP = octsim.load_config(
    {
        "tracing": {"scheme": "paths", "accuracy": 1e-6},
        "sweep": {
            "diameters": {"start": "1.2 um", "stop": "1.6 um", "num": 61},
            "focus": {"slope": 0.58, "intercept": "64 nm"},
        },
    }
)
"""The config of the fixture `spectra`."""


def few_parameters(*names: str) -> dict[str, Parameter]:
    """Return a calibration's table of parameters, of which these alone count: it takes less."""
    return {
        name: one if name in names else one._replace(counts=lambda _: False)
        for name, one in PARAMETERS.items()
    }


CALIBRATED = {
    "spectrum": {"samples": 250},  # of less than three fringes
    "sweep": {"focus": {"slope": 0.58, "intercept": "66 nm"}},
    "calibration": {"diameters": {"start": "1.32 um", "stop": "1.46 um", "num": 8}},
}
BY_RAYS = {
    **CALIBRATED,
    "calibration": {
        "diameters": {"start": "1.1 um", "stop": "1.8 um", "num": 8},
        "scheme": "paths",
    },
}


# those that tests look at, and those that light paths don't see: each takes 16 spectra a diameter
SEEN = few_parameters(
    "diameter", "gap", "neuron", "focus", "numerical_aperture", "fill", "polarisation", "offset"
)
# the slope at 1.4 um is the same to 1e-6 mrad/nm from 1e-4 on; 1e-6 takes three times as long
REACHED = {**scheme.ACCURACY, "fullwave": 1e-5}


@contextmanager
def as_calibrated() -> Iterator[None]:
    """Have studies use the parameters and the accuracy of the fixture `calibrated`."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(parameters, "PARAMETERS", SEEN)
        patch.setattr(scheme, "ACCURACY", REACHED)
        yield


def make(folder: Path, *overlays: dict[str, object], scan: bool = True) -> octsim.Config:
    config = octsim.load_config(TINY, *overlays)
    if scan:
        write(octsim.focus_scan(config), folder / "focus_scan.nc")
        return config
    spectra = octsim.spectra(config, octsim.detections(config))
    write(spectra, folder / "spectra.nc")
    write(octsim.phase_slope(config, octsim.fourier(config, spectra)), folder / "phase_slope.nc")
    return config


def every_stage(config: octsim.Config, threads: int = 1) -> dict[str, xr.Dataset]:
    """Return every dataset of a run, by name."""
    made = {"focus_scan": octsim.focus_scan(config, threads)}
    made["focus_sweep"] = octsim.focus_sweep(config, threads)
    made["gaussian_fits"] = octsim.gaussian_fits(config, made["focus_sweep"])
    there = stages_of(config)
    if "ray_focus_sweep" in there:
        made["ray_focus_sweep"] = octsim.ray_focus_sweep(config, threads)
    by_rays = made.get("ray_focus_sweep")
    made["focus_law"] = octsim.focus_law(config, made["gaussian_fits"], by_rays)
    for name, work in (("detections", octsim.detections), ("fields", octsim.fields)):
        if name in there:
            made[name] = work(config, made["focus_law"], threads)
    detected, fields = made.get("detections"), made.get("fields")
    made["spectra"] = octsim.spectra(config, detected, threads, fields)
    made["paths"] = octsim.light_paths(config, detected, fields)
    made["fourier"] = octsim.fourier(config, made["spectra"])
    made["phase_slope"] = octsim.phase_slope(config, made["fourier"])
    return made
