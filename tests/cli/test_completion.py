"""Shells complete what the command has."""

import shutil
import subprocess

import pytest

from octsim.cli.main import main


def completed(script: str, *words: str) -> list[str]:
    """Return what bash would offer for the last of some words."""
    line = " ".join(f"'{word}'" for word in words)
    typed = f"COMP_WORDS=({line}); COMP_CWORD={len(words) - 1}"
    asked = f'{script}\n{typed}; _octsim; echo "${{COMPREPLY[@]}}"'
    done = subprocess.run(["bash", "-c", asked], capture_output=True, text=True, check=True)
    return done.stdout.split()


@pytest.fixture
def bash(capsys: pytest.CaptureFixture[str]) -> str:
    assert main(["completion", "bash"]) == 0
    return capsys.readouterr().out


@pytest.mark.parametrize(
    ("words", "offered"),
    [
        (("octsim", "ch"), ["check"]),
        (("octsim", "cache", ""), ["--help", "show", "clear"]),
        (("octsim", "cache", "show", "--f"), ["--file"]),
        (("octsim", "check", "mine.yaml", "--q"), ["--quiet"]),
        (("octsim", "completion", "z"), ["zsh"]),
        (("octsim", "--v"), ["--version"]),
        (("octsim", "show", "results/th"), []),
    ],
)
def test_bash_offers_what_can_follow(words: tuple[str, ...], offered: list[str], bash: str) -> None:
    assert completed(bash, *words) == offered


@pytest.fixture
def zsh(capsys: pytest.CaptureFixture[str]) -> str:
    assert main(["completion", "zsh"]) == 0
    return capsys.readouterr().out


def test_zsh_has_every_command_with_what_it_is_for(zsh: str) -> None:
    assert zsh.startswith("#compdef octsim\n")
    assert "'check:validate a config, and say what its run will take'" in zsh


@pytest.mark.skipif(shutil.which("zsh") is None, reason="zsh is not installed")
@pytest.mark.parametrize(
    ("words", "offered"),
    [
        (("octsim", "ch"), "check:validate a config, and say what its run will take"),
        (("octsim", "cache", ""), "show:"),
        (("octsim", "cache", "show", "--f"), "--file:"),
        (("octsim", "completion", "z"), "zsh"),
    ],
)
def test_zsh_offers_what_can_follow(words: tuple[str, ...], offered: str, zsh: str) -> None:
    # of its completion only what the script calls: it is given what there is to choose from
    given = "compdef() :; _files() :; _describe() { print -l -- ${(P)4} }"
    typed = f"words=({' '.join(map(repr, words))}); CURRENT={len(words)}"
    asked = f"{given}\n{zsh}\n{typed}; _octsim"
    done = subprocess.run(["zsh", "-f", "-c", asked], capture_output=True, text=True, check=True)
    assert [one for one in done.stdout.splitlines() if one.startswith(offered)], done
    assert done.stderr == ""


def test_another_shell_is_refused(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as ended:
        main(["completion", "tcsh"])
    assert ended.value.code == 2
    assert capsys.readouterr().err.count("\n") == 1
