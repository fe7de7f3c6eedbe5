"""`octsim import`: a lab's files become measured.nc, and what was understood is said."""

from pathlib import Path

import numpy as np
import pytest
from lab import recorded, written

import octsim
from octsim.cli.main import main


def given(folder: Path) -> list[str]:
    section = written(folder, recorded())
    options = {
        "--axis": section["axis"]["wavelength"], "--dark": section["dark"],
        "--reference": section["reference"], "--rate": "1 kHz",
        "--output": str(folder / "measured.nc"),
    }  # fmt: skip
    return ["import", section["spectra"], *(part for pair in options.items() for part in pair)]


def test_files_are_read_without_a_config(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    assert main(given(tmp_path)) == 0
    said = capsys.readouterr()
    assert "60 spectra of 300 samples, 650 to 900 nm" in said.out
    assert "60 with a phase" in said.out
    assert "Traceback" not in said.err
    found = octsim.read(tmp_path / "measured.nc")
    # where the highest peak is
    assert float(found["fringe_depth"]) == pytest.approx(4.0, abs=0.05)
    assert np.isfinite(found["fringe_phase"]).all()


def test_a_config_says_the_rest(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    config = tmp_path / "mine.yaml"
    config.write_text(
        "spectrum: {wavelength: {min: 700 nm, max: 850 nm}}\nprocessing: {depth: 4 um}\n",
        encoding="utf-8",
    )
    assert main([*given(tmp_path), "--config", str(config)]) == 0
    assert "fitted from 700" in capsys.readouterr().out


def test_what_can_t_be_read_is_one_line_and_leaves_what_was_there(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    arguments = given(tmp_path)
    (tmp_path / "measured.nc").write_text("mine", encoding="utf-8")
    (tmp_path / "spectra.npy").write_bytes(b"\x93NUMPY\x01\x00")
    assert main(arguments) == 2
    said = capsys.readouterr()
    assert said.err.count("\n") == 1
    assert "spectra.npy" in said.err
    assert (tmp_path / "measured.nc").read_text(encoding="utf-8") == "mine"


def test_a_file_that_is_read_is_never_written(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    arguments = given(tmp_path)
    before = (tmp_path / "spectra.npy").read_bytes()
    assert main([*arguments[:-1], str(tmp_path / "spectra.npy")]) == 2
    assert "--output" in capsys.readouterr().err
    assert (tmp_path / "spectra.npy").read_bytes() == before
