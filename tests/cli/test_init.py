"""A config of a user's own is written once, by options or by answers."""

import io
import os
import pty
import subprocess
import sys
from pathlib import Path

import pytest

from octsim.cli.main import main
from octsim.config.following import calibration_diameters, fitted_diameters, scan_diameter
from octsim.config.load import load_and_tell


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sys, "stdin", io.StringIO())
    return tmp_path


def test_without_options_and_terminal_it_is_the_thesis_s_instrument(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["init"]) == 0
    assert capsys.readouterr() == (
        "mine.yaml: written; `octsim check mine.yaml` says what a run of it takes\n", ""
    )  # fmt: skip
    config, said = load_and_tell(folder / "mine.yaml")
    assert said == []
    assert (config.run, config.objective.numerical_aperture) == ("mine", 1.2)
    assert (config.sweep.diameters.start, config.sweep.diameters.num) == (1.0, 101)


def test_an_axon_of_3_to_6_um_is_one_option(folder: Path) -> None:
    assert main(["init", "axon.yaml", "--diameters", "3 um", "6 um", "--run", "thick"]) == 0
    config, _ = load_and_tell(folder / "axon.yaml")
    assert config.run == "thick"
    assert config.sweep.diameters.num == 301
    for diameters in (fitted_diameters(config), calibration_diameters(config)):
        assert (diameters.start, diameters.stop) == (3.0, 6.0)
    assert scan_diameter(config) == 4.5


def test_what_is_there_stays(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (folder / "mine.yaml").write_text("run: old")
    assert main(["init", "mine.yaml"]) == 2
    assert capsys.readouterr().err == (
        "octsim: mine.yaml: there already; give another name, or move it away\n"
    )
    assert (folder / "mine.yaml").read_text() == "run: old"


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (["--aperture", "3"], "objective.numerical_aperture: 3.0 given"),
        (["--aperture", "[1"], "objective.numerical_aperture: '[1' given"),
        (["--magnification", "0"], "objective.magnification: 0 given"),
        (["--fibre", "4"], "detector.core_diameter: 4 given; a length needs its unit"),
        (["--fibre", "4 um\nrun: x"], "detector.core_diameter: "),
        (["--band", "900 nm", "650 nm"], "spectrum.wavelength.min: "),
        (["--diameters", "2 um", "1 um"], "sweep.diameters.start: 2.0 um given"),
        (["--run", "a b"], "run: 'a b' given"),
        (["we ird.yaml"], "run: 'we ird' given"),
    ],
)
def test_what_no_config_takes_is_refused_and_nothing_is_written(
    options: list[str], said: str, folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["init", *options]) == 2
    assert capsys.readouterr().err.startswith(f"octsim: {said}")
    assert list(folder.iterdir()) == []


def test_what_is_likely_not_meant_is_said(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["init", "--diameters", "0.2 um", "0.4 um"]) == 0
    assert "octsim: warning: sweep.diameters.start: 0.2 um is less than" in capsys.readouterr().err
    assert (folder / "mine.yaml").is_file()


def answered(folder: Path, answers: str) -> tuple[int, str]:
    """Return how `octsim init` ends on a terminal, where someone types answers, and its screen."""
    ours, theirs = pty.openpty()
    command = [sys.executable, "-m", "octsim", "init"]
    process = subprocess.Popen(command, cwd=folder, stdin=theirs, stdout=theirs, stderr=theirs)
    os.close(theirs)
    os.write(ours, answers.encode())
    screen = b""
    while True:
        try:
            part = os.read(ours, 4096)
        except OSError:  # the other end is closed
            break
        if not part:
            break
        screen += part
    os.close(ours)
    return process.wait(), screen.decode()


def test_on_a_terminal_it_asks_and_asks_again(folder: Path) -> None:
    ended, screen = answered(folder, "3\n1.1\n\n5 um\n800 nm\n800 nm to 900 nm\n3 um to 6 um\n")
    assert ended == 0
    assert "objective.numerical_aperture: 3.0 given; it must be below the index" in screen
    assert "write it as 650 nm to 900 nm" in screen
    config, _ = load_and_tell(folder / "mine.yaml")
    assert config.objective.numerical_aperture == 1.1
    assert config.objective.magnification == 20
    assert config.detector.core_diameter == 5.0
    assert (config.spectrum.wavelength.min, config.sweep.diameters.stop) == (0.8, 6.0)


def test_an_end_of_the_answers_writes_nothing(folder: Path) -> None:
    ended, screen = answered(folder, "1.1\n\x04")
    assert ended == 130
    assert "octsim: nothing was written" in screen
    assert list(folder.iterdir()) == []
