"""The phase slope: derivatives of the components' own phases, and the figures of a sweep."""

import numpy as np
import pytest
import reference
import xarray as xr

from octsim.stages.fourier import PhaseStatus
from octsim.stages.phase_slope import summary


def test_slopes_are_central_differences_of_the_unwrapped_phases(
    stages: dict[str, xr.Dataset],
) -> None:
    transformed, slopes = stages["fourier"], stages["phase_slope"]
    known = (transformed["phase_status"] == PhaseStatus.KNOWN).all("diameter").values
    assert known[1:20].all()
    phase = np.unwrap(transformed["phase"].values[:, known], axis=0)
    expected = np.gradient(phase, transformed["diameter"].values, axis=0)
    found = slopes["component_phase_slope"].values
    assert np.allclose(found[:, known], expected, rtol=1e-9, atol=1e-9)
    strongest = transformed["magnitude"].values.argmax(axis=1)
    assert np.array_equal(slopes["strongest_component"], strongest)
    assert np.array_equal(slopes["phase_slope"], found[np.arange(strongest.size), strongest])


def test_the_ideal_is_that_of_two_plates(stages: dict[str, xr.Dataset]) -> None:
    slopes, k = stages["phase_slope"], reference.wavenumbers()
    diameters = slopes["diameter"].values.tolist()
    expected = reference.phase_slopes(reference.ideal_spectra(1.39, diameters, k), diameters)
    assert np.allclose(slopes["ideal_phase_slope"], expected.slope, atol=1e-9)
    assert np.array_equal(slopes["ideal_component"], expected.component)
    predicted = reference.predicted_phase_slope(1.39, k)
    assert slopes["predicted_phase_slope"].item() == pytest.approx(predicted, rel=1e-12)


def test_the_figures_of_a_sweep_are_those_of_its_slopes(stages: dict[str, xr.Dataset]) -> None:
    found = stages["phase_slope"]
    slope, ideal = found["phase_slope"].values, found["ideal_phase_slope"].values
    deviation = slope - found["predicted_phase_slope"].item()
    largest = np.argmax(np.abs(deviation))
    expected = {
        "mean_phase_slope": np.mean(slope),
        "phase_slope_standard_deviation": np.sqrt(np.mean((slope - np.mean(slope)) ** 2)),
        "mean_ideal_phase_slope": np.mean(ideal),
        "ideal_phase_slope_standard_deviation": np.sqrt(np.mean((ideal - np.mean(ideal)) ** 2)),
        "standard_deviation_from_ideal": np.std(slope - ideal),
        "largest_deviation": deviation[largest],
        "largest_deviation_diameter": found["diameter"].values[largest],
    }
    for name, value in expected.items():
        assert found[name].item() == pytest.approx(value, rel=1e-12), name
    assert f"phase slope {np.mean(slope):.3f}" in summary(found)
