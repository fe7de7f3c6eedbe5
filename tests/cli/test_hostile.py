"""Files that are not what they say: each reader answers in one line, and waits for nothing."""

import os
import signal
from collections.abc import Callable, Iterator
from pathlib import Path

import netCDF4
import numpy as np
import pytest
from made_runs import TINY

import octsim
from octsim.archive.pack import packed_config
from octsim.archive.run_folder import run_in
from octsim.archive.verify import problems, unpack
from octsim.base.errors import LONGEST, ArchiveError, ConfigError, DatasetError, OctsimError
from octsim.cli.main import main
from octsim.datasets.files import attributes
from octsim.measured.open import opened_recording
from octsim.phase.measured_series import read_series
from octsim.phase.measured_spectra import read_spectra

FORGED = "a\x1b[2J\nocts\x08im: all is well\r\u202e"
"""What would clear a terminal, and look like a line of octsim's."""
FAIL_SAFE = 120
"""Seconds; nothing is to take one."""


@pytest.fixture(autouse=True)
def _fail_safe() -> Iterator[None]:
    def stop(*_: object) -> None:
        raise AssertionError("it waits")

    signal.signal(signal.SIGALRM, stop)
    signal.alarm(FAIL_SAFE)
    yield
    signal.alarm(0)


def loop(path: Path) -> None:
    path.symlink_to(path.with_name("other"))
    path.with_name("other").symlink_to(path)


def link_to_a_pipe(path: Path) -> None:
    os.mkfifo(f"{path}.pipe")
    path.symlink_to(f"{path}.pipe")


NO_FILES: dict[str, Callable[[Path], object]] = {
    "a pipe": os.mkfifo,
    "a link to a pipe": link_to_a_pipe,
    "no end": lambda path: path.symlink_to("/dev/zero"),
    "nothing": lambda path: path.symlink_to("/dev/null"),
    "links in a loop": loop,
    "a folder": Path.mkdir,
    "not there": lambda _: None,
}
NAMES = {"a byte 0": "a\0b", "10 000 letters": "a" * 10_000, "forged": FORGED}


def in_a_series(path: Path) -> object:
    return read_series(path)


def as_spectra(path: Path) -> object:
    return read_spectra(path)


def as_recording(path: Path) -> object:
    with opened_recording(path) as found:
        return found.counts[:]


def of_materials(path: Path) -> object:
    table = {"table": str(path), "unit": "nm"}
    return octsim.load_config({"scene": {"refractive_index": {"water": table}}})


def of_a_source(path: Path) -> object:
    return octsim.load_config({"spectrum": {"source": {"table": str(path)}}})


def in_a_config(path: Path) -> object:
    return octsim.load_config(path)


READERS: dict[str, Callable[[Path], object]] = {
    "read": octsim.read,
    "series": in_a_series,
    "spectra": as_spectra,
    "recording": as_recording,
    "materials": of_materials,
    "source": of_a_source,
    "config": in_a_config,
}
COMMANDS: dict[str, Callable[[str, Path], list[str]]] = {
    "compare": lambda file, _: ["compare", file, file, "--no-figure"],
    "verify": lambda file, _: ["verify", file],
    "unpack": lambda file, empty: ["unpack", file, str(empty)],
    "archive": lambda file, _: ["archive", file],
    "reproduce": lambda file, empty: ["reproduce", file, str(empty), "--only", "none"],
    "import": lambda file, empty: ["import", file, "--output", str(empty / "measured.nc")],
    "import by a config": lambda file, _: ["import", "--config", file],
}


def is_a_line(text: str, longest: int = LONGEST) -> bool:
    return bool(text) and text.isprintable() and len(text) <= longest


def refused(work: Callable[[], object]) -> str:
    with pytest.raises(OctsimError) as caught:
        work()
    said = str(caught.value)
    assert is_a_line(said), said
    return said


@pytest.mark.parametrize("reader", READERS)
@pytest.mark.parametrize("kind", NO_FILES)
def test_what_is_no_file_is_refused_in_a_line_and_not_waited_for(
    kind: str, reader: str, tmp_path: Path
) -> None:
    path = tmp_path / "given.nc"
    NO_FILES[kind](path)
    assert "given.nc" in refused(lambda: READERS[reader](path))


@pytest.mark.parametrize("reader", READERS)
@pytest.mark.parametrize("kind", NAMES)
def test_a_name_that_is_none_is_refused_in_a_line(kind: str, reader: str, tmp_path: Path) -> None:
    refused(lambda: READERS[reader](tmp_path / NAMES[kind]))


