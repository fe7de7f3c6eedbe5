"""Every run by rays says how far its slope is from that by Maxwell's equations."""

import numpy as np
import pytest
import xarray as xr

import octsim
from octsim.config.derive import changed
from octsim.config.load import load_config
from octsim.config.maxwell import beyond_maxwell, by_maxwell
from octsim.config.models import Config, FocusLine
from octsim.figures.phase_slope import figure_12
from octsim.figures.style import look
from octsim.stages.beside_maxwell import exact_seconds, pupil_name, seconds_told, summary
from octsim.stages.by_maxwell import (
    ACCURACY,
    DIAMETERS,
    ExactStatus,
    compared,
    exact_slopes,
)
from octsim.stages.phase_slope import phase_slope
from octsim.stages.phase_slope import summary as own_summary

SMALL = {
    "tracing": {"rays": 300},
    "spectrum": {"samples": 200},
    "sweep": {
        "diameters": {"start": "1 um", "stop": "1.1 um", "num": 16},
        "focus": {"slope": 0.581, "intercept": "69 nm"},
    },
}

LAW = FocusLine.model_construct(slope=0.581, intercept=0.069)


def config(**overlay: object) -> Config:
    return changed(load_config(SMALL), overlay)


def slopes_of(run: Config) -> tuple[xr.Dataset, xr.Dataset]:
    seen = octsim.spectra(run, octsim.detections(run))
    transformed = octsim.fourier(run, seen)
    return phase_slope(run, transformed), phase_slope(run, transformed, seen)


@pytest.fixture(scope="module")
def made() -> tuple[xr.Dataset, xr.Dataset]:
    return slopes_of(config())


def test_the_comparison_changes_no_number_of_the_rays(made: tuple[xr.Dataset, xr.Dataset]) -> None:
    alone, beside = made
    added = {"exact_phase_slope", "exact_slope_status", "exact_status"}
    assert set(beside) - set(alone) == added
    xr.testing.assert_identical(alone, beside[list(alone)])


@pytest.mark.parametrize("estimator", ["fft", "sinusoid"])
def test_the_slope_at_a_few_diameters_is_that_of_a_whole_run_by_maxwell(estimator: str) -> None:
    # the run's stages share none of the code that picks diameters and takes the slope there
    run = config(processing={"estimator": estimator})
    whole = by_maxwell(run, ACCURACY)
    seen = octsim.spectra(whole, None, 1, octsim.fields(whole))
    expected = octsim.phase_slope(whole, octsim.fourier(whole, seen))["phase_slope"].values
    diameters = run.sweep.diameters.values()
    found = exact_slopes(run, LAW.at(diameters))
    known = np.isfinite(found.slope)
    assert found.status == ExactStatus.COMPARED
    assert np.flatnonzero(known).tolist() == compared(diameters.size)
    assert known.sum() == DIAMETERS
    assert found.slope[known] == pytest.approx(expected[known], rel=1e-9)


def test_a_run_says_how_far_it_is_off_and_what_exactness_takes(
    made: tuple[xr.Dataset, xr.Dataset],
) -> None:
    alone, beside = made
    exact, rays = beside["exact_phase_slope"].values, beside["phase_slope"].values
    known = np.isfinite(exact)
    off = rays[known].mean() / exact[known].mean() - 1
    said = summary(beside)
    assert summary(alone) == own_summary(alone)
    assert said.startswith(own_summary(beside))
    assert "for a fibre pupil and the estimator fft" in said
    assert f"rays are {abs(off):.1%}" in said
    assert ("high here" if off > 0 else "low here") in said
    assert f"exact}} takes about {seconds_told(exact_seconds(config()))}" in said


def test_a_run_by_maxwell_is_not_compared_with_itself() -> None:
    run = by_maxwell(config())
    found = exact_slopes(run, LAW.at(run.sweep.diameters.values()))
    assert found.status == ExactStatus.BY_MAXWELL
    assert np.isnan(found.slope).all()


@pytest.mark.parametrize(
    ("overlay", "status", "said"),
    [
        ({"objective": {"numerical_aperture": 1.4}}, ExactStatus.BEYOND_SCHEME,
         "objective.numerical_aperture: 1.4 given, but tracing.scheme: fullwave"),
        ({"sweep": {"diameters": {"stop": "60 um"}}}, ExactStatus.TOO_LONG, "snakemake validity"),
        ({"sweep": {"diameters": {"num": 2}}}, ExactStatus.COMPARED, "three diameters or more"),
    ],
)  # fmt: skip
def test_what_is_not_compared_is_named(
    overlay: dict[str, object], status: ExactStatus, said: str
) -> None:
    run = config(**overlay)
    alone, beside = slopes_of(run)
    assert beside["exact_status"].item() == status
    assert np.isnan(beside["exact_phase_slope"]).all()
    assert said in summary(beside)
    xr.testing.assert_identical(alone, beside[list(alone)])


def test_of_a_law_that_could_not_be_fitted_nothing_is_solved() -> None:
    run = config()
    assert exact_slopes(run, np.full(16, np.nan)).status == ExactStatus.NO_FOCUS


def test_of_a_grid_the_first_combination_is_compared() -> None:
    run = load_config({**SMALL, "grid": {"scene.gap": ["5 nm", "50 nm"]}})
    _, beside = slopes_of(run)
    assert beside["exact_status"].values.tolist() == [
        ExactStatus.COMPARED, ExactStatus.OTHER_COMBINATION,
    ]  # fmt: skip
    assert np.isfinite(beside["exact_phase_slope"].values).sum(axis=1).tolist() == [DIAMETERS, 0]
    assert "at the grid's first combination" in summary(beside)


def test_figure_12_has_maxwell_s_points_where_there_are_some(
    made: tuple[xr.Dataset, xr.Dataset],
) -> None:
    def points(slopes: xr.Dataset) -> list[int]:
        with look():
            lines = figure_12(slopes).axes[0].lines
        return [
            np.asarray(line.get_xdata()).size
            for line in lines
            if line.get_label() == "Maxwell's equations"
        ]

    alone, beside = made
    assert points(alone) == []
    assert points(beside) == [DIAMETERS]


def test_the_pupil_is_the_one_that_is_compared_with() -> None:
    run = by_maxwell(config())
    assert pupil_name(run) == "fibre"
    filled = changed(run, {"objective": {"pupil": {"gaussian": 0.5}}})
    assert pupil_name(filled) == "Gaussian (fill 0.5)"
    assert beyond_maxwell(run) == ""
