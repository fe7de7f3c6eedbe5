"""Rounding: octsim's doubles beside a tracer of 50 digits, at the default and at the extremes."""

import math
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from missing import unexplained

from octsim.config.checks import rounding_remarks
from octsim.config.grid import remarks
from octsim.config.load import load_config
from octsim.config.models import Config
from octsim.datasets.files import write
from octsim.figures.stability import stability_figure
from octsim.figures.style import look, save
from octsim.instrument.build import detector_of, scene_of
from octsim.optics.beam import aim, aperture_radius, vogel_spiral
from octsim.optics.interface import Vector, fresnel, unit
from octsim.optics.scene import NEURON_ON_GLASS, Scene
from octsim.studies.stability import compare as comparison
from octsim.studies.stability import pairs
from octsim.studies.stability import study as stability
from octsim.studies.stability.exact import inputs_of, numbers, tree
from octsim.studies.stability.matrix import Cell, axial, cells
from octsim.studies.stability.pairs import prepared
from octsim.studies.stability.single import follow_single
from octsim.studies.stability.verdict import Row, Status
from octsim.tracing.faces import faces_at
from octsim.tracing.light_paths import path_name

ROOT = Path(__file__).parents[2]
BASE = load_config()
MATRIX = {cell.name: cell for cell in cells(BASE)}
CELLS = (
    "default / none / ",
    "default / gap / 0 nm",
    "default / gap / 1 mm",
    "dense, wide / gap / 1 mm",
    "thin, wide / gap / 1 mm",
    "default / diameter / 1 nm",
    "default / diameter / 1 mm",
    "default / neuron − water / 0",
    "default / neuron − water / 1e-12",
    "default / numerical aperture / n_glass(1 − 1e-9)",
    "default / focus / −1 mm",
    "default / focus distance / 1 um",
    "default / rays / 1",
    "default / wavenumbers / 100000",
    "large / none / ",
)


def measured(name: str, rays: int = 12) -> Row:
    return comparison.measure(MATRIX[name], BASE, rays)


@pytest.mark.parametrize("name", CELLS)
def test_doubles_are_within_the_bound_of_50_digits(name: str) -> None:
    row = measured(name)
    assert row.status == Status.WITHIN, row
    assert row.paths_compared > 0
    assert row.phase.error < 1e-9
    assert row.amplitude.error < 1e-9


@pytest.mark.parametrize("edge", ["tangent", "critical, glass", "critical, neuron"])
def test_rays_next_to_an_edge_differ_only_as_far_as_rounding_goes(edge: str) -> None:
    row = measured(f"default / rays / {edge}", 20)
    assert row.status in {Status.WITHIN, Status.EDGE}, row
    assert row.paths_compared > 0
    # a condition number, and not luck, is what lets them differ
    assert row.amplitude.condition > 1e6


def test_the_axial_ray_of_50_digits_has_the_paths_of_parallel_plates() -> None:
    found = {
        path_name(end.code, NEURON_ON_GLASS): end
        for end in tree(inputs_of(BASE, 1.4, 0.8, 0.0, 0.0), 5)
    }
    n_glass, gap = numbers.mpf(1.52), numbers.mpf(0.005)
    expected = -2 * n_glass * numbers.mpf(0.8) + 2 * numbers.mpf(1.33) * gap
    assert abs(found["PT CR PT"].path - expected) < 1e-45
    ratio = (n_glass - numbers.mpf(1.33)) / (n_glass + numbers.mpf(1.33))
    assert abs(found["PR"].amplitude - ratio) < 1e-45


def test_a_diameter_off_by_a_ten_billionth_is_caught(monkeypatch: pytest.MonkeyPatch) -> None:
    def off(config: Config, diameter: float) -> Scene:
        return scene_of(config, diameter * (1 + 1e-10))

    monkeypatch.setattr(pairs, "scene_of", off)
    row = measured("default / none / ")
    assert row.status == Status.BEYOND
    assert "phase" in row.reason


