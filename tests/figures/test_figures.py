"""Figures: drawn from stored datasets, labelled with units, the same bytes each time."""

from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from made_runs import WHOLE
from matplotlib.colors import to_rgb

import octsim
from octsim.config.processing import Processing
from octsim.datasets.gallery import all_run_figures
from octsim.figures.draw import figure_of
from octsim.figures.style import component_colour, look, save

FIGURES = all_run_figures()
GRID = {"processing.window": ["hann", "hamming"], "processing.centre": ["mean", "midpoint"]}


@pytest.fixture(scope="module")
def over_grid(stages: dict[str, xr.Dataset]) -> xr.Dataset:
    config = octsim.load_config(WHOLE, {"grid": GRID})
    return octsim.phase_slope(config, octsim.fourier(config, stages["spectra"]))


@pytest.mark.parametrize("name", FIGURES)
def test_a_figure_is_the_same_bytes_each_time_and_has_units(
    name: str, stages: dict[str, xr.Dataset], over_grid: xr.Dataset, tmp_path: Path
) -> None:
    for copy in ("a", "b"):
        with look():
            given = stages | {"phase_slope": over_grid} if name == "grid" else stages
            figure = figure_of(FIGURES[name], given, Processing())
            for form in ("png", "svg"):
                save(figure, tmp_path / f"{copy}.{form}")
    for form in ("png", "svg"):
        assert (tmp_path / f"a.{form}").read_bytes() == (tmp_path / f"b.{form}").read_bytes()
    labels = {text for axes in figure.axes for text in (axes.get_xlabel(), axes.get_ylabel())}
    assert labels - {""} == LABELS[name]


LABELS = {
    "grid": {
        "Processing window",
        "Mean slope (mrad/nm)",
        "Scatter (mrad/nm)",
    },
    "figure_1": {"x (radius of the aperture)", "y (radius of the aperture)"},
    "figure_6": {
        "Height of the focus above the glass (µm)",
        "Rays detected",
        "Mean intensity\n(1 = all light in phase)",
    },
    "figure_7": {"Diameter of the cylinder (µm)", "Best focus (µm)", "Off the line (nm)"},
    "figure_8": {"Wavenumber in vacuum, 2 pi / wavelength (1/µm)", "Intensity (largest = 1)"},
    "figure_9": {"Component of the Fourier transform", "Magnitude (sum over the samples)"},
    "figure_10": {"Diameter of the cylinder (µm)", "Magnitude (sum over the samples)"},
    "figure_11": {"Diameter of the cylinder (µm)", "Phase, unwrapped (rad)"},
    "figure_12": {"Diameter of the cylinder (µm)", "Phase slope (mrad/nm)"},
    "paths": {
        "Diameter of the cylinder (µm)",
        "Field amplitude",
        "Share of the intensity",
        "Mean optical path (µm)",
    },
}


def test_components_differ_in_lightness_too() -> None:
    light = [np.dot(to_rgb(component_colour(c)), (0.2126, 0.7152, 0.0722)) for c in (1, 2)]
    assert abs(light[0] - light[1]) > 0.2
