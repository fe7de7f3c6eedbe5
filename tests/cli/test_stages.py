"""A calibration and an expansion by one command, without the workflow."""

from pathlib import Path
from typing import Any

import pytest
import xarray as xr
import yaml
from made_runs import CALIBRATED

import octsim
from octsim.cli.main import main
from octsim.datasets.stage import Stage
from octsim.stages import in_memory


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, calibrated: xr.Dataset) -> Path:
    """Make a folder with a config and a series, of a calibration that is there."""
    monkeypatch.chdir(tmp_path)
    make = in_memory._make

    def made(row: Stage, *given: Any) -> xr.Dataset:
        return calibrated if row.name == "calibration" else make(row, *given)

    monkeypatch.setattr(in_memory, "_make", made)
    (tmp_path / "mine.yaml").write_text(yaml.safe_dump({**CALIBRATED, "expansion": {"rest": 4}}))
    rows = "".join(f"{i},{0.024 if i > 3 else 0.0}\n" for i in range(8))
    (tmp_path / "phases.csv").write_text(f"time,phase\n{rows}")
    return tmp_path


def test_a_calibration_is_written_and_told(
    folder: Path, capsys: pytest.CaptureFixture[str], calibrated: xr.Dataset
) -> None:
    assert main(["calibrate", "mine.yaml"]) == 0
    assert capsys.readouterr().out.startswith("calibration.nc: phase slope by Maxwell's equations")
    stored = octsim.read(folder / "calibration.nc", "calibration")
    assert stored["fixed_focus_phase_slope"].identical(calibrated["fixed_focus_phase_slope"])


def test_a_series_of_phases_is_turned_into_nanometres(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    command = ["expansion", "mine.yaml", "--series", "phases.csv", "--output", "mine.nc"]
    assert main(command) == 0
    assert capsys.readouterr().out.startswith("mine.nc: ")
    found = octsim.read(folder / "mine.nc", "expansion")
    assert float(found["expansion"][-1]) == pytest.approx(1.0, abs=0.1)


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["calibrate", "none.yaml"], "none.yaml: can't be read"),
        (["calibrate", "mine.yaml", "--threads", "0"], "--threads: 0 given; give 1 or more"),
        (["expansion", "mine.yaml"], "expansion.series: not given"),
        (["expansion", "mine.yaml", "--series", "none.csv"], "none.csv"),
    ],
)
def test_what_can_not_be_is_one_line(
    arguments: list[str], said: str, folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(arguments) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert said in line
    assert not list(folder.glob("*.nc"))
