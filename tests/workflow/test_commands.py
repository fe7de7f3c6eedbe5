"""Every command in README.md and docs/ is one that is there, and those of blocks are run."""

import re
import shlex
import shutil
import subprocess
import sys
from argparse import ArgumentParser, Namespace
from collections.abc import Iterator
from importlib.util import find_spec
from pathlib import Path
from typing import Any, NoReturn

import pytest
import yaml
from checkout import TINY, merged
from snakemake.cli import get_argument_parser

from octsim.cli import main as command
from octsim.config.load import load_config
from octsim.datasets.catalog import CATALOG, TARGETS

ROOT = Path(__file__).parents[2]
PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))]
RULES = {"all", "figures", "animation", "report", "archive", *TARGETS}
OPEN = {"[config]", "[targets]", "[--cores", "N]", "<target>", "…"}
"""What stands for words of the user's."""
FILES = re.compile(r"results/[\w/-]+\.\w+")
"""A file that a rule makes may be asked for by its name."""


def shown(page: Path) -> Iterator[tuple[str, bool]]:
    """Commands of a page: lines of its blocks of shell, and what text has in backticks, False."""
    text = page.read_text(encoding="utf-8")
    for block in re.findall(r"```sh\n(.*?)```", text, flags=re.DOTALL):
        yield from ((line, True) for line in re.sub(r"\\\n", " ", block).splitlines())
    text = re.sub(r"```.*?```", "", text, flags=re.DOTALL)
    yield from ((" ".join(one.split()), False) for one in re.findall(r"`([^`]+)`", text))


def called(program: str) -> list[tuple[str, list[str], bool]]:
    """Return the page and the arguments of each call of a program, and whether it is a block's."""
    found = []
    for page in PAGES:
        for line, block in shown(page):
            match = re.match(rf"(?:[A-Z_]+=\S+ )*(?:\.venv/bin/)?{program}(?: +|$)(.*)", line)
            if match:
                arguments = shlex.split(match[1], comments=True)
                cut = next((n for n, a in enumerate(arguments) if a in {"|", "&&", ";", ">"}), None)
                found.append((page.name, arguments[:cut], block))
    return found


def stop(self: ArgumentParser, message: str) -> NoReturn:
    raise AssertionError(f"{self.prog}: {message}")


