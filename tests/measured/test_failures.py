"""Damaged and hostile files are refused in one line that names them, and never waited for."""

import io
import os
import socket
import struct
import sys
import zipfile
import zlib
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import netCDF4
import numpy as np
import pytest
from recordings import (
    COUNTS,
    DATA_FILE,
    KINDS,
    NM,
    OCEAN,
    K,
    T,
    columns,
    h5py,
    tdms,
    thor_header,
    write_oct,
    write_tdms,
)
from scipy.io import savemat

from octsim.base.errors import DatasetError, FileError, OctsimError
from octsim.base.failures import said_in_a_line
from octsim.measured.open import opened_recording
from octsim.measured.recording import RawForm

Write = Callable[[Path], Any]


def text(written: str, encoding: str = "utf-8") -> Write:
    return lambda path: path.write_bytes(written.encode(encoding))


def data(written: bytes) -> Write:
    return lambda path: path.write_bytes(written)


def of_kind(kind: str, change: Callable[[bytes], bytes]) -> Write:
    """Write a file of some kind, and change its bytes."""

    def write(path: Path) -> None:
        KINDS[kind][0](path)
        path.write_bytes(change(path.read_bytes()))

    return write


def half(written: bytes) -> bytes:
    return written[: len(written) // 2]


def npy(values: Any, **options: Any) -> bytes:
    held = io.BytesIO()
    np.save(held, values, **options)
    return held.getvalue()


def npz(**values: Any) -> Write:
    return lambda path: data(_npz(**values))(path)


def _npz(**values: Any) -> bytes:
    held = io.BytesIO()
    np.savez(held, **values)
    return held.getvalue()


def with_row(row: int, written: str) -> str:
    lines = columns().splitlines()
    return "\n".join([*lines[:row], written, *lines[row + 1 :]]) + "\n"


def bomb(path: Path) -> None:
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("spectra.npy", npy(np.zeros((30_000, 2048), np.uint16)))


def huge(path: Path) -> None:
    """Write a zip whose directory says that a member has 60 GB."""
    packed = zlib.compressobj(9, zlib.DEFLATED, -15)
    body = packed.compress(bytes(1000)) + packed.flush()
    extra = struct.pack("<HHQQ", 1, 16, 60_000_000_000, len(body))
    local = struct.pack(
        "<4s5H3L2H", b"PK\x03\x04", 45, 0, 8, 0, 33, 0, 0xFFFFFFFF, 0xFFFFFFFF, 5, 20
    )
    central = struct.pack(
        "<4s6H3L5H2L", b"PK\x01\x02", 45, 45, 0, 8, 0, 33, 0, 0xFFFFFFFF, 0xFFFFFFFF, 5, 20, 0, 0,
        0, 0, 0,
    )  # fmt: skip
    first = local + b"a.npy" + extra + body
    end = struct.pack("<4s4H2LH", b"PK\x05\x06", 0, 0, 1, 1, len(central) + 25, len(first), 0)
    path.write_bytes(first + central + b"a.npy" + extra + end)


def workbook(path: Path) -> None:
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("[Content_Types].xml", "")


def locked(path: Path) -> None:
    KINDS["npz"][0](path)
    raw = bytearray(path.read_bytes())
    for mark, place in ((b"PK\x03\x04", 6), (b"PK\x01\x02", 8)):
        at = raw.find(mark)
        while at >= 0:
            raw[at + place] |= 1
            at = raw.find(mark, at + 1)
    path.write_bytes(raw)


def thor(header: str, **members: bytes) -> Write:
    return lambda path: write_oct(
        path, header, {f"data\\{name}.data": held for name, held in members.items()}
    )


RAW = DATA_FILE.format("Raw", K, T, 'BytesPerPixel="2"', "Spectral0")
LAUGHS = (
    '<?xml version="1.0"?><!DOCTYPE a [<!ENTITY b "ha"><!ENTITY c "&b;&b;&b;">]>'
    f"<Ocity>&c;{RAW}</Ocity>"
)


def hdf5(**values: Any) -> Write:
    def write(path: Path) -> None:
        with h5py().File(path, "w") as file:
            for name, held in values.items():
                file[name] = held

    return write


def external(path: Path) -> None:
    other = path.with_name("other.bin")
    other.write_bytes(COUNTS.tobytes())
    with h5py().File(path, "w") as file:
        file.create_dataset("spectra", (T, K), "u2", external=[(str(other), 0, COUNTS.nbytes)])


def linked(path: Path) -> None:
    with h5py().File(path, "w") as file:
        file["spectra"] = h5py().ExternalLink("/dev/zero", "/spectra")


def virtual(path: Path) -> None:
    library = h5py()
    layout = library.VirtualLayout((T, K), "u2")
    layout[:] = library.VirtualSource("gone.h5", "spectra", (T, K))
    with library.File(path, "w") as file:
        file.create_virtual_dataset("spectra", layout)


def unwritten(path: Path) -> None:
    with h5py().File(path, "w") as file:
        file.create_dataset("spectra", (1_000_000_000, 2048), "u2", chunks=(16, 2048))


def odd_type(path: Path) -> None:
    with h5py().File(path, "w") as file:
        library = h5py()
        space = library.h5s.create_simple((2, 2))
        library.h5d.create(file.id, b"spectra", library.h5t.UNIX_D32LE, space)


def of_hdf5(written: bytes) -> Write:
    return lambda path: h5py() and path.write_bytes(written)


def of_tdms(written: bytes) -> Write:
    return lambda path: tdms() and path.write_bytes(written)


def of_text(path: Path) -> None:
    with netCDF4.Dataset(path, "w") as file:
        file.createDimension("time", 3)
        file.createVariable("spectra", str, ("time",))[0] = "a"


def channels(*held: tuple[str, str, Any]) -> Write:
    return lambda path: write_tdms(path, *held)


def mat(**values: Any) -> Write:
    return lambda path: savemat(path, values)


NOTHING: dict[str, Any] = {}
SIZED = {"samples": K}
DAMAGED: dict[str, tuple[Write, dict[str, Any], str]] = {
    # what is no file
    "missing": (lambda _: None, NOTHING, "not there"),
    "a folder": (Path.mkdir, NOTHING, "a folder; give the file"),
    "a pipe": (os.mkfifo, NOTHING, "no file, but a pipe or a device"),
    "a device": (lambda path: path.symlink_to("/dev/zero"), NOTHING, "no file, but"),
    "a link to nothing": (lambda path: path.symlink_to("gone"), NOTHING, "not there"),
    "a link to itself": (lambda path: path.symlink_to(path.name), NOTHING, "can't be read"),
    "empty": (data(b""), NOTHING, "empty"),
    # text
    "blanks": (text(" \n\n \t\n"), NOTHING, "empty"),
    "prose": (text("There were\nno spectra\nto be had.\n"), NOTHING, "no rows of numbers"),
    "headings alone": (text("wavelength (nm),a,b\n"), NOTHING, "no rows of numbers"),
    "a word among numbers": (
        text(with_row(20, "838.0," + "1," * 10 + "x1,2")),
        NOTHING,
        "row 21: cell 12 is 'x1', which is no number",
    ),
    "a word in the first row": (text(with_row(1, "8x0" + ",1" * 12)), NOTHING, "row 2: '8x0,1"),
    "a word in a short first row": (
        text("wavelength (nm),a,b\n-,5,7\n801,1,2\n802,1,2\n"),
        NOTHING,
        "row 2: '-,5,7' given, between the headings and the numbers",
    ),
    "a word in a row without headings": (
        text("8x0,7,5\n801,1,2\n802,1,2\n"),
        NOTHING,
        "row 1: cell 1 is '8x0', which is no number",
    ),
    "an empty cell": (
        text(with_row(9, "816," + "1," * 4 + "," + "1," * 6 + "2")),
        NOTHING,
        "row 10: cell 6 is empty",
    ),
    "a short row": (text(with_row(7, "812,1,2")), NOTHING, "row 8: '812,1,2' given, 3 cells"),
    "a short first row": (
        text("800,1\n801,1,2\n802,1,2\n"),
        NOTHING,
        "row 2: .* 3 cells, and row 1",
    ),
    "a long row": (text(with_row(7, "812" + ",1" * 13)), NOTHING, "row 8: .* 14 cells"),
    "cut short": (
        of_kind("columns, commas", lambda held: held[:-9]),
        NOTHING,
        "row 41: .*12 cells",
    ),
    "a decimal comma among points": (
        text(columns(";", ".").replace("816.64", "816,64")),
        NOTHING,
        "row 10: cell 1 is '816,64'.*decimal point",
    ),
    "thousands": (
        text(columns(";", ",").replace("816,64", "1.816,64")),
        NOTHING,
        "row 10: cell 1 is '1.816,64'.*nothing between thousands",
    ),
    "a note behind numbers": (
        text(with_row(4, "806" + ",1" * 12 + " # 5")),
        NOTHING,
        "row 5: cell 13 is '1 # 5'.*begins with #",
    ),
    "a quote left open": (text(with_row(4, '"806' + ",1" * 12)), NOTHING, "row 5: cell 1 is"),
    "a byte 0": (
        of_kind("columns, commas", lambda held: held[:300] + b"\0" + held[301:]),
        NOTHING,
        "row 4: a byte 0x00",
    ),
    "no text of any kind": (
        data(b"wavelength (nm),\x81\x8d\n800,1\n801,2\n"),
        NOTHING,
        "row 1: byte 0x81 is no text",
    ),
    "UTF-16 cut short": (of_kind("columns, UTF-16", lambda held: held[:-1]), NOTHING, "no text in"),
    "errors beside": (
        text("wavelength (nm),a,a error\n" + "800,1,2\n801,1,2\n"),
        NOTHING,
        "row 1: the column 'a error' is of no spectrum",
    ),
    "two axes": (
        text("wavelength (nm),k (1/um),a\n800,1,2\n801,1,2\n"),
        NOTHING,
        r"the column 'k \(1/um\)' is of no spectrum",
    ),
    "a unit of none": (text("wavelength (furlong),a\n800,1\n801,1\n"), NOTHING, "'furlong'"),
    "no unit that is likely": (text("wavenumber,a\n800,1\n801,1\n"), NOTHING, "has no unit"),
    "too few headings": (
        text("wavelength (nm),a,b\n800,1,2,3\n801,1,2,3\n"),
        NOTHING,
        "row 1: 3 headings over 4 columns",
    ),
    "phases": (text("time (s),phase (rad)\n0,1\n1,2\n"), NOTHING, "row 1: the column 'phase"),
    "frequencies": (
        of_kind("ThorSpectra", lambda held: held.replace(b"nm_air", b"THz")),
        NOTHING,
        "its header says that the axis is in 'THz'",
    ),
    "either may be the axis": (
        text(
            "".join(
                ",".join(str(800 + 10 * row + column) for column in range(10)) + "\n"
                for row in range(10)
            )
        ),
        NOTHING,
        "the first column may both be",
    ),
    "no axis": (
        text("".join("5,9,4\n" for _ in range(20))),
        NOTHING,
        "is 20 x 3, and nothing says which of 20 and 3 .*give measured.axis",
    ),
    "a square without names": (data(npy(np.ones((K, K)))), SIZED, "more than one dimension"),
    "another number of samples": (text(columns()), {"samples": 41}, "41 are given"),
    "a place across a text": (text(columns()), {"x": 1}, "leave measured.x out"),
    "a name inside a text": (text(columns()), {"at": "a"}, "leave measured.at"),
    "OceanView without numbers": (text(OCEAN), NOTHING, "no rows of numbers"),
    # numpy
    "npy, cut short": (of_kind("npy", half), SIZED, "cut short"),
    "npy, header cut short": (of_kind("npy", lambda held: held[:40]), SIZED, "can't be read"),
    "npy, header of code": (
        of_kind("npy", lambda held: held.replace(b"False", b"exit(")),
        SIZED,
        "can't be read",
    ),
    "npy of objects": (
        data(npy(np.array([[1, "a"]], object), allow_pickle=True)),
        NOTHING,
        "holds objects",
    ),
    "npy of records": (data(npy(np.zeros((3, 9), "u2,f4"))), NOTHING, "holds records"),
    "npy of complex numbers": (data(npy(np.ones((3, 9)) * 1j)), NOTHING, "holds complex numbers"),
    "npy of text": (data(npy(np.full((3, 9), "a"))), NOTHING, "holds text"),
    "npy of truth values": (data(npy(np.ones((3, 9), bool))), NOTHING, "holds truth values"),
    "npy of dates": (data(npy(np.ones((3, 9), "M8[s]"))), NOTHING, "holds dates"),
    "npy of one number": (data(npy(np.array(3))), NOTHING, "holds no spectra"),
    "npy of none": (data(npy(np.ones((0, K)))), SIZED, "holds no spectra, with the size 0 x 40"),
    "npy of four": (data(npy(np.ones((2, 3, 4, K)))), SIZED, "has 4 dimensions, 2 x 3 x 4 x 40"),
    "npy of three": (
        data(npy(np.ones((9, 3, K)))),
        SIZED,
        "9 x 3 x 40; give measured.x, from 0 to 2",
    ),
    "npy of three, x beyond": (
        data(npy(np.ones((9, 3, K)))),
        {"samples": K, "x": 3},
        "measured.x is 3; give it from 0 to 2",
    ),
    "npy of other samples": (data(npy(np.ones((9, 5)))), SIZED, "has 40 samples, as no dimension"),
    "npy in a row": (data(npy(np.ones(3 * K + 1))), SIZED, "holds 121 numbers in a row"),
    "npz of two": (npz(a=COUNTS, b=COUNTS), SIZED, "more than one array may be .* measured.at"),
    "npz without it": (npz(a=COUNTS), {"at": "b"}, "holds no 'b'; give measured.at as one of 'a"),
    "npz of objects": (npz(spectra=np.array([[1, "a"]], object)), NOTHING, "holds objects"),
    "npz of another axis": (npz(spectra=COUNTS, wavelength=NM[1:]), NOTHING, "has 39 numbers"),
    "npz of an axis alone": (npz(wavelength=NM), SIZED, "holds no spectra"),
    "npz, cut short": (of_kind("npz", half), NOTHING, "can't be read"),
    "npz, locked": (locked, NOTHING, "needs a password"),
    "zip, a bomb": (bomb, NOTHING, "are said to hold .* it is not unpacked"),
    "zip, said to be huge": (huge, NOTHING, "hold 60000000000, and it is not unpacked"),
    "zip of nothing": (
        lambda path: zipfile.ZipFile(path, "w").close(),
        NOTHING,
        "a zip with neither",
    ),
    "zip, a workbook": (workbook, NOTHING, "save it as CSV"),
    # Thorlabs
    ".oct, entities": (thor(LAUGHS, Spectral0=COUNTS.tobytes()), NOTHING, "DOCTYPE"),
    ".oct, no XML": (thor("<Ocity>", Spectral0=COUNTS.tobytes()), NOTHING, "is no XML"),
    ".oct, no raw spectra": (thor(thor_header()), NOTHING, "holds no raw spectra"),
    ".oct, spectra not there": (
        thor(thor_header(RAW)),
        NOTHING,
        "named in Header.xml, and not there",
    ),
    ".oct, spectra cut short": (
        thor(thor_header(RAW), Spectral0=COUNTS.tobytes()[:-2]),
        NOTHING,
        "has 958 bytes, and 12 spectra of 40 samples take 960",
    ),
    ".oct, sizes of no number": (
        thor(thor_header(RAW.replace('"40"', '"-1"')), Spectral0=b"12"),
        NOTHING,
        "SizeZ of data/Spectral0.data is '-1'",
    ),
    ".oct, sizes of nothing": (
        thor(thor_header(RAW.replace('"40"', '"0"')), Spectral0=b"12"),
        NOTHING,
        "has SizeZ 0",
    ),
    ".oct, outside": (
        thor(thor_header(RAW.replace("data\\", "..\\..\\etc\\"))),
        NOTHING,
        "not there",
    ),
    # HDF5
    "HDF5, cut short": (of_kind("HDF5", half), NOTHING, "can't be read"),
    "HDF5, its mark alone": (of_hdf5(b"\x89HDF\r\n\x1a\n" + bytes(100)), NOTHING, "can't be read"),
    "HDF5 of nothing": (hdf5(), NOTHING, "holds no arrays"),
    "HDF5 of text": (hdf5(spectra="a"), NOTHING, "holds text"),
    "HDF5 of complex numbers": (hdf5(spectra=COUNTS * 1j), NOTHING, "holds complex numbers"),
    "HDF5 of two": (hdf5(a=COUNTS, b=COUNTS), SIZED, r"'/a \(12 x 40\)', '/b .* give measured.at"),
    "HDF5, elsewhere": (external, SIZED, "holds parts of other files"),
    "HDF5, linked": (linked, SIZED, "holds no arrays"),
    "HDF5, put together": (virtual, SIZED, "holds parts of other files"),
    "HDF5, never written": (unwritten, SIZED, "holds nothing that was written"),
    "HDF5 of odd numbers": (odd_type, SIZED, "holds a type that numpy has not"),
    "HDF5, another name": (hdf5(spectra=COUNTS), {"at": "/raw"}, "holds no '/raw'"),
    # MATLAB
    "MATLAB, cut short": (of_kind("MATLAB v5", half), NOTHING, "can't be read"),
    "MATLAB, its mark alone": (
        data(b"MATLAB 5.0 MAT-file" + bytes(200)),
        NOTHING,
        "can't be read|hold",
    ),
    "MATLAB of complex numbers": (mat(spectra=COUNTS * 1j), SIZED, "holds complex numbers"),
    "MATLAB of cells": (mat(spectra=np.array([[1, "a"]], object)), SIZED, "holds MATLAB's cell"),
    "MATLAB of text": (mat(spectra="a text"), SIZED, "holds MATLAB's char"),
    "MATLAB, never so much": (
        of_kind("MATLAB v5", lambda held: held[:128]),
        NOTHING,
        "holds no arrays",
    ),
    # netCDF
    "netCDF, cut short": (of_kind("netCDF", half), NOTHING, "can't be read"),
    "netCDF 3, cut short": (
        of_kind("netCDF of octsim", lambda held: held[:-4]),
        NOTHING,
        "netCDF that is cut short, after 4348 of 4352 bytes; copy it anew",
    ),
    "netCDF 3, header cut short": (
        of_kind("netCDF of octsim", lambda held: held[:60]),
        NOTHING,
        "cut short|holds no arrays",
    ),
    "netCDF of text": (of_text, NOTHING, "holds text"),
    # TDMS
    "TDMS, its mark alone": (of_tdms(b"TDSm" + bytes(24)), NOTHING, "can't be read"),
    "TDMS, cut short": (
        of_kind("TDMS of channels", lambda held: held[:-400]),
        NOTHING,
        "its last segment is cut short; copy it anew",
    ),
    "TDMS, damaged": (
        of_kind("TDMS of channels", lambda held: held[:60] + b"\xff" * 40 + held[100:]),
        NOTHING,
        "can't be read",
    ),
    "TDMS, an index": (data(b"TDSh" + bytes(60)), NOTHING, "give the .tdms itself"),
    "TDMS of text": (channels(("a", "b", np.array(["x", "y"]))), SIZED, "holds objects"),
    "TDMS of other lengths": (channels(("a", "b", NM), ("a", "c", NM[1:])), SIZED, "more than one"),
    # raw binary, and others
    "raw, of another size": (
        data(COUNTS.tobytes()[:-2]),
        {"raw": RawForm("uint16", (T, K))},
        "has 958 bytes .*take 960; give measured.raw",
    ),
    "raw, no whole spectra": (
        data(COUNTS.tobytes()[:-2]),
        {"raw": RawForm("uint16", (-1, K))},
        "take a multiple of 80",
    ),
    "raw of objects": (
        data(COUNTS.tobytes()),
        {"raw": RawForm("object", (-1, K))},
        "give one of uint8",
    ),
    "raw, all from its size": (
        data(COUNTS.tobytes()),
        {"raw": RawForm("uint16", (-1, -1))},
        r"shape is \[-1, -1\]",
    ),
    "raw, beyond its end": (
        data(b"12"),
        {"raw": RawForm("uint16", (-1, K), offset=99)},
        "offset is 99",
    ),
    "numbers without a form": (
        data(b"\1\0\2\0" * 99),
        NOTHING,
        "of no kind that is known; give text",
    ),
    "packed": (data(b"\x1f\x8b\x08" + bytes(30)), NOTHING, "packed by gzip; unpack it"),
    "an old workbook": (data(b"\xd0\xcf\x11\xe0" + bytes(30)), NOTHING, "save it as CSV"),
    "an image": (data(b"\x89PNG\r\n\x1a\n" + bytes(30)), NOTHING, "an image"),
}


@pytest.mark.parametrize("kind", DAMAGED)
def test_a_damaged_file_is_refused_in_a_line_that_names_it(kind: str, tmp_path: Path) -> None:
    write, asked, said = DAMAGED[kind]
    path = tmp_path / "recording"
    write(path)
    with (
        pytest.raises(OctsimError, match=said) as refused,
        opened_recording(path, **asked) as found,
    ):
        _ = found.counts[:]
    assert isinstance(refused.value, (FileError, DatasetError))
    assert "\n" not in str(refused.value)
    assert str(path) in str(refused.value)
    assert ";" in str(refused.value), "it says what to do"


@pytest.mark.parametrize(("kind", "library"), [("HDF5", "h5py"), ("TDMS of one channel", "nptdms")])
def test_a_library_that_is_missing_is_named(
    kind: str, library: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "recording"
    KINDS[kind][0](path)
    monkeypatch.setitem(sys.modules, library, None)
    name = {"nptdms": "npTDMS"}.get(library, library)
    said = rf"{path}: (HDF5|TDMS), which needs {name}; install octsim\[lab\] or {name}$"
    with pytest.raises(FileError, match=said), opened_recording(path):
        pass


def test_a_socket_is_no_file(tmp_path: Path) -> None:
    path = tmp_path / "recording"
    with socket.socket(socket.AF_UNIX) as listening:
        listening.bind(str(path))
        with pytest.raises(FileError, match="no file, but"), opened_recording(path):
            pass


def test_a_name_with_a_byte_0_is_refused() -> None:
    with pytest.raises(FileError, match=r"^a\\x00b: can't be read"), opened_recording("a\0b"):
        pass


def test_what_is_no_failure_of_a_file_is_passed_on(tmp_path: Path) -> None:
    for kind in (MemoryError, KeyboardInterrupt, SystemExit):
        with pytest.raises(kind), said_in_a_line("it", "mend it"):
            raise kind
    path = tmp_path / "recording"
    KINDS["npy"][0](path)
    with pytest.raises(KeyError), opened_recording(path, samples=K):
        raise KeyError("of who reads it")


def test_a_long_reason_is_cut() -> None:
    with pytest.raises(FileError) as refused, said_in_a_line("it", "mend it"):
        raise ValueError("a\nb" * 1000)
    assert len(str(refused.value)) < 300
    assert "\n" not in str(refused.value)


@pytest.mark.parametrize("kind", [kind for kind in KINDS if "raw" not in kind])
def test_a_file_that_is_cut_short_is_refused_or_has_whole_spectra(
    kind: str, tmp_path: Path
) -> None:
    write, has = KINDS[kind]
    path = tmp_path / "recording"
    write(path)
    whole = path.read_bytes()
    path.unlink()
    for size in np.linspace(1, len(whole) - 1, 23).astype(int):
        path.write_bytes(whole[:size])
        said = _whole_or_refused(path, has.asked)
        assert said is None or ("\n" not in said and str(path) in said)
        path.unlink()


def _whole_or_refused(path: Path, asked: Mapping[str, Any]) -> str | None:
    """Return what is said of a file; None if each of its spectra is read."""
    try:
        with opened_recording(path, **asked) as found:
            assert found.counts[:].shape == found.counts.shape
    except OctsimError as error:
        return str(error)
    return None
