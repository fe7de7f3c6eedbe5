"""Grids of small runs, and what runs over them hold."""

from functools import cache
from typing import Any

import xarray as xr
from made_runs import every_stage

from octsim.config.load import load_config
from octsim.config.models import Config

SMALL: dict[str, Any] = {
    "tracing": {"rays": 150},
    "spectrum": {"samples": 40},
    "focus_scan": {"focus": {"num": 5}},
    "focus_law": {"diameters": {"num": 3}, "fraction": {"num": 9}},
    "sweep": {"diameters": {"start": "1.2 um", "stop": "1.3 um", "num": 5}},
}
GIVEN = {"sweep": {"focus": {"slope": 0.58, "intercept": "69 nm"}}}
GRIDS: dict[str, dict[str, Any]] = {
    "product": {"scene.gap": ["0 nm", "30 nm"], "processing.window": ["hann", "hamming"]},
    "zip": {
        "combine": "zip", "scene.gap": ["0 nm", "30 nm", "30 nm"],
        "processing.centre": ["mean", "mean", "midpoint"],
    },
    "band": {"spectrum.wavelength.min": ["650 nm", "700 nm"], "tracing.rays": [150, 160]},
    "sizes": {"sweep.diameters.num": [5, 9, 3], "spectrum.samples": [40, 33]},
    "schemes": {"tracing.scheme": ["vogel", "paths"], "focus_scan.focus.num": [5, 4]},
    "waves": {"tracing.scheme": ["vogel", "fullwave"], "scene.gap": ["0 nm", "30 nm"]},
    "estimators": {"processing.estimator": ["fft", "sinusoid", "esprit", "maximum_likelihood"]},
    "preset": {
        "combine": "zip", "tracing.preset": ["draft", "draft", "standard"],
        "scene.gap": ["0 nm", "30 nm", "30 nm"],
    },
    "focus": {"sweep.focus": ["law", {"slope": 0.58, "intercept": "69 nm"}]},
}  # fmt: skip


def gridded(grid: dict[str, Any], *overlays: dict[str, Any]) -> Config:
    return load_config(SMALL, *overlays, {"grid": grid})


@cache
def run_of_grid(name: str) -> tuple[Config, dict[str, xr.Dataset]]:
    """Return one of the grids, and every dataset of its run."""
    config = gridded(GRIDS[name], {"tracing": {"accuracy": 1e-2}})
    return config, every_stage(config)
