"""A run, whatever the environment holds, the folder is called and a clock has said."""

import os
import subprocess
import sys
import time
import venv
from pathlib import Path

import pytest
import yaml
from checkout import GIVEN, ROOT, TINY, Checkout, Finished, merged
from trials import trials

OVERLAY = merged(TINY, GIVEN)
SLOPE = ("--cores", "1", "results/tiny/phase_slope.nc")
EXPANSION = ("--cores", "1", "expansion")
AHEAD = time.time() + 7200


def own_environment(folder: Path) -> Path:
    """Make a virtual environment in a folder, with the libraries of this one; give its Python."""
    venv.create(folder / ".venv", symlinks=True)
    (site,) = (folder / ".venv" / "lib").glob("python3*/site-packages")
    held = [place for place in sys.path if place.endswith("site-packages")]
    lines = (f"import site; site.addsitedir({place!r})\n" for place in held)
    (site / "theirs.pth").write_text("".join(lines))
    return folder / ".venv" / "bin" / "python"


@pytest.mark.parametrize(
    "name",
    [
        "it's {mine} #1",
        *trials('%20 "$HOME" [µm]*', "new\nline"),
    ],
)
def test_a_run_works_in_a_folder_of_any_name(name: str, tmp_path: Path) -> None:
    folder = tmp_path / name
    folder.mkdir()
    Checkout(folder)
    (folder / name.replace("\n", " ")).write_text(yaml.safe_dump(OVERLAY))
    (tmp_path / "elsewhere").mkdir()
    (folder / "results").symlink_to(tmp_path / "elsewhere")
    command = [
        str(own_environment(folder)), "-m", "snakemake", "results/tiny/focus_scan.nc",
        "--cores", "1", "--configfile", name.replace("\n", " "),
    ]  # fmt: skip
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert (tmp_path / "elsewhere" / "tiny" / "focus_scan.nc").is_file()


def test_what_the_environment_holds_for_other_programs_changes_no_bit(
    finished: Finished, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    checkout = Checkout(tmp_path)
    (tmp_path / "matplotlibrc").write_bytes(b"\xff\xfe no text")
    rc = tmp_path / "theirs"
    rc.write_text("savefig.dpi: 300\ntext.usetex: True\n")
    modules = tmp_path / "modules"
    modules.mkdir()
    for folder in (modules, tmp_path):
        for module in ("job", "common", "scipy", "xarray", "numba", "netCDF4"):
            (folder / f"{module}.py").write_text(f"raise ImportError('{module} of the cluster')\n")
    (modules / "octsim.py").write_text("raise ImportError('a script of mine')\n")
    for variable, value in {
        "MPLBACKEND": "nonsense",
        "MATPLOTLIBRC": str(rc),
        "MPLCONFIGDIR": "/proc/nowhere",
        "HOME": "/nonexistent",
        "TMPDIR": "relative",
        "PYTHONPATH": str(modules),
        "PYTHONWARNINGS": "error",
        "PYTHONOPTIMIZE": "2",
        "PYTHONHASHSEED": "7",
        "PYTHONIOENCODING": "ascii",
        "LC_ALL": "C",
        "COLUMNS": "many",
        "OMP_NUM_THREADS": "lots",
    }.items():
        monkeypatch.setenv(variable, value)
    checkout.run(TINY, "--cores", "1")
    assert checkout.results() == finished.checkout.results()


def make(folder: Path, target: str, *given: str, **environment: str) -> str:
    """Make a target with the libraries of this environment; give what is said."""
    for file in ("Makefile", "requirements.lock", "pyproject.toml"):
        (folder / file).symlink_to(ROOT / file)
    (folder / ".venv").symlink_to(sys.prefix)
    done = subprocess.run(
        ["make", "-o", ".venv/run", target, *given], cwd=folder, capture_output=True, text=True,
        env=os.environ | environment, check=False,
    )  # fmt: skip
    return done.stdout + done.stderr


def test_make_uses_its_own_libraries_and_takes_names_as_they_are(tmp_path: Path) -> None:
    Checkout(tmp_path)
    (tmp_path / "modules").mkdir()
    for module in ("octsim", "numpy", "yaml", "snakemake"):
        for folder in (tmp_path, tmp_path / "modules"):
            (folder / f"{module}.py").write_text(f"raise ImportError('{module} of the cluster')\n")
    (tmp_path / "it's $(x) $y {z}").write_text(yaml.safe_dump(merged(OVERLAY, {"scene": {"g": 1}})))
    said = make(
        tmp_path, "results", "CONFIG=it's $(x) $y {z}",
        PYTHONPATH=str(tmp_path / "modules"), PYTHONHOME="/nowhere",
    )  # fmt: skip
    assert "cluster" not in said
    assert "octsim: scene.g: unknown key" in said


def set_ahead(folder: Path) -> None:
    for file in folder.rglob("*"):
        os.utime(file, (AHEAD, AHEAD))


def test_a_clock_that_was_ahead_loses_nothing_and_hides_no_edit(tmp_path: Path) -> None:
    checkout = Checkout(tmp_path)
    checkout.run(OVERLAY, *SLOPE)
    before = checkout.results()
    set_ahead(tmp_path)
    done = checkout.snakemake(OVERLAY, *SLOPE)
    assert done.returncode == 0, done.stderr
    assert "octsim: nothing to be done" in done.stderr
    assert done.stderr.count("is ahead of this machine's clock") == 1
    assert checkout.results() == before
    # one dataset from another machine, and an edit
    os.utime(tmp_path / "results" / "tiny" / "detections.nc", (AHEAD, AHEAD))
    edited = merged(OVERLAY, {"spectrum": {"samples": 101}})
    checkout.run(edited, *SLOPE)
    after = checkout.results()
    assert set(after) == set(before)
    assert after["tiny/phase_slope.nc"] != before["tiny/phase_slope.nc"]


def test_of_a_measured_series_what_stands_in_it_counts_and_not_its_time(tmp_path: Path) -> None:
    checkout = Checkout(tmp_path)
    script, series = tmp_path / "workflow" / "scripts" / "job.py", tmp_path / "phases.csv"
    script.write_text("for file in snakemake.output: open(file, 'w').close()\n")  # takes minutes
    overlay = merged(OVERLAY, {"expansion": {"series": "phases.csv"}})
    series.write_text("time,phase\n0,0.1\n")

    def planned() -> bool:
        done = checkout.snakemake(overlay, *EXPANSION, "--dry-run")
        assert done.returncode == 0, done.stderr
        return "Nothing to be done" not in done.stdout + done.stderr

    checkout.run(overlay, *EXPANSION)
    os.utime(series, (AHEAD, AHEAD))
    assert not planned()
    series.write_text("time,phase\n0,0.2\n")
    os.utime(series, (AHEAD - 86400, AHEAD - 86400))
    assert planned()
