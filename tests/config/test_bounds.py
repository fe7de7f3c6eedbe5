"""Bad configs: each is answered in a few lines and in little memory, however it hides."""

import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
from bad_configs import BAD, BIG, Bad

from octsim.base.errors import ConfigError
from octsim.cli.main import main
from octsim.config.bounds import MOST_PROBLEMS
from octsim.config.load import load_config


@pytest.fixture(params=BAD, ids=[bad.name for bad in BAD])
def bad(request: pytest.FixtureRequest) -> Bad:
    found: Bad = request.param
    return found


def _file(folder: Path, bad: Bad) -> Path:
    file = folder / "bad.yaml"
    file.write_bytes(bad.content)
    return file


def test_a_bad_file_is_refused_in_few_lines_in_python_and_by_the_command(
    bad: Bad, tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    file = _file(tmp_path, bad)
    with pytest.raises(ConfigError) as caught:
        load_config(file)
    said = str(caught.value).splitlines()
    assert bad.says in str(caught.value)
    assert len(said) == bad.lines <= MOST_PROBLEMS + 1
    assert max(map(len, said)) < 1100
    assert main(["import", "--config", str(file), "--output", str(tmp_path / "x.nc")]) == 2
    out, told = capfd.readouterr()
    assert (out, told.splitlines()) == ("", [f"octsim: {line}" for line in said])


def test_there_are_bad_files_enough() -> None:
    assert len({bad.name for bad in BAD}) == len(BAD) >= 60


@pytest.mark.skipif(not Path("/proc/self/status").is_file(), reason="needs Linux's /proc")
def test_the_largest_bad_files_take_less_than_300_megabytes_together(tmp_path: Path) -> None:
    code = (
        "import sys, octsim\n"
        "for file in sys.argv[1:]:\n"
        "    try:\n        octsim.load_config(file)\n"
        "    except octsim.ConfigError:\n        pass\n"
        "print(*(line for line in open('/proc/self/status') if line.startswith('VmHWM')))\n"
    )
    largest = sorted(BAD, key=lambda bad: len(bad.content))[-6:]
    files = [_file(tmp_path, bad).rename(tmp_path / bad.name) for bad in largest]
    done = subprocess.run(
        [sys.executable, "-P", "-c", code, *files], capture_output=True, text=True, check=True
    )
    _, kibibytes, unit = done.stdout.split()
    assert unit == "kB"
    assert int(kibibytes) * 1024 < 300e6


@pytest.mark.parametrize(
    ("name", "reason"),
    [
        ("none.yaml", "No such file or directory"),
        (".", "Is a directory"),
        ("pipe", "no file, but a pipe or a device"),
        ("/dev/zero", "no file, but a pipe or a device"),
        ("loop", "Too many levels of symbolic links"),
        ("a\0b", "its name holds a byte 0"),
        ("n" * 300, "File name too long"),
    ],
)
def test_what_is_no_file_is_not_waited_for(
    name: str, reason: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    os.mkfifo("pipe")
    Path("loop").symlink_to("loop")
    with pytest.raises(ConfigError) as caught:
        load_config(name)
    assert f"can't be read ({reason}); give a YAML file" in str(caught.value)
    assert "\n" not in str(caught.value)
    assert str(caught.value).isprintable()


@pytest.mark.parametrize("key", ["scene.refractive_index.glass", "spectrum.source"])
def test_a_table_that_is_no_file_or_very_large_is_not_waited_for(
    key: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    os.mkfifo("pipe")
    Path("long.csv").write_text("wavelength (nm),n\n" + "650,1.5\n" * 60_000, encoding="utf-8")
    Path("large.csv").write_bytes(b"#" * 9_000_000)
    for file, reason in {
        "pipe": "no file, but a pipe or a device", "large.csv": "it holds 9 MB, of 8 MB at most",
        "long.csv": "holds 60001 lines; give 50000 at most",
    }.items():  # fmt: skip
        overlay: Any = {"table": file}
        for part in reversed(key.split(".")):
            overlay = {part: overlay}
        with pytest.raises(ConfigError) as caught:
            load_config(overlay)
        assert reason in str(caught.value)


def _within_itself() -> dict[str, Any]:
    own: dict[str, Any] = {}
    own["scene"] = {"gap": own}
    return own


def _doubling() -> dict[str, Any]:
    part: Any = "x"
    for _ in range(18):
        part = [part] * 9
    return {"run": part}


@pytest.mark.parametrize(
    ("overlay", "says"),
    [
        (_within_itself(), "scene.gap.scene: mappings and lists stand within each other more than"),
        (_doubling(), "more than 20000 values outside of grid and tables"),
        ({"grid": {"scene.gap": ["1 nm"] * 300_000}}, "more than 250000 values"),
        ({"tracing": {"rays": -BIG}}, "tracing.rays: a number of 401 digits given"),
        ({"run": "a\udcff"}, "run: holds the character U+DCFF"),
        ({"run": "a\x1b"}, "run: holds the character U+001B"),
        ({"x" * 201: 1}, f"{'x' * 40}…: as a key 201 characters given; it should be 200 at most"),
        ({BIG: 1}, "a key: a number of 401 digits given"),
        ({"archive": {"title": "x" * 10_001}}, "archive.title: 10001 characters given"),
        ({None: 1}, "None given as a key"),
        ({"run": {1, 2}}, "run: {1, 2} given; it should be a plain name as text"),
    ],
)
def test_a_bad_mapping_is_refused_in_one_line(overlay: dict[Any, Any], says: str) -> None:
    with pytest.raises(ConfigError) as caught:
        load_config(overlay)
    assert says in str(caught.value)
    assert "\n" not in str(caught.value)


def test_the_start_of_a_long_value_is_shown() -> None:
    for overlay in ({"design": {"fills": [0.5] * 2000}}, {"tracing": {"rays": [0.5] * 2000}}):
        with pytest.raises(ConfigError, match=r"\[0\.5, 0\.5, 0\.5, .* …") as caught:
            load_config(overlay)
        assert len(str(caught.value)) < 700
