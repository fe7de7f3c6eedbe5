"""Figures: drawn from stored datasets, labelled with units, the same bytes each time."""

import logging
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
import pytest
import xarray as xr
from made_runs import WHOLE
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.colors import to_rgb

import octsim
from octsim.config.processing import Processing
from octsim.datasets.gallery import FORMS, all_run_figures
from octsim.figures.draw import figure_of
from octsim.figures.paths import LINES
from octsim.figures.style import component_colour, look, save
from octsim.stages.centres import CentreUse
from octsim.stages.gaussian_fits import FitStatus

FIGURES = all_run_figures()
IMAGES = [form for form in FORMS if form != "txt"]
# curves, panels, a drawing and an image: the others, drawn alike, are compared in one form
EACH = {"figure_12", "paths", "scene", "grid"}
CASES = [
    pytest.param(name, form, marks=[] if name in EACH or form == "svg" else pytest.mark.trial)
    for name in FIGURES
    for form in IMAGES
]
GRID = {"processing.window": ["hann", "hamming"], "processing.centre": ["mean", "midpoint"]}


@pytest.fixture(scope="module")
def over_grid(stages: dict[str, xr.Dataset]) -> xr.Dataset:
    config = octsim.load_config(WHOLE, {"grid": GRID})
    return octsim.phase_slope(config, octsim.fourier(config, stages["spectra"]))


@pytest.mark.parametrize(("name", "form"), CASES)
def test_a_figure_is_the_same_bytes_each_time_and_has_units(
    name: str, form: str, stages: dict[str, xr.Dataset], over_grid: xr.Dataset, tmp_path: Path
) -> None:
    for copy in ("a", "b"):
        with look():
            given = stages | {"phase_slope": over_grid} if name == "grid" else stages
            figure = figure_of(FIGURES[name], given, Processing())
            save(figure, tmp_path / f"{copy}.{form}")
    assert (tmp_path / f"a.{form}").read_bytes() == (tmp_path / f"b.{form}").read_bytes()
    labels = {text for axes in figure.axes for text in (axes.get_xlabel(), axes.get_ylabel())}
    assert labels - {""} == LABELS[name]


def test_no_matplotlibrc_of_the_user_changes_a_byte(
    stages: dict[str, xr.Dataset], tmp_path: Path
) -> None:
    theirs: dict[Any, Any] = {
        "savefig.dpi": 300, "savefig.bbox": "tight", "axes.labelsize": 20, "lines.marker": "o",
        "text.usetex": True, "svg.fonttype": "none", "pdf.fonttype": 3, "axes.facecolor": "black",
        "path.simplify": False, "font.family": "serif", "axes.formatter.use_locale": True,
        "timezone": "Europe/Berlin", "svg.id": "theirs",
    }  # fmt: skip
    for copy, rc in (("none", {}), ("theirs", theirs)):
        with mpl.rc_context(rc):
            before = dict(mpl.rcParams.copy())
            with look():
                figure = figure_of(FIGURES["figure_12"], stages, Processing())
                for form in IMAGES:
                    save(figure, tmp_path / f"{copy}.{form}")
            assert dict(mpl.rcParams.copy()) == before
    for form in IMAGES:
        assert (tmp_path / f"none.{form}").read_bytes() == (
            tmp_path / f"theirs.{form}"
        ).read_bytes()


def longer(dataset: xr.Dataset, axis: str, count: int) -> xr.Dataset:
    """Repeat a dataset along an axis, that is as long as it was but has many points."""
    old = dataset[axis]
    new = np.linspace(float(old.min()), float(old.max()), count)
    repeated = dataset.isel({axis: np.sort(np.arange(count) % old.size)})
    return repeated.assign_coords({axis: (axis, new, old.attrs)})


@pytest.mark.parametrize(
    ("name", "axis"),
    [
        ("figure_6", "focus"),
        ("figure_7", "diameter"),
        ("figure_8", "wavenumber"),
        pytest.param("figure_10", "diameter", marks=pytest.mark.trial),
        pytest.param("figure_11", "diameter", marks=pytest.mark.trial),
        ("figure_12", "diameter"),
        ("paths", "diameter"),
        ("grid", "window"),
    ],
)
def test_a_figure_of_very_many_points_is_a_small_file(
    name: str, axis: str, stages: dict[str, xr.Dataset], over_grid: xr.Dataset, tmp_path: Path
) -> None:
    many = {source: stages[source] for source in FIGURES[name].sources}
    if name == "grid":
        wide = xr.concat([over_grid] * 60, "centre", data_vars="minimal")
        many = {"phase_slope": wide.isel(window=np.arange(600) % 2)}
    else:
        many = {source: longer(dataset, axis, 40_000) for source, dataset in many.items()}
    with look():
        save(figure_of(FIGURES[name], many, Processing()), tmp_path / "a.svg")
    assert (tmp_path / "a.svg").stat().st_size < 1_500_000


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
    "scene": {"x (µm)", "height (µm)"},
    "aperture": {"x (radius of the aperture)", "y (radius of the aperture)"},
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


