"""Figure 6: the error of the intensity is drawn, and the neuron stands on the focus axis."""

import numpy as np
import pytest
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.patches import Rectangle

import octsim
from octsim.datasets.files import flags
from octsim.figures.focus_scan import figure_6
from octsim.schemes.light import AccuracyStatus


@pytest.fixture
def scan(stages: dict[str, xr.Dataset]) -> xr.Dataset:
    return stages["focus_scan"].copy(deep=True)


def panels(scan: xr.Dataset) -> tuple[Axes, Axes]:
    rays, light = figure_6(scan).axes
    return rays, light


def test_the_band_of_the_intensity_is_as_wide_as_its_error(scan: xr.Dataset) -> None:
    scan["intensity_error"].values[:] = np.linspace(0.1, 5.0, scan.sizes["focus"])
    _, light = panels(scan)
    (band,) = (one for one in light.collections if isinstance(one, PolyCollection))
    corners = np.concatenate([path.vertices for path in band.get_paths()])
    mean, error = scan["intensity"].values, scan["intensity_error"].values
    for focus, value in zip(scan["focus"].values, mean * (1 + error), strict=True):
        at = corners[corners[:, 0] == focus, 1]
        np.testing.assert_allclose(at.max(), value)
    # where the error is larger than the intensity, the band reaches the edge of the axes
    lost = corners[corners[:, 0] == scan["focus"].values[-1], 1]
    np.testing.assert_allclose(lost.min(), light.get_ylim()[0])
    assert light.get_ylim()[1] > np.max(mean * (1 + error))


def test_the_neuron_is_shaded_from_its_lower_to_its_upper_side(scan: xr.Dataset) -> None:
    config = octsim.load_config()
    low = config.scene.gap
    for axes in panels(scan):
        (span,) = (one for one in axes.patches if isinstance(one, Rectangle))
        ends = np.array([span.get_x(), span.get_x() + span.get_width()])
        np.testing.assert_allclose(ends, [low, low + float(scan["diameter"])])


def test_points_whose_accuracy_is_not_reached_are_marked_and_named(scan: xr.Dataset) -> None:
    codes = np.zeros(scan.sizes["focus"], int)
    codes[[3, 4]] = AccuracyStatus.BUDGET_SPENT, AccuracyStatus.AT_AN_EDGE
    values, attributes = flags(AccuracyStatus, codes)
    scan["accuracy_status"] = "focus", values, attributes
    _, light = panels(scan)
    (marks,) = (
        line for line in light.lines if line.get_marker() == "s" and np.size(line.get_xdata())
    )
    np.testing.assert_array_equal(marks.get_xdata(), scan["focus"].values[[3, 4]])
    labels = light.get_legend_handles_labels()[1]
    assert "doubtful: budget spent, at an edge" in labels
