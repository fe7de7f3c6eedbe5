"""The slopes that two codes found from Maxwell's equations, for the thesis's sweep."""

from typing import Any

import pytest

import octsim
from octsim.config.load import load_config

GAUSSIAN: dict[str, Any] = {
    "tracing": {"preset": "exact"},
    "objective": {"pupil": {"gaussian": 1.0}},
    "sweep": {"focus": {"slope": 0.581, "intercept": "69 nm"}},
}


def slope(num: int, estimator: str) -> tuple[float, float]:
    """Return mean and scatter of the local slopes of a sweep, mrad/nm."""
    config = load_config(
        GAUSSIAN, {"sweep": {"diameters": {"num": num}}, "processing": {"estimator": estimator}}
    )
    spectra = octsim.spectra(config, fields=octsim.fields(config, threads=2))
    found = octsim.phase_slope(config, octsim.fourier(config, spectra))
    return found["mean_phase_slope"].item(), found["phase_slope_standard_deviation"].item()


def test_the_slope_by_least_squares_is_what_two_codes_found() -> None:
    mean, scatter = slope(51, "sinusoid")
    assert mean == pytest.approx(22.85, abs=5e-3)
    assert scatter == pytest.approx(0.38, abs=5e-3)


@pytest.mark.trial
def test_the_slope_by_transform_is_what_two_codes_found() -> None:
    mean, scatter = slope(151, "fft")
    assert mean == pytest.approx(22.677, abs=6e-4)
    assert scatter == pytest.approx(0.931, abs=6e-4)
