"""Marks: what is doubtful, missing or beyond the axes is seen, each once in the legend."""

import numpy as np
import pytest
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from octsim.datasets.files import flags
from octsim.figures.marks import (
    DOUBTFUL,
    MISSING,
    doubtful,
    mark_clipped,
    mark_missing_rows,
    mark_points,
)
from octsim.phase.fringe_status import FringeStatus
from octsim.schemes.light import AccuracyStatus
from octsim.stages.gaussian_fits import FitStatus
from octsim.studies.calibration.scheme import ModelStatus

X = np.linspace(0.0, 4.0, 5)


@pytest.fixture
def axes() -> Axes:
    return Figure().subplots()


def status_of(*codes: FringeStatus) -> xr.DataArray:
    values, attributes = flags(FringeStatus, np.array(codes))
    return xr.DataArray(values, dims="x", attrs=attributes)


def marked(axes: Axes, look: object) -> list[tuple[float, float]]:
    """Places that are marked by one look."""
    return [
        (float(x), float(y))
        for line in axes.lines
        if line.get_marker() == look
        for x, y in zip(*map(np.asarray, line.get_data()), strict=True)
    ]


def legend(axes: Axes) -> list[str]:
    return list(axes.get_legend_handles_labels()[1])


def test_every_status_that_is_amiss_is_doubtful_and_no_other() -> None:
    for kind, fine in (
        (FringeStatus, {FringeStatus.VISIBLE}),
        (AccuracyStatus, {AccuracyStatus.REACHED, AccuracyStatus.NOT_CONTROLLED}),
        (FitStatus, {FitStatus.FITTED}),
        (ModelStatus, {ModelStatus.BY_MAXWELL, ModelStatus.COMPARED}),
    ):
        codes = np.array(list(kind))
        values, attributes = flags(kind, codes)
        found = doubtful(xr.DataArray(values, dims="x", attrs=attributes))
        np.testing.assert_array_equal(found, [code not in fine for code in codes])


def test_a_doubtful_point_is_marked_where_it_is_and_named_once(axes: Axes) -> None:
    status = status_of(
        FringeStatus.VISIBLE, FringeStatus.MIXED, FringeStatus.VISIBLE, FringeStatus.POOR_FIT,
        FringeStatus.VISIBLE,
    )  # fmt: skip
    for _ in range(2):
        mark_points(axes, X, X**2, status)
    assert set(marked(axes, DOUBTFUL["marker"])) == {(1.0, 1.0), (3.0, 9.0)}
    assert legend(axes) == ["doubtful: mixed, poor fit"]


def test_a_point_without_a_value_is_marked_at_the_lower_edge_with_its_reason(axes: Axes) -> None:
    status = status_of(*[FringeStatus.VISIBLE] * 4, FringeStatus.NO_LIGHT)
    mark_points(axes, X, np.where(status.values == 0, X, np.nan), status)
    ((place, height),) = marked(axes, MISSING["marker"])
    assert place == 4.0
    assert 0 < height < 0.05
    assert legend(axes) == ["no value: no light"]


def test_where_all_of_many_are_doubtful_the_legend_says_so_and_no_curve_is_hidden(
    axes: Axes,
) -> None:
    many = np.arange(99.0)
    mark_points(axes, many, many, status_of(*[FringeStatus.MIXED] * 99))
    mark_points(axes, many, many, status_of(*[FringeStatus.MIXED] * 99), "the gap")
    assert marked(axes, DOUBTFUL["marker"]) == []
    assert legend(axes) == [
        "doubtful, at every point: mixed", "doubtful, at every point of the gap: mixed"
    ]  # fmt: skip


def test_old_files_without_a_status_have_their_gaps_marked(axes: Axes) -> None:
    mark_points(axes, X, np.where(X == 2, np.nan, X), None)
    assert [place for place, _ in marked(axes, MISSING["marker"])] == [2.0]


def test_rows_without_a_value_are_marked_at_the_left_edge(axes: Axes) -> None:
    mark_missing_rows(axes, X, np.where(X == 3, np.nan, X), "not by this scheme")
    ((place, row),) = marked(axes, MISSING["marker"])
    assert 0 < place < 0.05
    assert row == 3.0
    assert legend(axes) == ["no value: not by this scheme"]


@pytest.mark.parametrize("scale", ["linear", "log"])
def test_a_curve_that_leaves_the_axes_is_marked_where_it_does(axes: Axes, scale: str) -> None:
    values = np.array([1.0, 100.0, 1.0, 1e-4, 1.0])
    axes.plot(X, values, color="#0072B2")
    axes.set_yscale(scale)
    axes.set_ylim(1e-2, 10.0)
    mark_clipped(axes)
    up, down = (sorted(place for place, _ in marked(axes, one)) for one in "^v")
    level = {"linear": (10 - 1) / (100 - 1), "log": 0.5}[scale]
    np.testing.assert_allclose(up, [level, 2 - level])
    level = {"linear": (1 - 1e-2) / (1 - 1e-4), "log": 0.5}[scale]
    np.testing.assert_allclose(down, [2 + level, 4 - level])
    assert {line.get_color() for line in axes.lines if line.get_marker() == "v"} == {"#0072B2"}
    assert legend(axes) == ["leaves the axes, to 0.0001 and 100"]


def test_a_curve_within_the_axes_has_no_mark(axes: Axes) -> None:
    axes.plot(X, X)
    axes.axhline(99)
    axes.set_ylim(0, 100)
    mark_clipped(axes)
    assert len(axes.lines) == 2
    assert legend(axes) == []


def test_a_negative_end_is_written_with_a_minus_sign(axes: Axes) -> None:
    axes.plot(X, -X)
    axes.set_ylim(-1, 1)
    mark_clipped(axes)
    assert legend(axes) == ["leaves the axes, to −4"]
