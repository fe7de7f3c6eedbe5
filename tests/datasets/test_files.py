"""Datasets: every variable says what it is, files are whole, and bad ones are refused."""

import json
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

import octsim
from octsim.datasets import files as datasets

TINY = {
    "run": "tiny",
    "tracing": {"rays": 300},
    "focus_scan": {"focus": {"num": 7}},
    "focus_law": {"diameters": {"num": 3}, "fraction": {"num": 11}},
    "sweep": {"diameters": {"num": 9}},
}


@pytest.fixture(scope="module")
def stages() -> dict[str, xr.Dataset]:
    config = octsim.load_config(TINY)
    made = {"focus_scan": octsim.focus_scan(config), "focus_sweep": octsim.focus_sweep(config)}
    made["gaussian_fits"] = octsim.gaussian_fits(config, made["focus_sweep"])
    made["focus_law"] = octsim.focus_law(config, made["gaussian_fits"])
    made["detections"] = octsim.detections(config, made["focus_law"])
    made["spectra"] = octsim.spectra(config, made["detections"])
    made["paths"] = octsim.light_paths(config, made["detections"])
    made["fourier"] = octsim.fourier(config, made["spectra"])
    made["phase_slope"] = octsim.phase_slope(config, made["fourier"])
    return made


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
        assert octsim.load_config(json.loads(stored.attrs["config"])) == octsim.load_config(TINY)
        assert stored.attrs["octsim_version"]
        assert len(stored.attrs["source_digest"]) == 12
        assert f"results/tiny/{stage}.nc" in stored.attrs["creation_command"]
    xr.testing.assert_identical(datasets.read(file, stage), stages[stage])
    assert [path.name for path in tmp_path.iterdir()] == [file.name]


def test_the_same_dataset_is_the_same_bytes(stages: dict[str, xr.Dataset], tmp_path: Path) -> None:
    for name in ("a.nc", "b.nc"):
        datasets.write(stages["detections"], tmp_path / name)
    assert (tmp_path / "a.nc").read_bytes() == (tmp_path / "b.nc").read_bytes()


def test_detections_are_contiguous_ragged(stages: dict[str, xr.Dataset]) -> None:
    detected = stages["detections"]
    assert detected["rays_detected"].attrs["sample_dimension"] == "ray"
    assert detected["rays_detected"].sum() == detected.sizes["ray"]
    by_outcome = detected["outcomes"].sel(outcome="detected")
    assert np.array_equal(by_outcome, detected["rays_detected"])


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
    same = octsim.load_config(TINY, {"run": "other", "processing": {"window": "hann"}})
    xr.testing.assert_identical(datasets.read(file, "spectra", same), stages["spectra"])
    other = octsim.load_config(TINY, {"scene": {"gap": "6 nm"}, "spectrum": {"samples": 500}})
    with pytest.raises(octsim.DatasetError, match=r"another config \(its scene, spectrum differ"):
        datasets.read(file, "spectra", other)


def test_threads_change_no_bit(stages: dict[str, xr.Dataset]) -> None:
    config = octsim.load_config(TINY)
    for threads in (2, 5):
        detected = octsim.detections(config, stages["focus_law"], threads)
        xr.testing.assert_identical(detected, stages["detections"])
        xr.testing.assert_identical(octsim.focus_sweep(config, threads), stages["focus_sweep"])


def test_a_point_depends_on_itself_alone(stages: dict[str, xr.Dataset]) -> None:
    # the last four of the nine diameters on their own give the same spectra
    law = stages["focus_law"]
    part = octsim.load_config(TINY, {"sweep": {"diameters": {"start": "1.5 um", "num": 5}}})
    alone = octsim.spectra(part, octsim.detections(part, law))
    assert np.array_equal(alone["intensity"], stages["spectra"]["intensity"][4:])


