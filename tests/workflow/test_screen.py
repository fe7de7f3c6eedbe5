"""The whole screen of a run, as a person at a terminal sees it, and what a pipe gets."""

import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
import yaml
from checkout import GIVEN, TINY, merged
from terminal import Terminal

from octsim.base import say

OVERLAY = merged(TINY, GIVEN)
RUN = [sys.executable, "-m", "octsim", "run", "mine.yaml"]
CLOCK = r"\d\d:\d\d"


def shown(folder: Path, overlay: dict[str, Any], *more: str, **environment: str) -> Terminal:
    """Run a config on a terminal to its end."""
    (folder / "mine.yaml").write_text(yaml.safe_dump(overlay), encoding="utf-8")
    terminal = Terminal([*RUN, *more], folder, **environment)
    terminal.status()
    return terminal


def piped(folder: Path, *more: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run([*RUN, *more], cwd=folder, capture_output=True, text=True, check=False)


@pytest.fixture(scope="module")
def first(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Terminal]:
    folder = tmp_path_factory.mktemp("screen")
    # no code is there: it compiles
    code = tmp_path_factory.mktemp("code")
    return folder, shown(folder, OVERLAY, NUMBA_CACHE_DIR=str(code))


def forms(*lines: str) -> str:
    """Return a pattern of whole lines, in which (…) stands for a time and … for anything."""
    return "\n".join(
        re.escape(line).replace(r"\(…\)", rf"\({CLOCK}\)").replace("…", ".+") for line in lines
    )


RESULT = [
    "octsim: warning: gaussian_fits: a Gaussian leaves more than 0.1 of the intensity's range …",
    "octsim: warning: the estimated error of the intensity is above 0.1 of its largest at …",
    "octsim: datasets and figures are in results/tiny/",
    "octsim: phase slope … mrad/nm …",
]


def test_a_run_is_a_line_for_each_job_and_its_result_last(first: tuple[Path, Terminal]) -> None:
    _, terminal = first
    assert terminal.ended == 0, terminal.written
    jobs, result = terminal.screen()[: -len(RESULT)], terminal.screen()[-len(RESULT) :]
    assert re.fullmatch(forms(*RESULT), "\n".join(result)), result
    # the first two work side by side
    assert re.fullmatch(
        forms(
            "octsim: detections (…): Trace the sweep over diameters",
            "octsim: figures (…): Draw the figures",
            "octsim: focus_law (…): Fit a Gaussian …; Fit the focus law through their centres",
            "octsim: focus_scan (…): Scan the focus for one diameter",
            "octsim: focus_sweep (…): Measure the intensity over the focus for the diameters …",
            "octsim: phase_slope (…): Transform the spectra; Differentiate their phase …",
            "octsim: spectra (…): Turn the detected light into spectra; Share …",
        ),
        "\n".join(sorted(jobs)),
    ), jobs


def test_what_is_being_done_is_shown_and_goes_away(first: tuple[Path, Terminal]) -> None:
    _, terminal = first
    lines = re.split(r"[\r\n]", terminal.written)
    for seen in (
        rf"reading the workflow {CLOCK}",
        rf"focus_scan {CLOCK}",
        "compiling the tracer",
        rf"figures {CLOCK}",
    ):
        assert any(re.search(seen, line) for line in lines), f"{seen}: {terminal.written}"
    assert not any("compiling" in line for line in terminal.screen())


def test_an_edit_of_a_key_is_told_of_first_and_its_result_last(
    first: tuple[Path, Terminal],
) -> None:
    folder, _ = first
    edited = merged(OVERLAY, {"processing": {"window": "hann"}})
    terminal = shown(folder, edited)
    assert re.fullmatch(
        forms(
            "octsim: processing.window: hamming → hann; remaking phase_slope, figures",
            "octsim: phase_slope (…): Transform the spectra; Differentiate their phase …",
            "octsim: figures (…): Draw the figures",
            *RESULT,
        ),
        "\n".join(terminal.screen()),
    ), terminal.written
    assert len(terminal.screen()) <= 12
    # again: there is nothing to do, and the result is told all the same
    again = shown(folder, edited)
    nothing = "octsim: nothing to be done: all is there, and of this config"
    assert re.fullmatch(forms(nothing, *RESULT), "\n".join(again.screen())), again.written


def test_a_pipe_gets_lines_alone_and_quiet_is_quiet(first: tuple[Path, Terminal]) -> None:
    folder, _ = first
    edited = merged(OVERLAY, {"processing": {"window": "boxcar"}})
    (folder / "mine.yaml").write_text(yaml.safe_dump(edited), encoding="utf-8")
    done = piped(folder, "phase_slope")
    assert done.returncode == 0
    assert done.stdout == ""
    lines = done.stderr.splitlines()
    assert re.fullmatch(
        forms("octsim: processing.window: … → boxcar; remaking phase_slope"), lines[0]
    )
    assert lines[1].startswith("octsim: phase_slope: Transform the spectra")
    assert not set("\r\x1b") & set(done.stderr)
    (folder / "results" / "tiny" / "fourier.nc").unlink()
    lines = piped(folder, "phase_slope").stderr.splitlines()
    assert lines[0] == "octsim: remaking phase_slope, as octsim or a file has changed"
    again = ("--", "--forcerun", "phase_slope")
    quiet = piped(folder, "phase_slope", "--quiet", *again)
    assert (quiet.returncode, quiet.stdout, quiet.stderr) == (0, "", "")
    assert "Job stats:" in piped(folder, "phase_slope", "--verbose", *again).stderr


def test_a_config_error_is_the_whole_screen(tmp_path: Path) -> None:
    terminal = shown(tmp_path, {"scene": {"gap": 5}})
    assert terminal.ended == 2
    (line,) = terminal.screen()
    assert line.startswith("octsim: scene.gap: 5 given; a length needs its unit")


@pytest.mark.parametrize(
    ("blocks", "line"),
    [
        (4, "octsim: snakemake failed: OSError: … File too large; --verbose shows where"),
        (
            60,
            "octsim: results/tiny/….nc: can't be written (NetCDF: …); what was there is unchanged",
        ),
    ],
)
def test_a_full_disk_is_a_line_and_no_more(
    blocks: int, line: str, first: tuple[Path, Terminal], tmp_path: Path
) -> None:
    assert first
    (tmp_path / "mine.yaml").write_text(yaml.safe_dump(OVERLAY), encoding="utf-8")
    # no file may be longer, as if there were no room for it
    limited = ["bash", "-c", f'ulimit -f {blocks}; exec "$@"', "bash", *RUN]
    own = {"XDG_CACHE_HOME": str(tmp_path)}  # snakemake keeps the files of workflows there
    terminal = Terminal(limited, tmp_path, **own)
    assert terminal.status() == 1
    told = [one for one in terminal.screen() if " (" not in one or "can't" in one]
    assert len(told) == 1, terminal.written
    assert re.fullmatch(forms(line), told[0])
    assert "Traceback" not in terminal.written


def test_nothing_follows_the_error_of_a_job(first: tuple[Path, Terminal], tmp_path: Path) -> None:
    assert first
    overlay = merged(TINY, {"focus_law": {"fraction": {"stop": 0.42}}})
    terminal = shown(tmp_path, overlay, "detections")
    assert terminal.ended == 1
    assert terminal.screen()[-1].startswith(
        "octsim: sweep.focus: 'law' given, but there is no law"
    ), terminal.written
    assert "RuleException" not in terminal.written


def test_the_plugin_and_the_package_have_the_same_names() -> None:
    from snakemake_logger_plugin_octsim import screen

    assert (screen.PROGRESS, screen.CLEAR, screen.WORDS) == (say.PROGRESS, say.CLEAR, say.WORDS)
