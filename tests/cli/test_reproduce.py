"""What is recorded is made anew elsewhere from its config alone; what differs is named."""

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr

import octsim
from octsim.archive.pack import pack
from octsim.archive.run_folder import run_in
from octsim.cli.main import main
from octsim.config.following import calibration_diameters
from octsim.datasets.files import write
from octsim.datasets.versions import SCHEMA

ROOT = Path(__file__).parents[2]
OLD = Path(__file__).parents[1] / "old" / "0.1.0"
TINY: dict[str, Any] = {
    "run": "tiny",
    "tracing": {"rays": 200},
    "focus_scan": {"focus": {"num": 5}},
    "spectrum": {"samples": 64},
    "sweep": {"diameters": {"num": 9}, "focus": {"slope": 0.58, "intercept": "69 nm"}},
}
CALIBRATED: dict[str, Any] = {
    "calibration": {
        "diameters": {"start": "1.3 um", "stop": "1.5 um", "num": 8},
        "estimator": "fft",
        "scheme": "paths",
    },
    "expansion": {"series": "measured/phases.csv", "rest": 3},
}
SERIES = "time,phase,phase_error\n0,0,1e-3\n1,1e-3,1e-3\n2,-1e-3,1e-3\n3,0.01,1e-3\n"


def reproduce(file: Path, folder: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-m", "octsim", "reproduce", str(file), str(folder)]
    return subprocess.run(
        [*command, *arguments], cwd=folder.parent, capture_output=True, text=True, check=False,
        env=os.environ,
    )  # fmt: skip


@pytest.fixture(scope="module")
def tiny(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Make some datasets of a run without the workflow."""
    folder = tmp_path_factory.mktemp("tiny")
    config = octsim.load_config(TINY)
    spectra = octsim.spectra(config, octsim.detections(config))
    write(octsim.focus_scan(config), folder / "focus_scan.nc")
    write(spectra, folder / "spectra.nc")
    write(octsim.phase_slope(config, octsim.fourier(config, spectra)), folder / "phase_slope.nc")
    return folder


def rewritten(file: Path, to: Path, edit: Callable[[xr.Dataset], None]) -> Path:
    dataset = xr.load_dataset(file)
    edit(dataset)
    write(dataset, to / file.name)
    return to / file.name


def with_config(change: Callable[[dict[str, Any]], None]) -> Callable[[xr.Dataset], None]:
    def edit(dataset: xr.Dataset) -> None:
        config = json.loads(dataset.attrs["config"])
        change(config)
        dataset.attrs["config"] = json.dumps(config)

    return edit


def files_in(folder: Path) -> set[str]:
    return {str(path.relative_to(folder)) for path in folder.rglob("*") if path.is_file()}


def said(done: subprocess.CompletedProcess[str]) -> str:
    """Return the one line that a failure is, after what it is about to do."""
    assert done.returncode == 2, done.stdout + done.stderr
    assert done.stdout == ""
    *begun, line = done.stderr.splitlines()
    assert all(one.startswith("octsim: making ") for one in begun)
    return line


def test_a_run_is_made_anew_to_the_same_bits(tiny: Path, tmp_path: Path) -> None:
    done = reproduce(tiny, tmp_path / "again", "--tolerance", "0", "--cores", "1")
    assert done.returncode == 0, done.stdout + done.stderr
    assert done.stdout.splitlines()[-1] == "the same: every number within 0"
    assert files_in(tmp_path) >= {
        f"again/{name}" for name in ("config.json", "snakemake.log", "results/tiny/phase_slope.nc")
    }
    # one that lies in between is made for what is recorded, which alone is compared
    assert (tmp_path / "again" / "results" / "tiny" / "detections.nc").is_file()
    assert "  detections.nc" not in done.stdout
    assert "versions, A -> B\n  none" in done.stdout
    assert "config, A -> B\n  none" in done.stdout


def test_an_archive_is_made_anew_and_compared_with_what_was_made(
    tiny: Path, tmp_path: Path
) -> None:
    archive = tmp_path / "tiny.zip"
    pack(tiny, run_in(tiny).config, archive)
    done = reproduce(archive, tmp_path / "again", "--tolerance", "0", "--cores", "1")
    assert done.returncode == 0, done.stdout + done.stderr
    assert done.stdout.startswith(f"A: {archive} (run tiny)\n")
    assert done.stdout.splitlines()[-1] == "the same: every number within 0"
    found = octsim.compare(archive, tmp_path / "again" / "results" / "tiny", 0)
    assert [dataset.stage for dataset in found.datasets] == ["focus_scan", "phase_slope", "spectra"]
    assert not any(dataset.differs(0) for dataset in found.datasets)
    assert found.config == found.versions == ()
    body = bytearray(archive.read_bytes())
    body[len(body) // 2] ^= 1
    archive.write_bytes(body)
    assert "tiny.zip: " in said(reproduce(archive, tmp_path / "never"))
    assert not (tmp_path / "never").exists()


def test_what_was_interrupted_goes_on_in_its_folder_and_no_other_does(
    tiny: Path, tmp_path: Path
) -> None:
    file, folder = tiny / "focus_scan.nc", tmp_path / "again"
    command = [sys.executable, "-m", "octsim", "reproduce", str(file), str(folder)]
    begun = subprocess.Popen(
        command, start_new_session=True, text=True,
        stdout=subprocess.PIPE, stderr=subprocess.PIPE,
    )  # fmt: skip
    while not (folder / "snakemake.log").exists():
        assert begun.poll() is None
        time.sleep(0.05)
    os.killpg(begun.pid, signal.SIGINT)
    _, told = begun.communicate()
    assert begun.returncode == 130
    assert told.splitlines()[-1] == "octsim: interrupted; the same command goes on from here"
    other = rewritten(
        file, tmp_path / "other", with_config(lambda config: config["scene"].update(gap="9 nm"))
    )
    assert "again: not an empty folder" in said(reproduce(other, folder))
    done = reproduce(file, folder, "--cores", "1")
    assert done.returncode == 0, done.stdout + done.stderr


@pytest.mark.parametrize(
    ("recorded", "arguments"),
    [
        (".", ["--only", "focus_scan"]),
        pytest.param("focus_scan.nc", [], marks=pytest.mark.trial),
    ],
)
def test_one_file_and_chosen_stages_are_made_anew_alone(
    recorded: str, arguments: list[str], tiny: Path, tmp_path: Path
) -> None:
    done = reproduce(tiny / recorded, tmp_path / "again", "--cores", "1", *arguments)
    assert done.returncode == 0, done.stdout + done.stderr
    made = [path.name for path in (tmp_path / "again" / "results" / "tiny").glob("*.nc")]
    assert made == ["focus_scan.nc"]


def test_stages_that_are_not_recorded_are_not_made_anew(tiny: Path, tmp_path: Path) -> None:
    assert "but there is focus_scan, phase_slope, spectra" in said(
        reproduce(tiny, tmp_path / "none", "--only", "paths")
    )


def test_a_wrong_value_is_named(tiny: Path, tmp_path: Path) -> None:
    def edit(dataset: xr.Dataset) -> None:
        dataset["intensity"][2] *= 1 + 1e-6

    wrong = rewritten(tiny / "focus_scan.nc", tmp_path, edit)
    done = reproduce(wrong, tmp_path / "again", "--cores", "1")
    assert done.returncode == 1
    marked = [line.split() for line in done.stdout.splitlines() if line.startswith("*")]
    assert [cells[1] for cells in marked] == ["intensity"]
    assert 1e-8 < float(marked[0][2]) < 1.01e-6
    assert done.stdout.splitlines()[-1] == "different: focus_scan.intensity"


def test_another_library_and_version_are_named_where_all_is_within_the_tolerance(
    tiny: Path, tmp_path: Path
) -> None:
    def edit(dataset: xr.Dataset) -> None:
        dataset["intensity"][2] *= 1 + 1e-6
        libraries = json.loads(dataset.attrs["environment"]) | {"numpy": "1.0"}
        dataset.attrs |= {"environment": json.dumps(libraries), "octsim_version": "0.1.9"}

    other = rewritten(tiny / "focus_scan.nc", tmp_path, edit)
    done = reproduce(other, tmp_path / "again", "--cores", "1", "--tolerance", "1e-5")
    assert done.returncode == 0, done.stdout + done.stderr
    assert f"  octsim: 0.1.9 -> {octsim.__version__}\n" in done.stdout
    assert f"  numpy: 1.0 -> {np.__version__}\n" in done.stdout


def test_a_file_of_0_1_0_is_made_anew(tmp_path: Path) -> None:
    done = reproduce(OLD / "phase_slope.nc", tmp_path / "again", "--cores", "1")
    assert done.returncode == 0, done.stdout + done.stderr
    assert f"  octsim: 0.1.0 -> {octsim.__version__}\n" in done.stdout
    assert f"  schema: 0 -> {SCHEMA}\n" in done.stdout
    assert "  libraries: not recorded -> python" in done.stdout


def test_nothing_is_written_outside_the_folder_nor_run_from_the_file(
    tiny: Path, tmp_path: Path
) -> None:
    outside = tmp_path / "outside"
    outside.mkdir()
    (outside / "series.csv").write_text(SERIES)

    def change(config: dict[str, Any]) -> None:
        config["cache"] = {"file": str(outside / "points"), "gigabytes": 1.0}
        config["expansion"]["series"] = str(outside / "series.csv")

    def edit(dataset: xr.Dataset) -> None:
        with_config(change)(dataset)
        dataset.attrs["creation_command"] = f"touch {outside / 'ran'}"

    file = rewritten(tiny / "focus_scan.nc", tmp_path, edit)
    before = files_in(tmp_path), files_in(ROOT / "octsim") | files_in(ROOT / "workflow")
    done = reproduce(file, tmp_path / "again", "--cores", "1")
    assert done.returncode == 0, done.stdout + done.stderr
    new = files_in(tmp_path) - before[0]
    assert new
    assert all(name.startswith("again/") for name in new)
    code = files_in(ROOT / "octsim") | files_in(ROOT / "workflow")
    assert {name for name in code - before[1] if "__pycache__" not in name} == set()
    assert (tmp_path / "again" / ".octsim" / "points" / "octsim-points.json").is_file()


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda c: c.update(run="../../x"), "run: '../../x' given; it should be a plain name"),
        (lambda c: c.update(run="/x"), "run: '/x' given"),
        (lambda c: c.update(grid={"run": ["../x", "../y"]}), "run"),
        (lambda c: c.update(grid={"cache.file": ["/x", "/y"]}), "cache.file"),
        (lambda c: c["objective"].update(numerical_aperture=1.6), "numerical_aperture"),
    ],
)
def test_a_config_that_is_refused_is_one_line_and_nothing_is_made(
    change: Callable[[dict[str, Any]], None], message: str, tiny: Path, tmp_path: Path
) -> None:
    file = rewritten(tiny / "focus_scan.nc", tmp_path, with_config(change))
    assert message in said(reproduce(file, tmp_path / "again"))
    assert files_in(tmp_path) == {"focus_scan.nc"}


def test_a_file_that_is_none_of_ours_is_one_line_and_nothing_is_made(
    tiny: Path, tmp_path: Path
) -> None:
    def future(dataset: xr.Dataset) -> None:
        dataset.attrs |= {"schema_version": SCHEMA + 1, "octsim_version": "9.1"}

    def strange(dataset: xr.Dataset) -> None:
        dataset.attrs["stage"] = "../../x"

    (tmp_path / "full").mkdir()
    (tmp_path / "full" / "mine").write_text("mine")
    write(xr.Dataset({"a": 1.0}), tmp_path / "foreign.nc")
    (tmp_path / "damaged.nc").write_bytes((tiny / "spectra.nc").read_bytes()[:3000])
    later = rewritten(tiny / "focus_scan.nc", tmp_path / "later", future)
    stage = rewritten(tiny / "focus_scan.nc", tmp_path / "stage", strange)
    before = files_in(tmp_path)
    again = tmp_path / "again"
    for file, folder, message in (
        (tmp_path / "foreign.nc", again, "not a dataset of octsim"),
        (tmp_path / "damaged.nc", again, "damaged.nc: can't be read"),
        (tmp_path / "none.nc", again, "none.nc: not there"),
        (later, again, f"written by octsim 9.1, as schema {SCHEMA + 1}"),
        (stage, again, "of the stage '../../x', which this octsim lacks"),
        (tiny, tmp_path / "full", "full: not an empty folder"),
    ):
        assert message in said(reproduce(file, folder))
    assert files_in(tmp_path) == before
    command = [sys.executable, "-m", "octsim", "reproduce", str(tiny)]
    without = subprocess.run(command, capture_output=True, text=True, check=False)
    assert "the following arguments are required: folder" in said(without)
    assert "--cores: 0 given; give 1 or more" in said(reproduce(tiny, again, "--cores", "0"))
    assert files_in(tmp_path) == before


def test_what_reproducing_needs_and_is_not_there_is_one_line_with_its_remedy(
    tiny: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def line() -> str:
        assert main(["reproduce", str(tiny), str(tmp_path / "again")]) == 2
        (line,) = capsys.readouterr().err.splitlines()
        return line

    with monkeypatch.context() as without:
        without.setattr("octsim.cli.run.find_spec", lambda _: None)
        assert line() == "octsim: snakemake is not installed; run: pip install 'octsim[run]'"
    monkeypatch.setattr("octsim.cli.run.workflow_folder", lambda: tmp_path)
    assert line() == f"octsim: {tmp_path}: no Snakefile; install octsim again"
    assert list(tmp_path.iterdir()) == []


def test_a_run_that_fails_is_one_line_with_its_reason_and_its_log(
    tiny: Path, tmp_path: Path
) -> None:
    def change(config: dict[str, Any]) -> None:
        config["sweep"]["diameters"]["num"] = 1_000_000
        config["tracing"]["rays"] = 100_000

    file = rewritten(tiny / "spectra.nc", tmp_path, with_config(change))
    line = said(reproduce(file, tmp_path / "again"))
    assert line.startswith("octsim: the run failed (budget.")
    assert line.endswith(f"see {tmp_path / 'again' / 'snakemake.log'}")


def test_an_expansion_is_made_anew_from_the_series_that_it_holds(tmp_path: Path) -> None:
    config = octsim.load_config(TINY, CALIBRATED)
    file = tmp_path / "expansion.nc"
    # not this run's own calibration, so the numbers that follow from one differ
    names = ("fixed_focus_phase_slope", "fixed_focus_phase_slope_standard_error", "phase_curvature")
    diameter = calibration_diameters(config).values()
    table = {n: ("diameter", np.full(8, v)) for n, v in zip(names, (20.0, 1.0, 0.0), strict=True)}
    series = tmp_path / "phases.csv"
    series.write_text(SERIES)
    calibration = xr.Dataset(table, {"diameter": diameter})
    write(octsim.series_expansion(config, octsim.read_series(series), calibration), file)
    series.unlink()
    done = reproduce(file, tmp_path / "again", "--cores", "1")
    assert done.returncode == 1, done.stdout + done.stderr
    assert "  expansion.series: measured/phases.csv -> series.nc\n" in done.stdout
    marked = {line.split()[1] for line in done.stdout.splitlines() if line.startswith("*")}
    assert marked == {"expansion", "statistical_error", "systematic_error", *names[:2]}
    told = dict(line.split()[-2:] for line in done.stdout.splitlines() if "measured_" in line)
    assert told == {"measured_phase": "0", "measured_phase_error": "0"}
    unrecorded = rewritten(file, tmp_path / "again" / "results", _without_series)
    assert "expansion.nc: its measured series is not recorded in it; leave" in said(
        reproduce(unrecorded, tmp_path / "none")
    )
    assert not (tmp_path / "none").exists()


def _without_series(dataset: xr.Dataset) -> None:
    del dataset["measured_phase"]
