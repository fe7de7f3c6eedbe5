"""The phase slope: derivatives of the components' own phases, and the figures of a sweep."""

import numpy as np
import pytest
import reference
import xarray as xr

import octsim
from octsim.figures.phase_slope import figure_12
from octsim.figures.style import look, told_in
from octsim.phase.fringe_status import FringeStatus
from octsim.stages.fourier import PhaseStatus, doubts
from octsim.stages.phase_slope import SlopeStatus, slope_status, summary


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


GIVEN = {
    "tracing": {"rays": 300},
    "spectrum": {"samples": 64},
    "sweep": {"diameters": {"num": 5}, "focus": {"slope": 0.58, "intercept": "69 nm"}},
}
WITHOUT: dict[str, tuple[dict[str, object], FringeStatus]] = {
    "neuron of water": (
        {"scene": {"refractive_index": {"neuron": 1.33}}}, FringeStatus.NO_FRINGE,
    ),
    "one index": (
        {"scene": {"refractive_index": {"glass": 1.39, "water": 1.39, "neuron": 1.39}}},
        FringeStatus.NO_LIGHT,
    ),
    "two surfaces met": ({"tracing": {"max_intersections": 2}}, FringeStatus.NO_FRINGE),
    "narrow band": (
        {"spectrum": {"wavelength": {"min": "650 nm", "max": "651 nm"}}},
        FringeStatus.TOO_FEW_OSCILLATIONS,
    ),
    "wide band": (
        {"spectrum": {"wavelength": {"min": "20 nm", "max": "10 um"}}}, FringeStatus.NOT_RESOLVED,
    ),
    "few samples": ({"spectrum": {"samples": 4}}, FringeStatus.NOT_RESOLVED),
}  # fmt: skip


@pytest.mark.parametrize("estimator", ["fft", "sinusoid", "esprit"])
@pytest.mark.parametrize("name", WITHOUT)
def test_without_a_fringe_there_is_no_slope_and_the_status_says_why(
    name: str, estimator: str
) -> None:
    overlay, status = WITHOUT[name]
    config = octsim.load_config(GIVEN, overlay, {"processing": {"estimator": estimator}})
    transformed = octsim.fourier(config, octsim.spectra(config, octsim.detections(config)))
    slopes = octsim.phase_slope(config, transformed)
    for dataset in (transformed, slopes):
        assert (dataset["fringe_status"] == status).all()
    assert np.isnan(transformed["fringe_visibility"]).all()
    for found in ("phase_slope", "component_phase_slope", "mean_phase_slope", "largest_deviation"):
        assert np.isnan(slopes[found]).all(), found
    if status != FringeStatus.NOT_RESOLVED:
        assert np.isfinite(slopes["ideal_phase_slope"]).all()
    assert doubts(transformed) == [
        f"{status.name.lower()} at 5 of 5 diameters (fringe_status), whose phase is not known "
        f"(NaN): {status.remedy}"
    ]
    assert summary(slopes).startswith("no phase slope")
    with look():
        drawn = figure_12(slopes)
    assert status.name.lower() in " ".join(told_in(drawn))


@pytest.mark.parametrize("scheme", ["vogel", "paths"])
def test_a_weak_fringe_has_its_slope(scheme: str) -> None:
    weak = {"scene": {"refractive_index": {"neuron": 1.3301}}, "tracing": {"scheme": scheme}}
    config = octsim.load_config(GIVEN, {"sweep": {"diameters": {"num": 31}}}, weak)
    transformed = octsim.fourier(config, octsim.spectra(config, octsim.detections(config)))
    assert (transformed["fringe_status"] == FringeStatus.VISIBLE).all()
    assert (transformed["fringe_visibility"] < 0.05).all()
    slopes = octsim.phase_slope(config, transformed)
    off = slopes["mean_phase_slope"] - slopes["predicted_phase_slope"]
    assert abs(float(off)) < 0.15
    assert doubts(transformed) == []


def test_the_slope_is_given_where_there_is_one() -> None:
    # the smallest diameters have too few oscillations
    wide = {"sweep": {"diameters": {"start": "0.4 um", "stop": "1.4 um", "num": 21}}}
    config = octsim.load_config(GIVEN, wide)
    transformed = octsim.fourier(config, octsim.spectra(config, octsim.detections(config)))
    slopes = octsim.phase_slope(config, transformed)
    few = transformed["fringe_status"].values == FringeStatus.TOO_FEW_OSCILLATIONS
    assert 0 < few.sum() < few.size
    known = np.isfinite(slopes["phase_slope"].values)
    assert known.sum() == (~few).sum() - 1  # a difference needs both neighbours
    assert float(slopes["mean_phase_slope"]) == slopes["phase_slope"].values[known].mean()
    assert f"{known.sum()} of 21" in summary(slopes)


def test_the_fringe_of_a_gap_is_not_taken_for_the_neuron_s() -> None:
    # the plane's light beats with the near side's, whose depth no diameter changes
    config = octsim.load_config(GIVEN, {"scene": {"gap": "2 um"}, "tracing": {"rays": 3000}})
    transformed = octsim.fourier(config, octsim.spectra(config, octsim.detections(config)))
    assert (transformed["fringe_status"] >= FringeStatus.OTHER_DEPTHS).all()
    assert doubts(transformed)


def test_a_slope_s_status_says_what_it_lacks() -> None:
    visible = np.array([True, True, False, True, True, True])
    slope = np.array([24.0, np.nan, np.nan, np.nan, 24.0, np.nan])
    rounding = SlopeStatus.BELOW_ROUNDING
    assert slope_status(slope, visible, rounding).tolist() == [
        SlopeStatus.KNOWN, SlopeStatus.NO_FRINGE_BESIDE, SlopeStatus.NO_FRINGE,
        SlopeStatus.NO_FRINGE_BESIDE, SlopeStatus.KNOWN, rounding,
    ]  # fmt: skip
    of_each = slope_status(np.stack([slope, slope], axis=1), visible, rounding)
    assert of_each[:, 1].tolist() == slope_status(slope, visible, rounding).tolist()