def test_every_call_of_octsim_is_understood(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    class Understood(Exception):  # noqa: N818
        pass

    parsed = command.Parser.parse_known_args

    def parse(
        self: command.Parser, arguments: list[str], *further: Any
    ) -> tuple[Namespace, list[str]]:
        given, left = parsed(self, arguments, *further)
        if self.prog != "octsim":  # of one command
            return given, left
        # `run` takes words on both sides of its options
        assert not [one for one in left if one.startswith("-") or arguments[0] != "run"], left
        raise Understood

    monkeypatch.setattr(command.Parser, "parse_known_args", parse)
    monkeypatch.setattr(command.Parser, "error", stop)
    calls = [one for one in called("octsim") if one[1]]
    assert len(calls) > 10
    for page, arguments, block in calls:
        if block:
            with pytest.raises(Understood):
                command.main(arguments)
        else:  # named, and maybe without what it takes
            own = arguments[: arguments.index("--")] if "--" in arguments else arguments
            words = [one for one in own if not one.startswith("-")]
            with pytest.raises(SystemExit):
                command.main([words[0], "--help"])
            said = capsys.readouterr().out
            for flag in set(own) - set(words):
                assert flag in said, f"{page}: octsim {words[0]} {flag}"


def test_every_call_of_snakemake_is_of_targets_that_are_there(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(ArgumentParser, "error", stop)
    parser = get_argument_parser()
    calls = called("snakemake")
    assert len(calls) > 3
    for page, arguments, _ in calls:
        given = parser.parse_args([one for one in arguments if one not in {"<target>", "…"}])
        for target in given.targets:
            assert target in RULES or FILES.fullmatch(target), f"{page}: snakemake {target}"


def test_every_run_is_of_targets_that_are_there() -> None:
    runs = [(page, given[1:]) for page, given, _ in called("octsim") if given[:1] == ["run"]]
    assert len(runs) > 20
    for page, given in runs:
        words = given[: given.index("--")] if "--" in given else given
        for target in words:
            named = target in {*RULES, *CATALOG} or FILES.fullmatch(target)
            assert named or target.endswith(".yaml") or target in OPEN, f"{page}: {target}"


def test_every_call_of_make_is_of_a_target_that_is_there() -> None:
    text = (ROOT / "Makefile").read_text(encoding="utf-8")
    targets = set(re.findall(r"^([a-z][a-z-]*):", text, flags=re.MULTILINE))
    variables = set(re.findall(r"^([A-Z_]+) *\??=|\$\(value ([A-Z]+)\)", text, flags=re.MULTILINE))
    known = {name for pair in variables for name in pair if name} | {"TOLERANCE"}
    calls = called("make")
    assert len(calls) > 20
    for page, arguments, _ in calls:
        for one in arguments:
            name, given, _ = one.partition("=")
            assert name in (known if given else targets), f"{page}: make {one}"


# what takes minutes is planned alone, as other tests run it in small
PLANNED = re.compile(
    r"\.venv/bin/(?:octsim run (?:[a-z_]+$|config/|mine.yaml expansion)|snakemake .*profiles/slurm)"
)
# tests within tests, and what is installed
NAMED_ALONE = re.compile(r"make (?:test|slurm)\b")
DIFFERS = {".venv/bin/octsim compare": 1, "make reproduce": 2}
"""How these end where two runs differ."""


@pytest.fixture
def checkout(tmp_path: Path) -> Path:
    """Give what a user has who has cloned it, with small configs by the names in the docs."""
    for name in ("Makefile", "Snakefile"):
        shutil.copy(ROOT / name, tmp_path)
    for name in ("config", "workflow", "profiles"):
        shutil.copytree(ROOT / name, tmp_path / name)
    (tmp_path / ".venv").symlink_to(sys.prefix)
    thick = {"run": "thick", "scene": {"gap": "20 nm"}}
    of_series = {"expansion": {"series": "phases.csv", "diameter": "1.4 um"}}
    for name, overlay in {
        "config/default.yaml": {"run": "thesis"},
        "config/examples/first_look.yaml": {"run": "first_look"},
        "mine.yaml": merged(thick, of_series),
    }.items():
        (tmp_path / name).write_text(yaml.safe_dump(merged(TINY, overlay)), encoding="utf-8")
    rows = "".join(f"{time},0.0\n" for time in range(8))
    (tmp_path / "phases.csv").write_text(f"time,phase\n{rows}", encoding="utf-8")
    return tmp_path


@pytest.mark.trial
def test_every_command_of_a_block_runs_or_is_planned(checkout: Path) -> None:
    lines = [line for page in PAGES for line, block in shown(page) if block]
    commands = [" ".join(one.split(" #")[0].split()) for one in lines]
    ran = 0
    for line in dict.fromkeys(one for one in commands if one and not NAMED_ALONE.match(one)):
        planned = PLANNED.match(line)
        if planned and "slurm" in line and find_spec("snakemake_executor_plugin_slurm") is None:
            continue
        asked = re.sub("^make ", "make -o .venv/run ", line).replace("/some/folder", "elsewhere")
        if planned:
            asked += f"{' --' if 'octsim run' in line else ''} --dry-run"
        if "phase_slope.nc" in line:
            shutil.copy(checkout / "results" / "thesis" / "phase_slope.nc", checkout)
            asked = asked.replace("elsewhere", "further")
        done = subprocess.run(asked, shell=True, cwd=checkout, capture_output=True, text=True)
        differs = next((one for name, one in DIFFERS.items() if line.startswith(name)), 0)
        assert done.returncode in (0, differs), f"{line}: {done.stdout}{done.stderr}"
        assert "Traceback" not in done.stderr, line
        ran += 1
    assert ran > 25


@pytest.mark.parametrize("page", ["start.md", "how-to.md"])
def test_configs_that_are_shown_whole_are_valid(page: str) -> None:
    text = (ROOT / "docs" / page).read_text(encoding="utf-8")
    shown = re.findall(r"```yaml\n(.*?)```", text, flags=re.DOTALL)
    assert shown
    for one in shown:
        assert load_config(yaml.safe_load(one)).run == yaml.safe_load(one)["run"]


def test_the_tutorial_runs(capsys: pytest.CaptureFixture[str]) -> None:
    text = (ROOT / "docs" / "start.md").read_text(encoding="utf-8")
    scope: dict[str, object] = {}
    for block in re.findall(r"```python\n(.*?)```", text, flags=re.DOTALL):
        exec(block, scope)
    refused, slope, expansion = capsys.readouterr().out.splitlines()
    assert refused.startswith("scene.gap: 20 given")
    assert "mrad/nm; predicted 23.1" in slope
    assert float(expansion.split()[0]) == pytest.approx(11 / 24, rel=0.05)