def test_figures_without_light_say_so_and_what_to_do(
    stages: dict[str, xr.Dataset], tmp_path: Path
) -> None:
    """No panel is empty without a word, and no word is written over a legend."""
    dark = dict(stages)
    for name, variable in (
        ("focus_scan", "intensity"), ("spectra", "intensity"), ("paths", "field_amplitude"),
    ):  # fmt: skip
        dark[name] = stages[name].assign({variable: 0 * stages[name][variable]})
    for name in ("figure_6", "figure_8", "paths"):
        with look():
            figure = figure_of(FIGURES[name], dark, Processing())
            FigureCanvasAgg(figure).print_figure(tmp_path / "f.png")
        (written,) = [text for text in figure.texts if "light" in text.get_text()]
        assert "media whose indices" in written.get_text().replace("\n", " ")
        for legend in figure.legends:
            assert not written.get_window_extent().overlaps(legend.get_window_extent())


def test_diameters_without_a_peak_are_named_below_the_law(stages: dict[str, xr.Dataset]) -> None:
    law, fits = (stages[name].copy(deep=True) for name in ("focus_law", "gaussian_fits"))
    for name in ("slope", "intercept"):
        law[name].values[...] = np.nan
    law["centre_use"].values[:] = CentreUse.NO_CENTRE
    law["status"].values[:] = FitStatus.NO_LIGHT
    for name in ("brightest_focus", "centre"):
        (law if name in law else fits)[name].values[:] = np.nan
    without = stages | {"focus_law": law, "gaussian_fits": fits}
    figure = figure_of(FIGURES["figure_7"], without, Processing())
    count, diameter = law.sizes["diameter"], law["diameter"].values
    (written,) = [text.get_text().replace("\n", " ") for text in figure.texts]
    assert (
        f"no Gaussian fits at {count} of {count} diameters: {diameter[0]:.4g} um (no_light)"
        in written
    )
    assert figure.axes[0].get_xlim() == (diameter[0], diameter[-1])


def test_text_in_a_pdf_is_text_and_no_date_stands_in_it(
    stages: dict[str, xr.Dataset], tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    with look(), caplog.at_level(logging.INFO):
        save(figure_of(FIGURES["figure_12"], stages, Processing()), tmp_path / "a.pdf")
    assert not caplog.records  # a job's log has what is said, and of fonts there is nothing to say
    held = (tmp_path / "a.pdf").read_bytes()
    assert held.startswith(b"%PDF")
    # outlines of a TrueType font, that a reader maps to letters; not drawn shapes of letters
    assert b"/FontFile2" in held
    assert b"/ToUnicode" in held
    assert b"/Type3" not in held
    assert b"/CreationDate" not in held


def test_a_component_that_leaves_figure_12_is_marked_at_its_edge(
    stages: dict[str, xr.Dataset],
) -> None:
    slopes = stages["phase_slope"].copy(deep=True)
    strongest = slopes["strongest_component"].values
    other = next(number for number in np.unique(strongest) if (strongest != number).any())
    slopes["component_phase_slope"].values[strongest != other, other] = 1e4
    figure = figure_of(FIGURES["figure_12"], stages | {"phase_slope": slopes}, Processing())
    said = [text.get_text() for text in figure.legends[0].get_texts()]
    assert "leaves the axes, to 1e+04" in said


DIAMETERS = xr.DataArray(np.arange(9) % 4 == 1, dims="diameter")


def test_slopes_by_maxwells_equations_are_points_with_nothing_between_them(
    stages: dict[str, xr.Dataset],
) -> None:
    exact_slope = stages["phase_slope"]["phase_slope"].where(DIAMETERS)
    slopes = stages["phase_slope"].assign(exact_phase_slope=exact_slope)
    figure = figure_of(FIGURES["figure_12"], stages | {"phase_slope": slopes}, Processing())
    (exact,) = (one for one in figure.axes[0].lines if one.get_label() == "Maxwell's equations")
    assert exact.get_linestyle() == "None"


def test_every_light_path_has_a_dash_pattern_of_its_own() -> None:
    """So that they are told apart in grey."""
    assert len({str(line) for _, line in LINES}) == len(LINES)
