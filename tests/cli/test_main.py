"""The command says what is kept, and frees it; what is wrong is one line."""

import os
import subprocess
import sys
import time
from pathlib import Path

import pytest

import octsim
from octsim.cli.cache import CACHE
from octsim.cli.main import main
from octsim.instrument.point_store import PointStore, describe

HEAVY = {"matplotlib", "netCDF4", "numba", "numpy", "pydantic", "scipy", "snakemake", "xarray"}
ENTRIES = [(b"%d" % number, bytes(20_000)) for number in range(100)]


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    return tmp_path


def fill(file: Path) -> None:
    store = PointStore(file, 1.5)
    for key, body in ENTRIES:
        store.put(key, body)


def run(*arguments: str) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-m", "octsim", *arguments]
    return subprocess.run(command, capture_output=True, text=True, check=False, env=os.environ)


def test_show_says_what_there_is(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    before = time.strftime("%Y-%m-%d %H:%M:%S")
    fill(folder / ".octsim" / "points")
    assert main(["cache", "show"]) == 0
    shown = capsys.readouterr()
    first, points, size, last, oldest = shown.out.splitlines()
    assert first == ".octsim/points: point cache, version 2"
    assert points.split() == ["points", "100"]
    assert 2.0 <= float(size.split()[1]) < 2.7
    assert size.endswith("MB of 1500 MB allowed")
    now = time.strftime("%Y-%m-%d %H:%M:%S")
    assert before <= oldest.split(maxsplit=2)[2] <= last.split(maxsplit=2)[2] <= now
    assert shown.err == ""


def test_clear_frees_what_it_says(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    fill(folder / "mine")
    before = describe(folder / "mine")
    assert before is not None
    assert before.bytes > 2e6
    assert main(["cache", "clear", "--file", "mine"]) == 0
    assert capsys.readouterr().out == f"mine: {before.bytes / 1e6:.1f} MB freed\n"
    assert list((folder / "mine").glob("??/*")) == []
    assert main(["cache", "show", "--file", "mine"]) == 0
    assert "points     0\n" in capsys.readouterr().out


@pytest.mark.parametrize("action", ["show", "clear"])
def test_no_cache_is_said_and_none_is_made(
    action: str, folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["cache", action]) == 0
    assert capsys.readouterr().out == ".octsim/points: no cache yet\n"
    assert list(folder.iterdir()) == []


@pytest.mark.parametrize("action", ["show", "clear"])
def test_somebody_s_file_is_refused_in_a_line_and_stays(action: str, folder: Path) -> None:
    (folder / "notes").write_text("mine")
    done = run("cache", action, "--file", "notes")
    assert done.returncode == 1
    assert done.stderr.splitlines() == [
        "octsim: notes: is not a point cache of octsim; move it away or name another"
    ]
    assert (folder / "notes").read_text() == "mine"


@pytest.mark.parametrize("action", ["show", "clear"])
def test_an_old_cache_is_said_to_be_of_no_use_and_stays(
    action: str, folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    old = folder / ".octsim" / "points.sqlite"
    old.parent.mkdir()
    old.write_bytes(b"SQLite format 3\0".ljust(68, b"\0") + b"OCTP")
    before = old.read_bytes()
    assert main(["cache", action]) == 0
    assert capsys.readouterr().out.splitlines() == [
        ".octsim/points: no cache yet",
        ".octsim/points.sqlite: a point cache of octsim 0.2.0, which is not used any more; it can "
        "be deleted",
    ]
    fill(old)
    assert main(["cache", action, "--file", ".octsim/points.sqlite"]) == 0
    said = capsys.readouterr().out.splitlines()
    assert said[0].startswith(".octsim/points.sqlite.store: ")
    assert said[-1].endswith("it can be deleted")
    assert old.read_bytes() == before


def test_the_cache_without_a_name_is_that_of_a_config_without_one() -> None:
    assert Path(octsim.Config().cache.file) == CACHE


@pytest.mark.parametrize(
    "arguments",
    [["--help"], ["--version"], ["completion", "bash"], ["cache", "show"], ["cache", "clear"],
     ["reproduce", "--help"], ["verify", "none.zip"], ["unpack", "none.zip", "none"]],
    ids=" ".join,
)  # fmt: skip
def test_what_computes_nothing_starts_without_what_computes(
    arguments: list[str], folder: Path
) -> None:
    assert folder.is_dir()
    code = (
        "import sys; from octsim.cli.main import main\n"
        "try: main(sys.argv[1:])\n"
        "except SystemExit: pass\n"
        "print(*sys.modules, sep='\\n', file=sys.stderr)"
    )
    line = [sys.executable, "-c", code, *arguments]
    done = subprocess.run(line, capture_output=True, text=True, check=True)
    loaded = set(done.stderr.splitlines())
    assert "octsim.cli.main" in loaded
    assert not loaded & (HEAVY | {"octsim.config.models"})


@pytest.mark.parametrize(
    "arguments",
    [[], ["cash"], ["cache"], ["cache", "empty"], ["cache", "show", "more"],
     ["cache", "clear", "--file"]],
)  # fmt: skip
def test_arguments_that_are_none_are_one_line(arguments: list[str], folder: Path) -> None:
    assert folder.is_dir()
    done = run(*arguments)
    assert done.returncode == 2
    (line,) = done.stderr.splitlines()
    assert line.startswith("octsim")
    assert "--help` says what there is" in line
    assert done.stdout == ""


def test_the_version_is_the_package_s(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as ended:
        main(["--version"])
    assert ended.value.code == 0
    assert capsys.readouterr().out == f"octsim {octsim.__version__}\n"
