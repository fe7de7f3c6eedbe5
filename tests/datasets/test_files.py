"""Datasets: every variable says what it is, files are whole, and bad ones are refused."""

import json
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from made_runs import WHOLE

import octsim
from octsim.datasets import files as datasets

CONTRACT: dict[str, dict[str, tuple[str, ...]]] = {
    "focus_scan": {
        "intensity": ("focus",),
        "rays_detected": ("focus",),
        "intensity_error": ("focus",),
        "accuracy_status": ("focus",),
    },
    "focus_sweep": {"intensity": ("diameter", "fraction"), "focus": ("diameter", "fraction")},
    "gaussian_fits": dict.fromkeys(
        [
            "centre", "width", "amplitude", "offset", "centre_standard_error",
            "width_standard_error", "amplitude_standard_error", "offset_standard_error",
            "residual", "status",
        ],
        ("diameter",),
    ),
    "focus_law": dict.fromkeys(
        ["slope", "intercept", "slope_standard_error", "intercept_standard_error"], ()
    ),
    "detections": {
        "amplitude": ("ray",),
        "rough_amplitude": ("ray",),
        "path_code": ("ray",),
        "optical_path_length": ("ray",),
        "rays_detected": ("diameter",),
        "segments_traced": ("diameter",),
        "accuracy_status": ("diameter",),
    },
    "spectra": {
        "intensity": ("diameter", "wavenumber"),
        "intensity_error": ("diameter",),
        "accuracy_status": ("diameter",),
        "focus": ("diameter",),
    },
    "paths": {
        "field_amplitude": ("path", "diameter"),
        "field_phase": ("path", "diameter"),
        "mean_optical_path_length": ("path", "diameter"),
        "share": ("path", "diameter"),
        "path_rays": ("path", "diameter"),
    },
    "fourier": {
        "magnitude": ("diameter", "component"),
        "phase": ("diameter", "component"),
        "depth": ("component",),
    },
    "phase_slope": {
        "phase_slope": ("diameter",),
        "strongest_component": ("diameter",),
        "ideal_phase_slope": ("diameter",),
        "component_phase_slope": ("diameter", "component"),
        "predicted_phase_slope": (),
    },
}  # fmt: skip


@pytest.mark.parametrize("stage", CONTRACT)
def test_a_stage_holds_what_notebooks_rely_on(stage: str, stages: dict[str, xr.Dataset]) -> None:
    for name, dimensions in CONTRACT[stage].items():
        assert stages[stage][name].dims == dimensions, name


@pytest.mark.parametrize("stage", CONTRACT)
def test_a_stored_dataset_explains_itself_and_reads_back(
    stage: str, stages: dict[str, xr.Dataset], tmp_path: Path
) -> None:
    file = tmp_path / f"{stage}.nc"
    datasets.write(stages[stage], file)
    with xr.open_dataset(file) as stored:
        for name, variable in stored.variables.items():
            assert variable.attrs["units"], name
            assert variable.attrs["long_name"], name
            assert variable.dtype != np.float32, name
        assert octsim.load_config(json.loads(stored.attrs["config"])) == octsim.load_config(WHOLE)
        assert stored.attrs["octsim_version"]
        assert len(stored.attrs["source_digest"]) == 12
        assert f"results/whole/{stage}.nc" in stored.attrs["creation_command"]
    xr.testing.assert_identical(datasets.read(file, stage), stages[stage])
    assert [path.name for path in tmp_path.iterdir()] == [file.name]


def test_the_same_dataset_is_the_same_bytes(stages: dict[str, xr.Dataset], tmp_path: Path) -> None:
    for name in ("a.nc", "b.nc"):
        datasets.write(stages["detections"], tmp_path / name)
    assert (tmp_path / "a.nc").read_bytes() == (tmp_path / "b.nc").read_bytes()


def test_a_failed_write_leaves_what_was_there(
    stages: dict[str, xr.Dataset], tmp_path: Path
) -> None:
    file = tmp_path / "spectra.nc"
    datasets.write(stages["spectra"], file)
    before = file.read_bytes()
    bad = stages["spectra"].assign(intensity=("wavenumber", np.array([object()] * 1000)))
    with pytest.raises((TypeError, ValueError)):
        datasets.write(bad, file)
    assert file.read_bytes() == before
    assert [path.name for path in tmp_path.iterdir()] == [file.name]


def test_a_folder_that_cannot_be_written_is_named_in_one_line(
    stages: dict[str, xr.Dataset], tmp_path: Path
) -> None:
    (tmp_path / "results").write_text("a file where the folder should be")
    with pytest.raises(octsim.OctsimError, match=r"spectra\.nc: can't be written") as caught:
        datasets.write(stages["spectra"], tmp_path / "results" / "spectra.nc")
    assert "\n" not in str(caught.value)


def test_missing_damaged_and_foreign_files_are_refused_in_one_line(
    stages: dict[str, xr.Dataset], tmp_path: Path
) -> None:
    file = tmp_path / "spectra.nc"
    with pytest.raises(octsim.DatasetError, match="not there; run the stage spectra first"):
        datasets.read(file, "spectra")
    datasets.write(stages["spectra"], file)
    whole = file.read_bytes()
    for damaged in (whole[: len(whole) // 2], b"", b"text", whole[:100]):
        file.write_bytes(damaged)
        with pytest.raises(octsim.DatasetError, match="can't be read") as caught:
            datasets.read(file, "spectra")
        assert "\n" not in str(caught.value)
    xr.Dataset({"x": 1}).to_netcdf(tmp_path / "foreign.nc")
    with pytest.raises(octsim.DatasetError, match="not octsim's dataset of the stage spectra"):
        datasets.read(tmp_path / "foreign.nc", "spectra")
    datasets.write(stages["fourier"], file)
    with pytest.raises(octsim.DatasetError, match="not octsim's dataset of the stage spectra"):
        datasets.read(file, "spectra")


def test_a_dataset_of_another_config_is_refused(
    stages: dict[str, xr.Dataset], tmp_path: Path
) -> None:
    file = tmp_path / "spectra.nc"
    datasets.write(stages["spectra"], file)
    same = octsim.load_config(WHOLE, {"run": "other", "processing": {"window": "hann"}})
    xr.testing.assert_identical(datasets.read(file, "spectra", same), stages["spectra"])
    other = octsim.load_config(WHOLE, {"scene": {"gap": "6 nm"}, "spectrum": {"samples": 500}})
    with pytest.raises(octsim.DatasetError, match=r"another config \(its scene, spectrum differ"):
        datasets.read(file, "spectra", other)
