"""What of an instrument may differ: a spectrometer's band moves with all of its samples."""

import numpy as np
import pytest

from octsim.config.load import load_config
from octsim.studies.calibration.tolerances import moved


@pytest.mark.parametrize("name", ["wavelength_min", "wavelength_max"])
@pytest.mark.parametrize("by", [-3e-4, 1e-4, 2.9e-4])
def test_as_many_pixels_are_in_a_band_that_is_off(name: str, by: float) -> None:
    # 650 nm is the middle of a pixel, 900 nm is not
    config = load_config({"spectrum": {"pixels": {"polynomial": [630, 0.32, -1e-6]}}})
    at_end = load_config({"spectrum": {"pixels": {"polynomial": [630, 0.25]}}})
    for one in (config, at_end):
        found = moved(one, {name: by}, 0.0).config.spectrum
        assert found.samples == one.spectrum.samples
        ends = 2 * np.pi / found.wavenumbers()[[-1, 0]]
        own = 2 * np.pi / one.spectrum.wavenumbers()[[-1, 0]]
        share = (own - 0.65) / 0.25 if name == "wavelength_max" else (0.9 - own) / 0.25
        np.testing.assert_allclose(ends, own + share * by, rtol=1e-9)
