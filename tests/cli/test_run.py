"""The command `octsim run`: what it takes, what it refuses, and the workflow that it carries."""

import os
import subprocess
import sys
import venv
import zipfile
from collections.abc import Callable
from pathlib import Path

import pytest
import yaml
from checkout import GIVEN, GRID, ROOT, TINY, merged

from octsim.cli import main as command
from octsim.cli import run

OVERLAY = merged(TINY, GIVEN)


def said_by(folder: Path, *arguments: str) -> tuple[int, list[str]]:
    """Run the command in a folder; give its status and what it says, without snakemake's words."""
    done = subprocess.run(
        [sys.executable, "-m", "octsim", "run", *arguments],
        cwd=folder, capture_output=True, text=True, check=False, env=os.environ,
    )  # fmt: skip
    return done.returncode, (done.stdout + done.stderr).splitlines()


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "mine.yaml").write_text(yaml.safe_dump(OVERLAY), encoding="utf-8")
    (tmp_path / "wrong.yaml").write_text("scene: {gap: 5}\n", encoding="utf-8")
    return tmp_path


def run_by(
    monkeypatch: pytest.MonkeyPatch, folder: Path, ended: Callable[[run._Running], int]
) -> None:
    """Have the command work in a folder, and something else than snakemake make its run."""
    monkeypatch.chdir(folder)
    monkeypatch.setattr(run, "stops_at_signals", lambda _: None)
    monkeypatch.setattr(run._Running, "ended", ended)


@pytest.mark.parametrize(
    ("arguments", "line"),
    [
        (["wrong.yaml"], "octsim: scene.gap: 5 given; a length needs its unit"),
        (["missing.yaml"], "octsim: missing.yaml: can't be read"),
        (["mine.yaml", "calbration"], "octsim: calbration: neither a config, whose name ends in"),
        (["--cores", "0"], "octsim run: argument --cores: 0 given; give 1 or more"),
        (["--cores", "many"], "octsim run: argument --cores: many given; give 1 or more"),
        (["mine.yaml", "--dry-run"], "octsim: unrecognized arguments: --dry-run; write"),
    ],
)  # fmt: skip
def test_what_can_t_be_run_is_one_line_and_touches_nothing(
    arguments: list[str], line: str, folder: Path
) -> None:
    before = sorted(folder.iterdir())
    status, said = said_by(folder, *arguments)
    assert status == 2
    assert len(said) == 1
    assert said[0].startswith(line)
    assert sorted(folder.iterdir()) == before


def test_no_core_is_refused_by_make_and_by_the_snakefile_too(folder: Path) -> None:
    (folder / "Makefile").symlink_to(ROOT / "Makefile")
    (folder / ".venv").symlink_to(sys.prefix)
    for line in (
        ["make", "-o", ".venv/run", "results", "CONFIG=mine.yaml", "CORES=0"],
        [sys.executable, "-m", "snakemake", "--snakefile", str(ROOT / "Snakefile"),
         "--configfile", "mine.yaml", "--cores", "0"],
    ):  # fmt: skip
        done = subprocess.run(line, cwd=folder, capture_output=True, text=True, check=False)
        assert done.returncode != 0
        assert "0 given; give 1 or more" in done.stderr
        assert "Traceback" not in done.stderr


def test_words_stand_on_both_sides_of_options_and_flags_are_handed_on(
    monkeypatch: pytest.MonkeyPatch, folder: Path
) -> None:
    given: list[list[str]] = []

    def ended(running: run._Running) -> int:
        given.append(list(running._command))
        return 0

    run_by(monkeypatch, folder, ended)
    words = ["run", "mine.yaml", "--cores", "3", "calibration", "fourier", "--", "--dry-run", "-q"]
    assert command.main(words) == 0
    (line,) = given
    assert line[3:5] == ["calibration", "results/tiny/fourier.nc"]
    assert line[line.index("--cores") + 1] == "3"
    assert line[-4:] == ["--configfile", "mine.yaml", "--dry-run", "-q"]


def test_a_grid_that_was_looked_at_lies_where_every_node_of_the_run_sees_it(
    monkeypatch: pytest.MonkeyPatch, folder: Path
) -> None:
    seen: list[Path] = []

    def ended(_running: run._Running) -> int:
        seen.extend(Path(os.environ["OCTSIM_LOOKED"]).iterdir())
        return 0

    (folder / "grid.yaml").write_text(yaml.safe_dump(GRID), encoding="utf-8")
    monkeypatch.delenv("OCTSIM_LOOKED", raising=False)
    run_by(monkeypatch, folder, ended)
    assert command.main(["run", "grid.yaml"]) == 0
    (found,) = seen
    assert found.parents[1] == folder / ".snakemake"
    assert found.suffix == ".json"
    assert not (folder / ".snakemake").exists()
    assert "OCTSIM_LOOKED" not in os.environ


def test_where_nothing_can_be_kept_of_a_grid_its_run_begins_all_the_same(
    monkeypatch: pytest.MonkeyPatch, folder: Path
) -> None:
    (folder / ".snakemake").write_text("no folder")
    monkeypatch.delenv("OCTSIM_LOOKED", raising=False)
    run_by(monkeypatch, folder, lambda _: 0)
    assert command.main(["run", "mine.yaml"]) == 0
    assert "OCTSIM_LOOKED" not in os.environ
    assert (folder / ".snakemake").read_text() == "no folder"


def test_a_wheel_in_an_empty_folder_makes_a_run(tmp_path: Path) -> None:
    build = [sys.executable, "-m", "pip", "wheel", "--no-deps", "--no-build-isolation", "--quiet"]
    subprocess.run([*build, "--wheel-dir", str(tmp_path), str(ROOT)], check=True)
    (wheel,) = tmp_path.glob("octsim-*.whl")
    venv.create(tmp_path / "installed", symlinks=True)
    (site,) = (tmp_path / "installed" / "lib").glob("python3*/site-packages")
    zipfile.ZipFile(wheel).extractall(site)
    # the libraries, but not the package that is installed in place beside them
    held = [place for place in sys.path if place.endswith("site-packages")]
    (site / "libraries.pth").write_text("".join(f"{place}\n" for place in held))
    empty = tmp_path / "empty"
    empty.mkdir()
    (empty / "mine.yaml").write_text(yaml.safe_dump(OVERLAY), encoding="utf-8")
    python = tmp_path / "installed" / "bin" / "python"
    named = [str(python), "-c", "import octsim; print(octsim.__file__)"]
    assert subprocess.check_output(named, text=True, cwd=empty).startswith(str(site))
    done = subprocess.run(
        [str(python), "-m", "octsim", "run", "mine.yaml", "focus_scan"],
        cwd=empty, capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    assert (empty / "results" / "tiny" / "focus_scan.nc").is_file()
    assert not list(site.rglob("results"))
