"""A run's folder: its datasets follow from one config, or are refused."""

import shutil
from pathlib import Path

import pytest
from made_runs import make

import octsim
from octsim.archive.run_folder import run_in


def test_a_run_is_its_datasets_figures_and_config(tmp_path: Path) -> None:
    make(tmp_path)
    config = make(tmp_path, scan=False)
    (tmp_path / "figures").mkdir()
    (tmp_path / "figures" / "figure_6.png").write_bytes(b"drawn")
    run = run_in(tmp_path)
    assert run.config == config
    assert list(run.datasets) == ["focus_scan", "phase_slope", "spectra"]
    assert [figure.name for figure in run.figures] == ["figure_6.png"]


def test_the_config_is_that_of_what_was_made_last(tmp_path: Path) -> None:
    make(tmp_path, scan=False)
    edited = make(tmp_path, {"focus_scan": {"diameter": "2.1 um"}})
    assert run_in(tmp_path).config == edited


def test_datasets_of_two_configs_are_refused_with_the_keys_that_differ(tmp_path: Path) -> None:
    make(tmp_path)
    make(tmp_path, {"scene": {"gap": "9 nm"}}, scan=False)
    with pytest.raises(octsim.DatasetError, match=r"focus_scan\.nc: made .*\(its scene differ\)"):
        run_in(tmp_path)


def test_a_dataset_of_another_run_is_refused(tmp_path: Path) -> None:
    make(tmp_path)
    make(tmp_path, {"run": "other"}, scan=False)
    with pytest.raises(octsim.DatasetError, match=r"focus_scan\.nc: .*\(its run differ\)"):
        run_in(tmp_path)


def test_a_folder_without_datasets_and_a_renamed_dataset_are_refused(tmp_path: Path) -> None:
    with pytest.raises(octsim.DatasetError, match="no datasets; give a folder as results/thesis"):
        run_in(tmp_path)
    make(tmp_path)
    shutil.move(tmp_path / "focus_scan.nc", tmp_path / "spectra.nc")
    with pytest.raises(
        octsim.DatasetError, match=r"spectra\.nc: not octsim's dataset of the stage"
    ):
        run_in(tmp_path)
