"""The focus scan against a slow literal reading of the thesis."""

import numpy as np
import pytest
import reference
import xarray as xr
from literal import literal

import octsim

CONFIG = octsim.load_config(
    {
        "tracing": {"rays": 200},
        "spectrum": {"samples": 50},
        "focus_scan": {
            "diameter": "1.7 um",
            "focus": {"start": "-0.2 um", "stop": "3 um", "num": 5},
        },
    }
)


@pytest.fixture(scope="module")
def scan() -> xr.Dataset:
    return octsim.focus_scan(CONFIG)


def test_intensity_is_the_mean_of_the_literal_spectrum_and_rays_are_its_detections(
    scan: xr.Dataset,
) -> None:
    assert np.allclose(scan["focus"], [-0.2, 0.6, 1.4, 2.2, 3.0], atol=1e-12)
    for focus, at in scan.groupby("focus"):
        found = literal(CONFIG, 1.7, float(focus)).detections
        # the mean over k of |Σ E exp(ikΛ)|²
        expected = reference.spectrum(found, reference.wavenumbers(samples=50)).mean()
        assert at["intensity"].item() == pytest.approx(expected, rel=1e-9)
        assert at["rays_detected"].item() == len(found) > 0


def test_rays_are_those_of_the_spiral_whatever_the_scheme_of_the_intensity(
    scan: xr.Dataset,
) -> None:
    accurate = {"tracing": {"scheme": "paths", "accuracy": 1e-2}}
    by_paths = octsim.focus_scan(octsim.load_config(CONFIG.to_dict(), accurate))
    assert np.array_equal(by_paths["rays_detected"], scan["rays_detected"])
    assert not np.array_equal(by_paths["intensity"], scan["intensity"])
