"""A report goes with the run that it shows, and with no other."""

import zipfile
from pathlib import Path

import pytest
from made_runs import make

from octsim.archive.pack import pack
from octsim.archive.report_file import REPORT, is_report_of
from octsim.archive.run_folder import run_in
from octsim.config.models import Config
from octsim.datasets.files import read, write
from octsim.report.page import report


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    make(tmp_path / "tiny", scan=False)
    report(tmp_path / "tiny")
    return tmp_path / "tiny"


def packed(folder: Path, config: Config) -> tuple[list[str], str]:
    done = pack(folder, config)
    with zipfile.ZipFile(done.file) as archive:
        return archive.namelist(), "\n".join(done.remarks)


def test_a_report_is_packed_with_what_it_shows(folder: Path) -> None:
    names, said = packed(folder, run_in(folder).config)
    assert REPORT in names
    assert REPORT not in said


def test_a_report_of_other_datasets_is_left_out_and_why_is_said(folder: Path) -> None:
    run = run_in(folder)
    assert is_report_of(folder / REPORT, run)
    spectra = read(folder / "spectra.nc")
    write(spectra.assign(intensity=2 * spectra["intensity"]), folder / "spectra.nc")
    assert not is_report_of(folder / REPORT, run)
    names, said = packed(folder, run.config)
    assert REPORT not in names
    assert f"the archive goes without {REPORT}, which is of other datasets than these" in said
    report(folder)
    assert REPORT in packed(folder, run.config)[0]


def test_a_file_of_somebody_s_is_no_report(folder: Path) -> None:
    (folder / REPORT).write_bytes(b"\xff<p>mine</p>")
    names, said = packed(folder, run_in(folder).config)
    assert REPORT not in names
    assert "make it again by octsim report" in said
