"""Combinations that cost the same are counted together, and none is lost."""

from typing import Any

import pytest

from octsim.config.alike import alike
from octsim.config.derive import config_at
from octsim.config.grid import combinations
from octsim.config.load import load_checked, load_config
from octsim.config.models import Config
from octsim.config.scheme import point_cost, rate_name

GRIDS: list[dict[str, Any]] = [
    {"scene.gap": ["1 nm", "2 nm", "3 nm"], "objective.numerical_aperture": [1.0, 1.1]},
    {"scene.gap": ["1 nm", "2 nm"], "tracing.rays": [200, 300], "processing.window": ["hann"]},
    {"combine": "zip", "scene.gap": ["1 nm", "2 nm", "3 nm"], "tracing.rays": [200, 300, 200]},
    {"combine": "zip", "scene.gap": ["1 nm", "2 nm"], "objective.magnification": [20, 21]},
    {
        "scene.cylinders": [
            [{"medium": "neuron"}],
            [{"medium": "neuron"}, {"medium": "neuron", "diameter": "1 um", "x": "9 um"}],
        ],
        "tracing.preset": ["draft", "standard"], "tracing.max_intersections": [9, 11],
        "objective.zernike.11": ["0 nm", "1 nm"],
        "sweep.focus": ["law", {"slope": 0.5, "intercept": "1 nm"}],
    },
    {
        "scene.gap": ["1 nm", "2 nm"], "scene.cylinders.0.azimuth": ["0 deg", "3 deg"],
        "scene.refractive_index.neuron": [1.38, 1.39], "sweep.diameters.num": [11, 21],
        "spectrum.source": ["flat", {"gaussian": {"centre": "750 nm", "fwhm": "90 nm"}}],
    },
]  # fmt: skip


@pytest.mark.parametrize("grid", GRIDS)
def test_what_combinations_cost_is_the_same_counted_together(grid: dict[str, Any]) -> None:
    config = load_config({"grid": grid})
    for keys in ((), ("scene",), ("tracing", "objective")):
        each = [at.config for at in combinations(config, *keys)]
        together = list(alike(config, *keys))
        assert sum(count for _, count in together) == len(each)
        expanded = [
            (rate_name(one), point_cost(one)) for one, count in together for _ in range(count)
        ]
        assert sorted(expanded) == sorted((rate_name(one), point_cost(one)) for one in each)


NEAR: list[dict[str, Any]] = [
    {"scene.refractive_index.neuron": {"start": 1.36, "stop": 1.39, "num": 300}},
    {"scene.cylinders.0.x": {"start": "1 um", "stop": "2 um", "num": 301}, "tracing.rays": [9, 8]},
    {
        "combine": "zip",
        "sweep.diameters.stop": {"start": "1.5 um", "stop": "2 um", "num": 300},
        "scene.refractive_index.neuron": {"start": 1.36, "stop": 1.39, "num": 300},
        "scene.gap": {"start": "1 nm", "stop": "2 nm", "num": 300},
    },
]
SHELL = {
    "scene": {
        "refractive_index": {"membrane": 1.46},
        "cylinders": [
            {"medium": "neuron", "shells": [{"medium": "membrane", "thickness": "20 nm"}]}
        ],
    },
}


@pytest.mark.parametrize("grid", NEAR)
@pytest.mark.parametrize("scheme", ["vogel", "paths", "fullwave"])
def test_numbers_that_cost_about_the_same_are_counted_together(
    grid: dict[str, Any], scheme: str
) -> None:
    config = load_config({"tracing": {"scheme": scheme}, "grid": grid})
    for keys in ((), ("scene",), ("sweep", "spectrum")):
        each = [at.config for at in combinations(config, *keys)]
        few = list(alike(config, *keys))
        assert sum(count for _, count in few) == len(each)
        assert len(few) < 0.7 * len(each) or len(each) == 1

        def seconds(one: Config) -> float:
            return point_cost(one).seconds * one.sweep.diameters.stop

        exact = sum(map(seconds, each))
        assert sum(count * seconds(one) for one, count in few) == pytest.approx(exact, rel=0.01)


@pytest.mark.parametrize("scheme", ["vogel", "paths", "fullwave"])
@pytest.mark.parametrize("indices", [[1.39, 1.391, 1.392], [1.392, 1.391, 1.39], [1.328, 1.33]])
def test_an_index_that_another_medium_has_stands_for_no_other(
    indices: list[float], scheme: str
) -> None:
    # between the two nothing is reflected, which takes less
    grid = {"scene.refractive_index.membrane": indices}
    config = load_config(SHELL, {"tracing": {"scheme": scheme}, "grid": grid})
    each = [point_cost(at.config) for at in combinations(config)]
    found = [(point_cost(one), count) for one, count in alike(config)]
    assert sum(count * one.seconds for one, count in found) == pytest.approx(
        sum(one.seconds for one in each), rel=0.01
    )


@pytest.mark.parametrize("grid", [*GRIDS, *NEAR])
def test_what_stands_for_others_is_a_combination_itself(grid: dict[str, Any]) -> None:
    config = load_config({"grid": grid})
    for keys in ((), ("scene",), ("tracing", "sweep")):
        texts = {str(at.config.to_dict()) for at in combinations(config, *keys)}
        kinds = [one for one, _ in alike(config, *keys)]
        if not {"scene.gap", "processing.window"} & grid.keys():  # else of what costs nothing
            assert {str(one.to_dict()) for one in kinds} <= texts


def test_combinations_that_differ_in_no_cost_are_one_kind() -> None:
    assert [count for _, count in alike(load_config({"grid": GRIDS[0]}))] == [6]


@pytest.mark.parametrize("grid", GRIDS)
def test_a_combination_is_the_config_that_checking_all_of_it_gives(grid: dict[str, Any]) -> None:
    config = load_config({"grid": grid})
    base = {**config.to_dict(), "grid": {}}
    for at in combinations(config):
        whole = config_at(base, at.values)
        assert at.config == whole
        assert at.config.to_dict() == whole.to_dict()


@pytest.mark.parametrize("grid", GRIDS)
def test_a_job_reads_the_config_that_its_run_has_checked(grid: dict[str, Any]) -> None:
    assert load_checked({"grid": grid}) == load_config({"grid": grid})
    assert load_checked({"scene": {"gap": "6 nm"}}) == load_config({"scene": {"gap": "6 nm"}})
