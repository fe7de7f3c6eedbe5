"""What all tests share."""

import pytest
import xarray as xr
from hypothesis import settings

from octsim.calibrate import calibration
from octsim.loading import load_config

# The same draws every time: a failure on a contributor's machine is a failure on every machine.
settings.register_profile("octsim", derandomize=True, deadline=None)
settings.load_profile("octsim")


@pytest.fixture(scope="session")
def calibrated() -> xr.Dataset:
    """Calibrate the thesis's instrument at a few diameters, focused by a given law."""
    config = load_config(
        {"sweep": {"focus": {"slope": 0.58, "intercept": "66 nm"}}},
        {"calibration": {"diameters": {"num": 11}}},
    )
    return calibration(config, None, 2)
