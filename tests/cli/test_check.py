"""A config is checked on the terminal: one line for each problem, or what its run is."""

from pathlib import Path

import pytest
import yaml

from octsim.cli.main import main
from octsim.config.load import load_config

OVERLAY = "run: mine\nsweep: {diameters: {stop: 1.5 um, num: 76}}\n"


@pytest.fixture
def config(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "mine.yaml").write_text(OVERLAY)
    return tmp_path / "mine.yaml"


def test_what_is_printed_is_the_whole_config_and_what_comes(
    config: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["check", "mine.yaml"]) == 0
    printed = capsys.readouterr()
    assert load_config(yaml.safe_load(printed.out)) == load_config(config)
    (to_come,) = [line for line in printed.out.splitlines() if line.startswith("#")]
    assert to_come.startswith("# results/mine: 1 combinations, at most 946 points to trace")
    assert printed.err == ""
    assert list(config.parent.iterdir()) == [config]


def test_quiet_prints_nothing_of_a_config_that_is_right(
    config: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["check", "--quiet", str(config)]) == 0
    assert capsys.readouterr() == ("", "")


def test_a_later_file_wins(config: Path, capsys: pytest.CaptureFixture[str]) -> None:
    config.with_name("more.json").write_text('{"run": "other"}')
    assert main(["check", "mine.yaml", "more.json"]) == 0
    assert "# results/other: " in capsys.readouterr().out


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("scene: {gap: 5}", "octsim: scene.gap: 5 given; a length needs its unit"),
        ("scene: {gap: [1 nm}", "octsim: mine.yaml, line 1, column 19: not as YAML should be"),
        ("- scene", "octsim: mine.yaml: holds a list, not keys with values"),
        ("objective: {numerical_aperture: 2}", "octsim: objective.numerical_aperture: 2.0 given"),
    ],
)
def test_a_problem_is_a_line_and_exit_code_2(
    text: str, said: str, config: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    config.write_text(text)
    assert main(["check", "mine.yaml"]) == 2
    printed = capsys.readouterr()
    (line,) = printed.err.splitlines()
    assert line.startswith(said)
    assert printed.out == ""


def test_a_file_that_is_not_there_is_a_line(
    config: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["check", f"{config}x"]) == 2
    assert capsys.readouterr().err.count("\n") == 1


def test_what_would_not_begin_is_warned_of(
    config: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    config.write_text("budget: {cpu_hours: 0.0001}")
    assert main(["check", "-q", "mine.yaml"]) == 0
    said = capsys.readouterr().err
    assert said.startswith("octsim: warning: budget.cpu_hours: 0.0001 given, but this run takes")


def test_jobs_that_share_a_stage_are_said(config: Path, capsys: pytest.CaptureFixture[str]) -> None:
    config.write_text("tracing: {preset: exact}\nscatter: {minutes: 0.1}")
    assert main(["check", "mine.yaml"]) == 0
    assert "# jobs that share a stage (scatter.minutes): focus_" in capsys.readouterr().out
