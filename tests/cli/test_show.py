"""What a dataset comes to is told in words."""

from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from made_runs import make

from octsim.cli.main import main
from octsim.cli.show import described, in_words
from octsim.datasets.catalog import CATALOG
from octsim.datasets.files import flags
from octsim.phase.fringe_status import FringeStatus


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    made: Path = tmp_path_factory.mktemp("results") / "tiny"
    make(made, scan=True)
    make(made, scan=False)
    return made


def test_a_dataset_is_told_with_its_result_and_statuses(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["show", str(folder / "phase_slope.nc")]) == 0
    first, result, held, *statuses = capsys.readouterr().out.splitlines()
    assert first.startswith(f"{folder}/phase_slope.nc: Phase slope: change of the spectrum's")
    assert result.startswith("  phase slope ")
    assert " variables over diameter 9, " in held
    assert "  fringe_status: visible 9" in statuses


def test_a_run_is_told_dataset_by_dataset_as_they_are_made(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["show", str(folder)]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert lines[0] == f"{folder}: run tiny, 3 datasets"
    names = [line.split(":")[0] for line in lines[1:] if not line.startswith(" ")]
    assert names == ["focus_scan.nc", "spectra.nc", "phase_slope.nc"]


def test_what_is_no_dataset_is_a_line_and_exit_code_2(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    for name, text in (("none.nc", None), ("text.nc", "no"), ("notes.txt", "no")):
        if text:
            (tmp_path / name).write_text(text)
        assert main(["show", str(tmp_path / name)]) == 2
        printed = capsys.readouterr()
        assert printed.err.count("\n") == 1
        assert printed.err.startswith(f"octsim: {tmp_path / name}: ")
        assert printed.out == ""


def test_statuses_that_say_the_same_are_told_in_one_line() -> None:
    visible, dark = (flags(FringeStatus, np.array(codes)) for codes in ([0, 0], [0, 2]))
    given = {"first_status": visible, "status": dark, "other_status": visible}
    found = xr.Dataset(
        {name: ("x", *status) for name, status in given.items()}, attrs={"octsim_version": "1"}
    )
    _, *told = described(CATALOG["paths"], found)
    assert told == ["first_status, other_status: visible 2", "status: visible 1, no light 1"]


def test_a_status_is_counted_in_words_the_most_frequent_first() -> None:
    values, attributes = flags(FringeStatus, np.array([1, 0, 0, 0, 1, 2]))
    words = [one.name.lower().replace("_", " ") for one in FringeStatus]
    told = in_words(xr.DataArray(values, dims="x", attrs=attributes))
    assert told == f"{words[0]} 3, {words[1]} 2, {words[2]} 1"
    assert in_words(xr.DataArray(values[0], attrs=attributes)) == words[1]


def test_where_a_grid_has_nothing_that_is_said() -> None:
    values, attributes = flags(FringeStatus, np.array([0, -1, -1]))
    told = in_words(xr.DataArray(values, dims="x", attrs=attributes))
    assert told.startswith("not there 2, ")
    padded = xr.DataArray(np.array([0.0, np.nan]), dims="x", attrs=attributes)
    assert "not there 1" in in_words(padded)
