"""Grids: what a config varies, and what is refused."""

from typing import Any

import pytest
from gridded import SMALL, gridded

from octsim.base.errors import ConfigError
from octsim.config.grid import axes, combinations, remarks, without_grid
from octsim.config.load import load_config
from octsim.datasets.axes import axis_coordinates, axis_name


def test_a_product_takes_every_value_with_every_other_the_last_key_fastest() -> None:
    config = gridded(
        {
            "detector.core_diameter": ["3.5 um", "4.4 um"],
            "scene.gap": {"start": "0 nm", "stop": "50 nm", "num": 3},
        }
    )
    found = [(at.config.detector.core_diameter, at.config.scene.gap) for at in combinations(config)]
    assert found == [(3.5, 0), (3.5, 0.025), (3.5, 0.05), (4.4, 0), (4.4, 0.025), (4.4, 0.05)]
    assert [axis_name(axis) for axis in axes(config)] == ["core_diameter", "gap"]


def test_zipped_keys_go_side_by_side() -> None:
    config = gridded({"combine": "zip", "scene.gap": ["1 nm", "2 nm"], "tracing.rays": [100, 300]})
    found = [(at.config.scene.gap, at.config.tracing.rays) for at in combinations(config)]
    assert found == [(0.001, 100), (0.002, 300)]


@pytest.mark.parametrize(
    ("key", "values"),
    [
        ("scene.gap", ["1 nm", "20 nm"]),
        ("tracing.rays", [100, 200]),
        ("processing.window", ["hann", "boxcar"]),
        ("sweep.focus", ["law", {"slope": 0.58, "intercept": "69 nm"}]),
        ("sweep.diameters.num", [3, 9]),
        ("tracing", [{"rays": 100}, {"scheme": "paths"}]),
        ("scene.refractive_index", [{"glass": 1.5}, {"neuron": 1.4, "water": 1.32}]),
    ],
)
def test_a_combination_is_the_config_with_its_value_written_in(key: str, values: list[Any]) -> None:
    for at, value in zip(combinations(gridded({key: values})), values, strict=True):
        overlay: Any = value
        for name in reversed(key.split(".")):
            overlay = {name: overlay}
        assert at.config == load_config(SMALL, overlay)


def test_a_preset_of_the_grid_brings_its_keys_and_those_beside_it_win() -> None:
    config = gridded({"tracing.preset": ["draft", "reference"], "tracing.max_intersections": [5]})
    tracings = [at.config.tracing for at in combinations(config)]
    assert [(t.scheme, t.accuracy, t.max_intersections) for t in tracings] == [
        ("paths", 3e-2, 5), ("paths", 1e-8, 5),
    ]  # fmt: skip


def test_a_checked_grid_is_read_back_the_same() -> None:
    config = gridded({"scene.gap": {"start": "0 nm", "stop": "10 nm", "num": 4}})
    assert load_config(config.to_dict()) == config


@pytest.mark.parametrize(
    ("grid", "message"),
    [
        ({"detector.core_diametr": ["4 um"]}, "grid.detector.core_diametr: unknown key;"),
        ({"scene": {"gap": ["5 nm"]}}, "don't nest here: write grid: {scene.gap"),
        ({"combine": "zip", "scene.gap": ["1 nm"], "tracing.rays": [1, 2]}, "scene.gap has 1, tr"),
        ({"scene.attenuation.myelin": ["1 /cm"]}, "no medium is called myelin; give scene"),
        ({"scene.refractive_index.myelin": [1.4]}, "no medium is called myelin; give scene"),
        ({"objective.zernike.coma": ["1 nm"]}, "grid.objective.zernike.coma: coma has a direction"),
        ({"objective.zernike.-11": ["1 nm"]}, "-11 is none of Noll's numbers"),
        ({"objective.zernike.4": ["1 nm"], "objective.zernike.defocus": ["1 nm"]}, "both set the"),
        ({"objective.zernike.8": ["1 kg"]}, "grid.objective.zernike.8: '1 kg' given .coma x.;"),
        ({"scene.gap": []}, r"grid.scene.gap: \[\] given; list one value or more"),
        ({"scene.gap": {"start": "1 nm", "stop": "1 nm", "num": 2}}, "or the range is empty"),
        ({"scene.gap": {"start": "1 nm", "stop": "2 nm", "num": 0}}, "grid.scene.gap.num: 0 given"),
        ({"scene.gap": {"start": "1 nm", "stop": 2, "num": 2}}, "both ends should be numbers, or"),
        ({"scene.gap": {"start": "1 nm", "stop": "2 nm"}}, "has start, stop and num"),
        ({"scene.gap": [5]}, "grid.scene.gap: 5 given; a length needs its unit"),
        ({"scene.gap": "5 nm"}, "grid.scene.gap: '5 nm' given; it should be a list of values, or"),
        ({"scene.gap": ["5 nm", "0.005 um"]}, "grid.scene.gap: .* stands twice"),
        ({"combine": "zip", "scene.gap": ["1 nm"] * 2, "tracing.rays": [1, 1]}, "stands twice"),
        ({"tracing.rays": {"start": 100, "stop": 200, "num": 4}}, "are not all whole numbers"),
        ({"tracing.rays": [1.5]}, "grid.tracing.rays: 1.5 given; it should be a whole number"),
        ({"tracing": [{}], "tracing.rays": [1]}, "grid.tracing: given beside grid.tracing.rays"),
        ({"run": ["a", "b"]}, "grid.run: can't be varied"),
        ({"sweep.diameters": {"start": "1 um", "stop": "2 um", "num": 2}}, "is itself a range"),
        ({"combine": "outer"}, "grid.combine: 'outer' given; the nearest that is known is"),
        ({"objective.numerical_aperture": [1, 1.6]}, "grid, at objective.numerical_aperture = 1.6"),
        ({"scene.gap": {"start": "0 nm", "stop": "1 um", "num": 1000},
          "tracing.rays": {"start": 1, "stop": 1000, "num": 1000}}, "1000000 combinations; at mo"),
    ],
)  # fmt: skip
def test_a_grid_that_is_wrong_is_refused_in_a_line(grid: dict[str, Any], message: str) -> None:
    with pytest.raises(ConfigError, match=message) as raised:
        gridded(grid)
    assert all(line for line in str(raised.value).splitlines())


