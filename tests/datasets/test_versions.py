"""Files of an older octsim are read as today's, or refused with the version that can."""

import json
from pathlib import Path

import pytest
import xarray as xr

import octsim
from octsim.base.provenance import environment
from octsim.datasets.files import write
from octsim.datasets.versions import SCHEMA, recorded_config
from octsim.phase.fringe_status import FringeStatus

OLD = Path(__file__).parents[1] / "old"
TINY = {
    "run": "tiny",
    "tracing": {"rays": 200},
    "focus_scan": {"focus": {"num": 5}},
    "focus_law": {"diameters": {"num": 3}, "fraction": {"num": 9}},
    "spectrum": {"samples": 64},
    "sweep": {"diameters": {"num": 9}},
}


@pytest.fixture
def made(tmp_path: Path) -> Path:
    config = octsim.load_config(TINY)
    write(octsim.focus_scan(config), tmp_path / "focus_scan.nc")
    return tmp_path / "focus_scan.nc"


def test_a_dataset_says_its_schema_and_what_it_was_computed_with(made: Path) -> None:
    attributes = octsim.read(made).attrs
    assert attributes["schema_version"] == SCHEMA
    assert json.loads(attributes["environment"]) == environment()
    assert {"python", "numpy", "numba", "hdf5", "processor"} <= set(environment())


@pytest.mark.parametrize("file", ["0.1.0/spectra.nc", "0.1.0/phase_slope.nc", "early/fourier.nc"])
def test_files_of_0_1_0_are_read_with_every_key_of_today(file: str) -> None:
    old = octsim.read(OLD / file)
    recorded = json.loads(old.attrs["config"])
    assert old.attrs["schema_version"] == SCHEMA
    assert set(recorded) == set(octsim.Config().to_dict())
    config = octsim.load_config(TINY)
    assert octsim.load_config(recorded) == config
    with xr.open_dataset(OLD / file) as stored:
        # one variable had the name of a dimension
        named = {"component": "strongest_component"} if "phase_slope" in file else {}
        xr.testing.assert_equal(
            old.drop_vars("wavelength", errors="ignore").reset_coords(),
            stored.rename_vars(named).reset_coords(),
        )


def test_a_stage_goes_on_from_a_file_of_0_1_0() -> None:
    config = octsim.load_config(TINY)
    slopes = octsim.phase_slope(
        config, octsim.fourier(config, octsim.read(OLD / "0.1.0/spectra.nc"))
    )
    then = octsim.read(OLD / "0.1.0/phase_slope.nc")
    # 0.1.0 gave components of rounding alone a phase
    known = slopes["component_phase_slope"].notnull()
    assert known[:, 1:].all()
    then["component_phase_slope"] = then["component_phase_slope"].where(known)
    assert (slopes["fringe_status"] == FringeStatus.VISIBLE).all()  # which 0.1.0 did not ask
    asked = [name for name in slopes.data_vars if str(name).endswith("_status")]
    xr.testing.assert_allclose(slopes.drop_vars(asked), then, rtol=1e-9)


def test_a_file_that_lacks_what_stages_read_is_refused_with_the_version_that_can() -> None:
    with pytest.raises(octsim.DatasetError) as caught:
        octsim.read(OLD / "early/spectra.nc")
    said = str(caught.value)
    assert "written by octsim 0.1.0" in said
    assert "it lacks intensity_error, accuracy_status" in said
    assert "read it with octsim 0.1.0" in said
    assert "\n" not in said


def rewrite(file: Path, **attributes: object) -> None:
    dataset = xr.load_dataset(file)
    write(dataset.assign_attrs(attributes), file)


def test_a_file_of_a_later_octsim_is_refused_with_that(made: Path) -> None:
    rewrite(made, schema_version=SCHEMA + 1, octsim_version="9.1")
    with pytest.raises(
        octsim.DatasetError, match=rf"by octsim 9\.1, as schema {SCHEMA + 1}; .* octsim 9\.1 or"
    ):
        octsim.read(made)


@pytest.mark.parametrize(
    ("attributes", "message"),
    [
        ({"schema_version": "soon"}, f"as schema {SCHEMA + 1}"),
        ({"schema_version": float("inf")}, f"as schema {SCHEMA + 1}"),
        (
            {"schema_version": 7, "octsim_version": "1\n\x1b[31mX"},
            r"octsim 1\\n\\x1b\[31mX, as schema",
        ),
        ({"config": "[" * 100_000}, "it has no config"),
        ({"stage": [1, 2]}, "not octsim's dataset of the stage focus_scan"),
        ({"config": "{"}, "it has no config"),
        ({"config": json.dumps({"scene": {"slide": 1}})}, "scene.slide: unknown key"),
        ({"stage": "dreams"}, "not octsim's dataset of the stage focus_scan"),
    ],
)
def test_a_file_that_explains_itself_wrongly_is_refused_in_a_line(
    attributes: dict[str, object], message: str, made: Path
) -> None:
    rewrite(made, **attributes)
    with pytest.raises(octsim.DatasetError, match=message) as caught:
        octsim.read(made, "focus_scan")
    assert "\n" not in str(caught.value)


def test_a_file_of_something_else_is_refused(tmp_path: Path) -> None:
    write(xr.Dataset({"a": 1.0}), tmp_path / "notes.nc")
    with pytest.raises(octsim.DatasetError, match="not a dataset of octsim"):
        octsim.read(tmp_path / "notes.nc")


def test_a_calibration_from_before_there_was_its_scheme_was_by_light_paths() -> None:
    config = octsim.Config().to_dict()
    del config["calibration"]["scheme"]
    for stage, scheme in (("calibration", "paths"), ("spectra", None)):
        attributes = {"stage": stage, "config": json.dumps(config)}
        assert recorded_config(attributes)["calibration"]["scheme"] == scheme
