"""Where a lab's dark and reference are: in files of their own, or beside the spectra in one."""

from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest
import xarray as xr
from lab import DARK, NM, SOURCE, Lab, recorded, written

from octsim.base.errors import OctsimError
from octsim.cli.main import main
from octsim.config.load import load_config
from octsim.config.models import Config
from octsim.config.source import SourceTable
from octsim.studies.measured.source_file import write_source
from octsim.studies.measured.study import doubts, measured


def config_of(section: dict[str, Any]) -> Config:
    return load_config({"measured": section, "processing": {
        "depth": "4 um", "sinusoid": {"weights": "shot", "envelope": "common"},
    }})  # fmt: skip


@pytest.fixture
def lab() -> Lab:
    return recorded()


def in_one(folder: Path, lab: Lab) -> dict[str, Any]:
    """Write all that was recorded into one HDF5 file; return the section that names it."""
    section = written(folder, lab)
    with h5py.File(folder / "run.h5", "w") as file:
        for name in ("spectra", "dark", "reference"):
            file[f"raw/{name}"] = getattr(lab, name).astype(np.uint16)
    return section | {
        "spectra": str(folder / "run.h5"), "at": "/raw/spectra",
        "dark": {"at": "/raw/dark"}, "reference": {"at": "/raw/reference"},
    }  # fmt: skip


def test_a_file_that_holds_all_is_read_as_three_are(tmp_path: Path, lab: Lab) -> None:
    three = measured(config_of(written(tmp_path, lab)))
    one = measured(config_of(in_one(tmp_path, lab)))
    xr.testing.assert_identical(one.drop_attrs(), three.drop_attrs())


def test_a_name_in_another_file_than_the_spectra_is_found(tmp_path: Path, lab: Lab) -> None:
    three = measured(config_of(written(tmp_path, lab)))
    inside = {"file": str(tmp_path / "run.h5"), "at": "/raw/dark"}
    in_one(tmp_path, lab)
    two = measured(config_of(written(tmp_path, lab) | {"dark": inside}))
    xr.testing.assert_identical(two.drop_attrs(), three.drop_attrs())


def test_a_dark_that_was_subtracted_is_not_asked_for(tmp_path: Path, lab: Lab) -> None:
    net = lab._replace(spectra=lab.spectra - DARK, reference=lab.reference - DARK)
    section = written(tmp_path, lab)
    for name in ("spectra", "reference"):
        np.save(tmp_path / f"{name}.npy", getattr(net, name))
    known = measured(config_of(section | {"dark": "subtracted"}))
    unknown = measured(config_of(section | {"dark": None}))
    assert "dark: subtracted before" in known.attrs["understood"].splitlines()
    assert not any(line.startswith("measured.dark") for line in doubts(known))
    assert any(line.startswith("measured.dark: not given") for line in doubts(unknown))
    np.testing.assert_array_equal(known["fringe_phase"], unknown["fringe_phase"])


@pytest.mark.parametrize(
    ("key", "given", "said"),
    [
        ("dark", {"at": "/raw/spectra"}, "which is measured.at too; give the name"),
        ("reference", {"at": "/raw/none"}, "/raw/none"),
        ("dark", {"file": "dark.h5"}, "measured.dark: {file: dark.h5} given; it should be"),
        ("reference", {"at": "a", "unit": "nm"}, "given; it should be a file, as reference.csv"),
        ("dark", ["a"], "measured.dark: [a] given; it should be a file, as dark.csv"),
        ("dark", {"at": ""}, "measured.dark.at: "),
        ("reference", "", "measured.reference: "),
    ],
)
def test_a_place_that_is_none_is_refused_in_a_line(
    tmp_path: Path, lab: Lab, key: str, given: object, said: str
) -> None:
    with pytest.raises(OctsimError) as refused:
        measured(config_of(in_one(tmp_path, lab) | {key: given}))
    assert said in str(refused.value)
    assert "\n" not in str(refused.value)


def test_the_reference_becomes_the_source_of_a_simulation(tmp_path: Path, lab: Lab) -> None:
    section = in_one(tmp_path, lab)
    write_source(config_of(section), tmp_path / "source.csv")
    config = load_config({
        "measured": section, "spectrum": {"source": str(tmp_path / "source.csv")}
    })  # fmt: skip
    assert isinstance(config.spectrum.source, SourceTable)
    table = config.spectrum.source.table
    np.testing.assert_allclose(table.wavelength, NM[::-1] / 1e3, rtol=1e-8)
    np.testing.assert_allclose(table.power, (SOURCE / SOURCE.max())[::-1], atol=0.01)
    assert not any("spectrum.source" in line for line in doubts(measured(config)))


def test_import_writes_the_source_and_over_no_file_that_it_reads(
    tmp_path: Path, lab: Lab, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    written(tmp_path, lab)
    command = ["import", "spectra.npy", "--axis", "axis.csv", "--rate", "1 kHz"]
    of_all = [*command, "--dark", "dark.npy", "--reference", "reference.npy", "--source"]
    assert main([*of_all, "source.csv"]) == 0
    assert "source.csv: the source, for spectrum.source" in capsys.readouterr().out
    assert (tmp_path / "source.csv").read_text().startswith("wavelength (nm),power\n650,")
    assert main([*of_all, "axis.csv"]) == 2
    assert capsys.readouterr().err.startswith("octsim: --source: axis.csv given, which is measured")
    assert main([*of_all, "same.nc", "--output", "same.nc"]) == 2
    assert capsys.readouterr().err.startswith("octsim: --source: same.nc given, which is --output")
    assert main([*command, "--source", "other.csv"]) == 2
    assert capsys.readouterr().err.startswith("octsim: measured.reference: not given, and --source")