def test_a_law_out_of_reach_stops_the_sweep_alone() -> None:
    config = octsim.load_config(TINY, {"focus_law": {"fraction": {"stop": 0.42}}})
    law = octsim.focus_law(config, octsim.gaussian_fits(config, octsim.focus_sweep(config)))
    assert np.isnan(law["slope"])
    with pytest.raises(octsim.OctsimError, match=r"sweep\.focus: 'law' given, but there is no law"):
        octsim.detections(config, law)
    given = octsim.load_config(TINY, {"sweep": {"focus": {"slope": 0.58, "intercept": "69 nm"}}})
    assert octsim.detections(given, law).sizes["diameter"] == 9


def test_a_law_beyond_the_objective_is_refused(stages: dict[str, xr.Dataset]) -> None:
    config = octsim.load_config(TINY)
    law = stages["focus_law"].assign(intercept=((), 400.0))
    with pytest.raises(octsim.OctsimError, match=r"objective\.focus_distance: 300\.0 um given"):
        octsim.detections(config, law)


def test_the_shares_of_all_paths_sum_to_one(stages: dict[str, xr.Dataset]) -> None:
    shares = stages["paths"]["share"].sum("path")
    assert np.allclose(shares, 1, atol=1e-12)
    assert list(stages["paths"]["path"].values[:3]) == ["PT CT CR CT PT", "PT CR PT", "PR"]


def test_the_paths_fields_sum_to_the_spectrum(stages: dict[str, xr.Dataset]) -> None:
    paths, spectra = stages["paths"], stages["spectra"]
    fields = paths["field_amplitude"] * np.exp(1j * paths["field_phase"].fillna(0))
    k = spectra["wavenumber"]
    middle = float(k[0] + k[-1]) / 2
    expected = spectra["intensity"].interp(wavenumber=middle, method="cubic")
    assert np.allclose(np.abs(fields.sum("path")) ** 2, expected, rtol=1e-3)


def test_the_scheme_paths_goes_through_all_stages() -> None:
    config = octsim.load_config(
        {
            "tracing": {"preset": "draft"},
            "focus_scan": {"focus": {"num": 4}},
            "sweep": {"diameters": {"num": 9}, "focus": {"slope": 0.58, "intercept": "69 nm"}},
        }
    )
    detected = octsim.detections(config)
    spectra = octsim.spectra(config, detected)
    assert (spectra["accuracy_status"] == 0).all()
    assert (spectra["intensity_error"] < config.tracing.accuracy).all()
    assert (detected["segments_traced"] < 5000).all()
    rays = octsim.load_config(config.to_dict(), {"tracing": {"scheme": "vogel", "rays": 3000}})
    slope = octsim.phase_slope(
        rays, octsim.fourier(rays, octsim.spectra(rays, octsim.detections(rays)))
    )
    ours = octsim.phase_slope(config, octsim.fourier(config, spectra))
    assert np.allclose(ours["phase_slope"], slope["phase_slope"], atol=0.2)
    counted = octsim.focus_scan(config)["rays_detected"]
    assert np.array_equal(counted, octsim.focus_scan(rays)["rays_detected"])


def test_a_diameter_does_not_depend_on_its_sweep() -> None:
    base = {
        "tracing": {"preset": "standard"},
        "sweep": {"focus": {"slope": 0.58, "intercept": "69 nm"}},
    }
    many = octsim.load_config(
        base, {"sweep": {"diameters": {"start": "1 um", "stop": "1.5 um", "num": 6}}}
    )
    few = octsim.load_config(
        base, {"sweep": {"diameters": {"start": "1.3 um", "stop": "1.5 um", "num": 3}}}
    )
    all_of, some = (octsim.spectra(c, octsim.detections(c, threads=2)) for c in (many, few))
    for diameter in (1.4, 1.5):
        one, other = (s.sel(diameter=diameter, method="nearest") for s in (all_of, some))
        if float(one["diameter"]) == float(other["diameter"]):
            assert np.array_equal(one["intensity"], other["intensity"])
    assert float(all_of["diameter"][-1]) == float(some["diameter"][-1])