def test_only_combinations_have_to_be_possible() -> None:
    # of itself impossible: an aperture above the glass's index, which every combination raises
    high = {"objective": {"numerical_aperture": 1.6}}
    config = gridded({"scene.refractive_index.glass": [1.7, 1.8]}, high)
    assert len(list(combinations(config))) == 2


def test_two_remarks_on_one_key_are_both_said() -> None:
    coarse = {"sweep": {"diameters": {"start": "1 um", "stop": "9 um", "num": 20}}}
    for grid in ({}, {"scene.gap": ["1 nm", "2 nm"]}):
        said = [line for line in remarks(gridded(grid, coarse)) if "sweep.diameters: " in line]
        assert len(said) == 2
        assert all(line.endswith("(at 2 of 2 combinations)") for line in said) == bool(grid)


def test_remarks_tell_at_how_many_combinations_they_hold() -> None:
    config = gridded(
        {"sweep.diameters.num": [2, 3, 50]}, {"sweep": {"diameters": {"stop": "2 um"}}}
    )
    said = [line for line in remarks(config) if line.startswith("sweep.diameters: a step")]
    assert len(said) == 1
    assert said[0].endswith("(at 2 of 3 combinations)")


def test_a_target_of_a_single_config_refuses_a_grid() -> None:
    with pytest.raises(ConfigError, match=r"grid: scene.gap given, but tradeoff is of a single"):
        without_grid(gridded({"scene.gap": ["0 nm", "30 nm"]}), "tradeoff")
    assert without_grid(load_config(SMALL), "tradeoff") == load_config(SMALL)


def test_a_key_of_a_target_that_a_run_has_once_is_not_varied() -> None:
    with pytest.raises(ConfigError, match="can't be varied"):
        load_config({"grid": {"calibration.step": ["0.1 nm", "0.2 nm"]}})


def test_zernike_terms_and_attenuations_that_no_key_has_yet_are_varied() -> None:
    grid = {
        "objective.zernike.spherical": {"start": "-10 nm", "stop": "10 nm", "num": 3},
        "scene.attenuation.neuron": {"start": "0 /cm", "stop": "100 /cm", "num": 2},
    }
    config = gridded(grid)
    assert list(config.grid.varied) == ["objective.zernike.11", "scene.attenuation.neuron"]
    found = [at.config for at in combinations(config)]
    assert [c.objective.zernike.of for c in found[::2]] == [{11: -0.01}, {}, {11: 0.01}]
    assert [c.scene.attenuation.of["neuron"] for c in found[:2]] == [0.0, 0.01]
    assert [axis_name(axis) for axis in axes(config)] == ["zernike_11", "attenuation_neuron"]
    assert load_config(config.to_dict()) == config
    coordinates = axis_coordinates(axes(config), tuple(combinations(config)))
    assert {name: one.attrs["units"] for name, one in coordinates.items()} == {
        "zernike_11": "um", "attenuation_neuron": "1/um",
    }  # fmt: skip
    assert coordinates["zernike_11"].values.tolist() == [-0.01, 0.0, 0.01]


def test_a_term_of_the_grid_is_laid_over_that_of_the_config() -> None:
    given = {"objective": {"zernike": {"spherical": "3 nm", "coma x": "2 nm"}}}
    config = gridded({"objective.zernike.11": ["0 nm", "1 nm"]}, given)
    found = [at.config.objective.zernike.of for at in combinations(config)]
    assert found == [{8: 0.002}, {8: 0.002, 11: 0.001}]


def test_an_index_of_a_medium_of_ones_own_is_varied() -> None:
    shell = {"medium": "myelin", "thickness": "9 nm"}
    scene = {
        "refractive_index": {"myelin": 1.44},
        "cylinders": [{"medium": "neuron", "shells": [shell]}],
    }
    grid = {"scene.refractive_index.myelin": [1.44, 1.46], "scene.attenuation.myelin": ["1 /cm"]}
    assert len(list(combinations(gridded(grid, {"scene": scene})))) == 2