@pytest.mark.parametrize("command", COMMANDS)
@pytest.mark.parametrize("kind", [kind for kind in NO_FILES if kind != "a folder"])
@pytest.mark.parametrize("ending", ["nc", "zip"])
def test_a_command_refuses_what_is_no_file_with_a_line_and_exit_code_2(
    ending: str, kind: str, command: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / f"given.{ending}"
    NO_FILES[kind](path)
    assert main(COMMANDS[command](str(path), tmp_path / "empty")) == 2
    shown = capsys.readouterr()
    assert shown.out == ""
    (line,) = shown.err.splitlines()
    assert line.startswith("octsim: ")
    assert is_a_line(line, LONGEST + len("octsim: "))


@pytest.mark.parametrize("command", COMMANDS)
@pytest.mark.parametrize("kind", NAMES)
def test_a_command_refuses_a_name_that_is_none_likewise(
    kind: str, command: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:  # fmt: skip
    monkeypatch.chdir(tmp_path)
    assert main(COMMANDS[command](NAMES[kind], tmp_path / "empty")) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert is_a_line(line, LONGEST + len("octsim: "))


def netcdf(change: Callable[[netCDF4.Dataset], object]) -> Callable[[Path], None]:
    """Write what may be a dataset of octsim's, a series and spectra, but for a change."""

    def write(path: Path) -> None:
        with netCDF4.Dataset(path, "w") as file:
            for name, size in (("diameter", 4), ("wavelength", 64), ("time", 32)):
                file.createDimension(name, size)
            for name, dims, units in (
                ("intensity", ("diameter", "wavelength"), "1"),
                ("wavelength", ("wavelength",), "nm"),
                ("time", ("time",), "s"),
                ("phase", ("time",), "rad"),
            ):
                one = file.createVariable(name, "f8", dims, contiguous=True)
                one[:] = np.linspace(700, 900, one[:].size).reshape(one.shape)
                one.units = units
            file.setncatts(attributes("spectra", octsim.load_config(TINY), "Made by hand"))
            change(file)

    return write


def of(name: str, **given: object) -> Callable[[Path], None]:
    return netcdf(lambda file: file[name].setncatts(given))


def whole_file(**given: object) -> Callable[[Path], None]:
    return netcdf(lambda file: file.setncatts(given))


def text(written: str) -> Callable[[Path], object]:
    return lambda path: path.write_text(written, encoding="utf-8", errors="surrogatepass")


def table(cell: str) -> Callable[[Path], object]:
    rows = "".join(f"{700 + row},1\n" for row in range(40))
    return text(f"wavelength (nm),a\n{rows}800,{cell}\n{rows}")


def series(cell: str) -> Callable[[Path], object]:
    return text(f"time (s),phase (rad)\n0,1\n1,{cell}\n2,1\n")


def named(name: str) -> Callable[[netCDF4.Dataset], object]:
    return lambda file: file.createVariable(name, "f8", ("time",))


def keyed(path: Path) -> None:
    h5py = pytest.importorskip("h5py")
    with h5py.File(path, "w") as file:
        for name in (FORGED, "a" * 10_000):
            file[name] = np.ones((4, 64))


def huge(file: netCDF4.Dataset) -> None:
    file.createDimension("endless", 10**14)
    file.createVariable("nothing", "f8", ("endless",), chunksizes=(10**6,))


HELD: dict[str, Callable[[Path], object]] = {
    "coordinates of a number": of("intensity", coordinates=5),
    "coordinates of the file, a number": whole_file(coordinates=np.array([5, 6])),
    "scale_factor of text": of("intensity", scale_factor="x"),
    "scale_factor of text, of a phase": of("phase", scale_factor="x", add_offset="\n"),
    "a fill value of text": of("phase", missing_value="x"),
    "units of a time": of("time", units="days since never"),
    "forged units": of("wavelength", units=FORGED, long_name=FORGED),
    "units of a number": of("phase", units=5),
    "a calendar": of("time", units="days since 1970-01-01", calendar=FORGED),
    "a config of a number": whole_file(config=5),
    "a config of much": whole_file(config='{"run": ' + "[" * 100_000),
    "a forged config": whole_file(config='{"\\u001b[2J\\noctsim: x": 1}'),
    "a forged stage": whole_file(stage=FORGED),
    "a stage of numbers": whole_file(stage=np.arange(3)),
    "a forged version": whole_file(octsim_version=FORGED, schema_version=99),
    "a version of text": whole_file(schema_version="ten"),
    "a version of none": whole_file(schema_version=np.nan),
    "a forged variable": netcdf(lambda file: file.renameVariable("phase", "ph\u202eoctsim: ok")),
    "names of 256 letters": netcdf(named("phase_" + "a" * 250)),
    "more than there is memory": netcdf(huge),
    "keys of HDF5": keyed,
    "HDF5 that is none": lambda path: path.write_bytes(b"\x89HDF\r\n\x1a\n" + b"\xff" * 4000),
    "netCDF 3 that is none": lambda path: path.write_bytes(b"CDF\x01" + b"\xff" * 4000),
    "nothing": lambda path: path.write_bytes(b""),
    "a byte": lambda path: path.write_bytes(b"\0"),
    "bytes": lambda path: path.write_bytes(bytes(range(256)) * 40),
    "a cell of 200 kB": table("1" * 200_000),
    "a cell of 200 kB, of letters": table("x" * 200_000),
    "a phase of 200 kB": series('"' + "x" * 200_000 + '"'),
    "text for a number": table("one"),
    "text for a phase": series("one"),
    "a forged cell": table("\x1b[2J\x0boctsim: ok"),
    "a forged phase": series('"\x1b]0;octsim\x07"'),
    "a forged heading": text(f"wavelength (nm),{FORGED}\n700,1\n"),
    "a heading of 200 kB": text("wavelength (nm)," + "x" * 200_000 + "\n700,1\n"),
    "a byte 0 in a table": table("1\0"),
    "a byte 0 in a phase": series("1\0"),
    "half a letter": table("\ud800"),
    "a quote that is left open": series('"1'),
    "a key of 10 000 letters": text("a" * 10_000 + ": 1\n"),
    "a key that is forged": text('"\\e[2J\\noctsim: all is well": 1\n'),
    "a value that is forged": text('run: "\\e[2J\\noctsim: all is well"\n'),
    "a list": text("- 1\n- 2\n"),
}


@pytest.mark.parametrize("reader", READERS)
@pytest.mark.parametrize("kind", HELD)
def test_what_a_file_holds_is_read_or_refused_in_lines(
    kind: str, reader: str, tmp_path: Path
) -> None:
    path = tmp_path / "given.nc"
    HELD[kind](path)
    error = error_of(lambda: READERS[reader](path))
    lines = str(error).split("\n") if error else []
    assert all(map(is_a_line, lines)), lines
    assert len(lines) <= 1 or isinstance(error, ConfigError)
    assert not any(line.startswith("octsim:") for line in lines)


def error_of(work: Callable[[], object]) -> OctsimError | None:
    try:
        work()
    except OctsimError as error:
        return error
    return None


@pytest.mark.parametrize("command", COMMANDS)
@pytest.mark.parametrize("kind", HELD)
def test_a_command_reads_what_a_file_holds_or_refuses_it_with_exit_code_2(
    kind: str, command: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "given.nc"
    HELD[kind](path)
    status = main(COMMANDS[command](str(path), tmp_path / "empty"))
    shown = capsys.readouterr()
    lines = [*shown.out.splitlines(), *shown.err.splitlines()]
    assert all(map(str.isprintable, lines)), lines
    said = [line for line in shown.err.splitlines() if "octsim: warning: " not in line]
    assert status == (2 if said else status)
    assert all(is_a_line(line, LONGEST + len("octsim: ")) for line in said), said
    assert all(line.startswith("octsim: ") for line in said), said
    assert "all is well" not in [line.partition("octsim: ")[2] for line in lines]


@pytest.mark.parametrize(
    ("kind", "reader"),
    [
        ("coordinates of a number", "read"),
        ("scale_factor of text", "read"),
        ("scale_factor of text, of a phase", "series"),
        ("scale_factor of text", "spectra"),
        ("scale_factor of text", "recording"),
        ("units of a time", "read"),
        ("a config of a number", "read"),
        ("a config of much", "read"),
        ("more than there is memory", "read"),
        ("keys of HDF5", "recording"),
        ("a phase of 200 kB", "series"),
        ("a cell of 200 kB, of letters", "spectra"),
        ("a forged cell", "spectra"),
        ("a forged heading", "spectra"),
        ("a byte 0 in a table", "recording"),
        ("text for a phase", "series"),
        ("a key of 10 000 letters", "config"),
        ("a key that is forged", "config"),
        ("a value that is forged", "config"),
    ],
)
def test_what_can_t_be_used_is_not_read(kind: str, reader: str, tmp_path: Path) -> None:
    path = tmp_path / "given.nc"
    HELD[kind](path)
    refused(lambda: READERS[reader](path))


def test_archives_refuse_what_is_no_file(tmp_path: Path) -> None:
    for kind in ("a pipe", "no end", "links in a loop", "not there"):
        path = tmp_path / f"{kind}.zip"
        NO_FILES[kind](path)
        for work in (problems, lambda one: unpack(one, tmp_path / "empty")):
            with pytest.raises(ArchiveError, match=f"{kind}.zip: can't be read"):
                work(path)
        assert packed_config(path) == {}
        (tmp_path / "other").unlink(missing_ok=True)


def test_a_pipe_among_a_run_s_datasets_is_not_waited_for(tmp_path: Path) -> None:
    folder = tmp_path / "run"
    folder.mkdir()
    os.mkfifo(folder / "spectra.nc")
    with pytest.raises(DatasetError, match="no datasets"):
        run_in(folder)
