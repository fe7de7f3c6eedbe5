"""A long series is drawn by the extremes of each column of pixels: each sample is still seen."""

from pathlib import Path

import numpy as np
import pytest
import xarray as xr

import octsim
from octsim.figures.envelope import COLUMNS, band, columns, extremes
from octsim.figures.expansion import expansion_figure
from octsim.figures.style import look, save
from octsim.phase.measured_series import Series

COUNT = 200_000


def uneven(count: int) -> np.ndarray:
    return np.cumsum(np.random.default_rng(1).exponential(1.0, count))


def test_the_extremes_of_each_column_are_those_of_all_its_samples() -> None:
    x, rng = uneven(30_000), np.random.default_rng(2)
    y = rng.standard_cauchy(x.size)
    y[rng.random(x.size) < 0.2] = np.nan
    kept, column = extremes(x, y), columns(x)
    assert kept.size <= 3 * COLUMNS + 2
    assert kept[0] == 0
    assert kept[-1] == x.size - 1
    for one in range(COLUMNS):
        of, shown = y[column == one], y[kept][column[kept] == one]
        if of.size and not np.isnan(of).all():
            assert np.nanmin(shown) == np.nanmin(of)
            assert np.nanmax(shown) == np.nanmax(of)
        assert np.isnan(shown).any() == np.isnan(of).any()


def test_a_column_is_one_width_of_places_and_no_wider() -> None:
    x = uneven(30_000)
    column = columns(x)
    assert (np.diff(column) >= 0).all()
    assert column[0] == 0
    assert column[-1] == COLUMNS - 1
    widths = [np.ptp(x[column == one]) for one in np.unique(column)]
    assert max(widths) <= np.ptp(x) / COLUMNS


def test_few_samples_are_drawn_as_they_are() -> None:
    x = uneven(2 * COLUMNS)
    y = np.random.default_rng(3).normal(size=x.size)
    y[5:9] = np.nan
    np.testing.assert_array_equal(extremes(x, y), np.arange(x.size))
    for drawn, given in zip(band(x, y, y + 1), (x, y, y + 1), strict=True):
        np.testing.assert_array_equal(drawn, given)


def test_a_band_covers_every_sample_s() -> None:
    x = uneven(50_000)
    low = np.random.default_rng(4).normal(size=x.size)
    place, below, above = band(x, low, low + 1)
    assert place.size <= COLUMNS
    number = np.searchsorted(np.unique(columns(x)), columns(x))
    assert (below[number] <= low).all()
    assert (above[number] >= low + 1).all()
    assert below.min() == low.min()
    assert above.max() == low.max() + 1


@pytest.fixture(scope="module")
def recording() -> xr.Dataset:
    """Ten seconds at 20 kHz, with one sample that is far from all others."""
    diameter = np.linspace(1, 2, 11)
    slope = 24 + 0 * diameter
    table = xr.Dataset(
        {
            "fixed_focus_phase_slope": ("diameter", slope),
            "fixed_focus_phase_slope_standard_error": ("diameter", 0.01 * slope),
            "phase_curvature": ("diameter", -0.01 + 0 * slope),
        },
        {"diameter": diameter},
    )
    time = 5e-5 * np.arange(COUNT, dtype=np.float64)
    phase = 1e-2 * np.sin(300 * time) + 1e-3 * np.random.default_rng(1).normal(size=COUNT)
    phase[123_456] = 0.2
    series = Series(time, phase, np.full(COUNT, 1e-3))
    return octsim.series_expansion(octsim.load_config(), series, table)


def test_ten_seconds_at_20_khz_are_a_small_figure_that_shows_a_single_sample(
    recording: xr.Dataset, tmp_path: Path
) -> None:
    with look():
        figure = expansion_figure(recording)
        save(figure, tmp_path / "a.svg")
    assert (tmp_path / "a.svg").stat().st_size < 1_000_000
    (line,) = figure.axes[0].lines
    change = recording["expansion"].values
    drawn = np.asarray(line.get_ydata())
    assert drawn.max() == change[123_456]
    assert np.asarray(line.get_xdata())[drawn.argmax()] == 1e3 * recording["time"].values[123_456]
    assert figure.axes[0].get_ylim()[1] > change[123_456]
