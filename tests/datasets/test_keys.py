"""Which keys of a config a dataset depends on."""

import pytest
from gridded import GIVEN, gridded

from octsim.datasets.catalog import STAGES
from octsim.datasets.keys import stage_axes


@pytest.mark.parametrize(
    ("key", "stages"),
    [
        ("processing.window", {"fourier", "phase_slope"}),
        ("spectrum.wavelength.min", {
            "focus_scan", "focus_sweep", "gaussian_fits", "focus_law", "spectra", "paths",
            "fourier", "phase_slope"}),
        ("focus_scan.diameter", {"focus_scan"}),
        ("focus_law.fraction.num", {"focus_sweep", "gaussian_fits", "focus_law"}),
        ("scene.gap", set(STAGES)),
        ("tracing.accuracy", set()),
    ],
)  # fmt: skip
def test_a_stage_has_the_axes_of_the_keys_it_depends_on(key: str, stages: set[str]) -> None:
    values = {
        "processing.window": ["hann", "boxcar"], "spectrum.wavelength.min": ["650 nm", "700 nm"],
        "focus_scan.diameter": ["1 um", "2 um"], "focus_law.fraction.num": [9, 11],
        "scene.gap": ["1 nm", "5 nm"], "tracing.accuracy": [1e-3, 1e-4],
    }  # fmt: skip
    config = gridded({key: values[key]}, GIVEN)
    assert {stage for stage in STAGES if stage_axes(stage, config)} == stages
