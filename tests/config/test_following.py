"""One range serves all: null follows the sweep, and what follows is made anew with it."""

from typing import Any

import pytest

from octsim.config.following import (
    FOLLOWING,
    calibration_diameters,
    fitted_diameters,
    scan_diameter,
    scan_foci,
)
from octsim.config.load import load_config
from octsim.config.models import Config
from octsim.config.resolved_text import resolved_lines
from octsim.datasets.keys import keys_behind, keys_read, stage_axes

NULL: dict[str, Any] = {
    "focus_scan": {"diameter": None, "focus": None},
    "focus_law": {"diameters": None},
    "calibration": {"diameters": None},
}
AXON = {"sweep": {"diameters": {"start": "3 um", "stop": "6 um", "step": "10 nm"}}}


def test_the_thesis_follows_nothing() -> None:
    thesis = Config()
    assert scan_diameter(thesis) == thesis.focus_scan.diameter == 2.0
    assert scan_foci(thesis) is thesis.focus_scan.focus
    assert fitted_diameters(thesis) is thesis.focus_law.diameters
    assert calibration_diameters(thesis) is thesis.calibration.diameters


def test_an_axon_of_3_to_6_um_needs_one_range() -> None:
    axon = load_config(NULL, AXON)
    assert scan_diameter(axon) == 4.5
    assert (scan_foci(axon).start, scan_foci(axon).stop, scan_foci(axon).num) == (-2.25, 9.0, 501)
    law, table = fitted_diameters(axon), calibration_diameters(axon)
    assert (law.start, law.stop, law.num) == (3.0, 6.0, 16)
    assert (table.start, table.stop, table.num) == (3.0, 6.0, 151)


def test_a_short_sweep_has_enough_to_fit() -> None:
    short = load_config(NULL, {"sweep": {"diameters": {"start": "1 um", "stop": "1.05 um"}}})
    assert (fitted_diameters(short).num, calibration_diameters(short).num) == (9, 8)


def test_a_scan_of_a_given_diameter_has_foci_about_that() -> None:
    scan = load_config(AXON, {"focus_scan": {"diameter": "4 um", "focus": None}})
    assert (scan_foci(scan).start, scan_foci(scan).stop) == (-2.0, 8.0)


def test_null_is_recorded_as_null_and_read_back() -> None:
    axon = load_config(NULL, AXON)
    assert axon.to_dict()["focus_law"]["diameters"] is None
    assert load_config(axon.to_dict()) == axon


@pytest.mark.parametrize("stage", ["focus_scan", "focus_sweep", "calibration"])
def test_what_follows_the_sweep_is_made_anew_with_it(stage: str) -> None:
    assert "sweep.diameters" not in keys_read(stage, Config())
    assert "sweep.diameters" in keys_read(stage, load_config(NULL))


def test_foci_of_a_given_diameter_are_not_made_anew_with_the_sweep() -> None:
    given = load_config({"focus_scan": {"focus": None}})
    assert "sweep.diameters" not in keys_read("focus_scan", given)


def test_a_law_that_follows_has_the_axis_of_a_varied_sweep() -> None:
    grid = {"grid": {"sweep.diameters.num": [5, 9]}}
    assert stage_axes("focus_law", load_config(grid)) == ()
    (axis,) = stage_axes("focus_law", load_config(NULL, grid))
    assert axis.keys == ("sweep.diameters.num",)


def test_a_key_that_is_null_at_some_combinations_follows_there() -> None:
    config = load_config({"grid": {"focus_scan.diameter": [None, "2 um"]}})
    assert "sweep.diameters" in keys_behind("focus_scan", config)


def test_the_text_says_what_follows() -> None:
    lines = [line for line in resolved_lines(load_config(NULL, AXON)) if "# follows" in line]
    keys = [line.split(": ")[0].strip() for line in lines]
    assert keys == ["diameter", "focus", "diameters", "diameters"]
    assert lines[0] == "  diameter: null  # follows the sweep: 4.5 um"
    assert len(lines) == len(FOLLOWING)