def test_a_path_that_one_tree_lacks_is_caught(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(pairs, "tree", lambda given, most: tree(given, most)[1:])
    row = measured("default / none / ")
    assert row.status == Status.BEYOND
    assert "detected by octsim alone" in row.reason


def test_a_focus_beyond_the_objective_is_refused_with_the_reason() -> None:
    row = measured("default / focus / 1 mm")
    assert row.status == Status.REFUSED
    assert row.reason.startswith("objective.focus_distance: 300.0 um given; it must exceed")
    assert "\n" not in row.reason


@pytest.mark.parametrize("value", ["1 nm thick, gap 1 m", "1 pm thick, gap 1 m", "1 m thick"])
def test_what_rounding_spoils_is_warned_of_with_the_reason(value: str) -> None:
    cell = MATRIX[f"default / warned of / {value}"]
    (said,) = rounding_remarks(cell.config(BASE))
    assert "rounding" in said
    assert "\n" not in said
    assert said in remarks(cell.config(BASE))
    row = comparison.measure(cell, BASE, 12)
    assert row.status == Status.WARNED
    assert row.reason == said


def test_an_aperture_above_the_index_of_water_is_warned_of() -> None:
    (said,) = rounding_remarks(load_config({"objective": {"numerical_aperture": 1.4}}))
    assert said.startswith("objective.numerical_aperture: 1.4 is above the index of water, 1.33")
    assert rounding_remarks(BASE) == []


@pytest.mark.parametrize("contrast", [1e-12, 1e-9, 1e-6, 1e-3, 0.06])
@pytest.mark.parametrize("cos_i", [1.0, 0.7, 0.1])
def test_reflection_at_nearly_equal_indices_keeps_its_digits(contrast: float, cos_i: float) -> None:
    n_i, n_t = numbers.mpf(1.33), numbers.mpf(1.33 + contrast)
    cos_t = numbers.sqrt(1 - (n_i / n_t) ** 2 * (1 - numbers.mpf(cos_i) ** 2))
    parallel = (n_t * cos_i - n_i * cos_t) / (n_t * cos_i + n_i * cos_t)
    across = (n_i * cos_i - n_t * cos_t) / (n_i * cos_i + n_t * cos_t)
    expected = -numbers.sqrt((parallel**2 + across**2) / 2)
    r, _ = fresnel(1.33, 1.33 + contrast, cos_i, float(cos_t))
    assert r == pytest.approx(float(expected), rel=1e-14)


def test_the_objective_keeps_its_radius_close_to_the_index_of_glass() -> None:
    aperture = 1.52 * (1 - 1e-9)
    exact = 300 * numbers.tan(numbers.asin(numbers.mpf(aperture) / numbers.mpf(1.52)))
    assert aperture_radius(aperture, 1.52, 300.0) == pytest.approx(float(exact), rel=1e-15)


def test_the_last_of_many_rays_is_as_well_placed_as_the_first() -> None:
    num = 2_000_000
    x, y = vogel_spiral(num, 1.0)
    golden = (numbers.sqrt(5) - 1) / 2
    for j in (1, 2000, num - 2, num - 1):
        turn, r = 2 * numbers.pi * j * golden, numbers.sqrt(numbers.mpf(j) / (num - 1))
        assert x[j] == pytest.approx(float(r * numbers.cos(turn)), abs=3e-16)
        assert y[j] == pytest.approx(float(r * numbers.sin(turn)), abs=3e-16)


def test_a_direction_gets_its_length_back() -> None:
    length = math.hypot(*unit(Vector(0.6, 0.0, 0.8 + 1e-9)))
    assert length == pytest.approx(1, abs=2e-16)


def test_octsims_formulas_ray_by_ray_give_its_own_bits() -> None:
    config = load_config({"tracing": {"rays": 100}, "detector": {"core_diameter": "40 um"}})
    case = prepared(Cell("", "", "", ()), config)
    faces, place = faces_at(scene_of(config, 1.4), 8.0), np.argsort(case.beam.number)
    found = case.detections
    for ray, code, path in zip(found.ray, found.path, found.optical_path_length, strict=True):
        arguments = (case.beam, 0.876, int(place[ray]), int(code))
        double = follow_single(faces, detector_of(config), *arguments, np.float64)
        single = follow_single(faces, detector_of(config), *arguments, np.float32)
        assert double is not None
        assert double.optical_path_length == path
        assert single is None or type(single.optical_path_length) is np.float32


def test_rays_on_the_axis_and_next_to_it_give_finite_results() -> None:
    cell = Cell("", "", "", (), positions=axial)
    found = prepared(cell, BASE).detections
    assert np.isfinite(found.amplitude).all()
    assert np.isfinite(found.optical_path_length).all()
    assert found.amplitude.size > 0
    assert np.isfinite(aim(*axial(BASE, cell), 300.0)).all()


@pytest.fixture(scope="module")
def few() -> Iterator[xr.Dataset]:
    chosen = [MATRIX[name] for name in (*CELLS[:2], "default / focus / 1 mm")]
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(stability, "cells", lambda _: chosen)
        yield stability.stability(Config(), most=3)


def test_the_dataset_names_every_cell_and_explains_itself(few: xr.Dataset, tmp_path: Path) -> None:
    assert few["cell"].values.tolist()[0] == "default / none / "
    assert few["status"].attrs["flag_meanings"].split()[2] == "refused"
    assert few["status"].values.tolist() == [0, 0, 2]
    assert stability.summary(few) == "stability: 3 cells, 2 within, 1 refused"
    for name, variable in few.variables.items():
        assert variable.attrs["units"], name
        assert variable.attrs["long_name"], name
    write(few, tmp_path / "stability.nc")


def test_the_heat_map_is_the_same_bytes_each_time(few: xr.Dataset, tmp_path: Path) -> None:
    for copy in ("a.png", "b.png"):
        with look():
            save(stability_figure(few), tmp_path / copy)
    assert (tmp_path / "a.png").read_bytes() == (tmp_path / "b.png").read_bytes()


def test_a_lack_of_mpmath_is_one_line_with_the_remedy() -> None:
    code = (
        "import sys, octsim; sys.modules['mpmath'] = None\n"
        "try: import octsim.studies.stability.study\n"
        "except octsim.OctsimError as error: print(error)"
    )
    done = subprocess.run(
        [sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, check=True
    )
    remedy = "pip install 'octsim[stability]'"
    assert done.stdout == f"mpmath is not installed; run: {remedy}\n"


def test_a_status_says_why_a_number_is_missing(few: xr.Dataset) -> None:
    assert list(unexplained(few)) == []
