"""Ranges are given by a number, by a step or as a list, and what is not one is said."""

from typing import Any

import numpy as np
import pytest

from octsim.base.errors import ConfigError
from octsim.config.grid import combinations
from octsim.config.load import load_config
from octsim.config.ranges import DiameterList, counted, even

ENDS = {"start": "3 um", "stop": "6 um"}


def swept(diameters: Any) -> Any:
    return load_config({"sweep": {"diameters": diameters}}).sweep.diameters


def test_a_step_is_a_number_of_values() -> None:
    stepped, counted_ = swept({**ENDS, "step": "10 nm"}), swept({**ENDS, "num": 301})
    assert stepped == counted_
    assert np.array_equal(stepped.values(), counted_.values())
    law = load_config({"focus_law": {"fraction": {"step": 0.02}}}).focus_law
    assert (law.fraction.num, law.fraction.stop) == (21, 0.8)


def test_what_is_given_later_stands_of_number_and_step() -> None:
    overlays = [{"sweep": {"diameters": one}} for one in ({"step": "0.1 um"}, {"num": 21})]
    assert load_config(*overlays).sweep.diameters.num == 21
    assert load_config(*reversed(overlays)).sweep.diameters.num == 11


def test_a_list_is_as_it_is_given() -> None:
    listed = swept(["1 um", "1.02 um", "1100 nm"])
    assert isinstance(listed, DiameterList)
    assert listed.values().tolist() == [1.0, 1.02, 1.1]
    assert (listed.start, listed.stop, listed.num) == (1.0, 1.1, 3)
    assert listed.largest_step == pytest.approx(0.08)


def test_a_list_is_read_back_from_a_record() -> None:
    config = load_config({"sweep": {"diameters": ["1 um", "1.02 um"]}})
    assert config.to_dict()["sweep"]["diameters"] == ["1.0 um", "1.02 um"]
    assert load_config(config.to_dict()) == config


def test_a_grid_takes_a_step_and_lists_of_diameters() -> None:
    gaps = load_config({"grid": {"scene.gap": {"start": "0 nm", "stop": "10 nm", "step": "5 nm"}}})
    assert [at.config.scene.gap for at in combinations(gaps)] == [0.0, 0.005, 0.01]
    lists = [["1 um", "1.1 um"], ["1 um", "1.05 um", "1.1 um"]]
    varied = load_config({"grid": {"sweep.diameters": lists}})
    assert [at.config.sweep.diameters.num for at in combinations(varied)] == [2, 3]


@pytest.mark.parametrize(
    ("overlay", "said"),
    [
        ({"sweep": {"diameters": {"step": "3 nm"}}}, "let it stop at 1.999 um or 2.002 um"),
        ({"sweep": {"diameters": {"step": "0 nm"}}}, "its step should be above 0"),
        ({"sweep": {"diameters": {"step": "2 um"}}}, "its step should be above 0, and at most"),
        ({"sweep": {"diameters": {"step": 3}}}, "its step should be of the kind of its ends"),
        ({"sweep": {"diameters": {"step": "1e-9 um"}}}, "its step makes more than 1000000 values"),
        ({"sweep": {"diameters": {"step": "1 nm", "num": 5}}}, "it has num and step"),
        ({"sweep": {"diameters": {"start": "x", "step": "1 nm"}}}, "sweep.diameters.start: 'x'"),
        ({"sweep": {"diameters": ["2 um", "1 um"]}}, "1.0 um stands after 2.0 um; list each once"),
        ({"sweep": {"diameters": ["1 um", "1 um"]}}, "1.0 um stands after 1.0 um; list each once"),
        ({"sweep": {"diameters": ["1 um", 2]}}, "sweep.diameters.1: 2 given; a length needs its"),
        ({"sweep": {"diameters": ["1 um"]}}, "it should list 2 to 1000000 diameters, not 1"),
        ({"sweep": {"diameters": "1 um"}}, "sweep.diameters: '1 um' given; it should be {start,"),
        ({"calibration": {"diameters": ["1 um", "2 um"]}}, "it should list 8 to 1000000 diameters"),
        ({"focus_law": {"fraction": [0.4, 0.6]}}, "or {start, stop, step}, as it is evenly spaced"),
        ({"grid": {"scene.gap": {"start": "0 nm", "stop": "9 nm", "step": "2 nm"}}}, "at 0.008 um"),
        ({"grid": {"scene.gap": {"start": "0 nm", "stop": "9 nm", "step": 2}}}, "needs its unit"),
    ],
)  # fmt: skip
def test_what_is_no_range_is_one_line(overlay: dict[str, Any], said: str) -> None:
    with pytest.raises(ConfigError) as refused:
        load_config(overlay)
    (line,) = str(refused.value).splitlines()
    assert said in line


def test_steps_that_are_whole_but_for_rounding_are_whole() -> None:
    assert counted(0.1, 0.7, 0.1, "um") == 7
    assert counted(1.0, 2.0, 1 / 3, "") == 4


def test_work_that_needs_even_spacing_refuses_a_list() -> None:
    config = load_config({"sweep": {"diameters": ["1 um", "1.02 um", "1.1 um"]}})
    with pytest.raises(ConfigError, match="a list given, but tradeoff needs evenly spaced ones"):
        even(config.sweep.diameters, "tradeoff")
    usual = load_config().sweep.diameters
    assert even(usual, "tradeoff") is usual
