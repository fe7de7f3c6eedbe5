"""The same raw spectra in the kind of file of each spectrometer and program, for tests."""

import io
import zipfile
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, NamedTuple

import netCDF4
import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.io import savemat

from octsim.measured.recording import RawForm

T, K, X = 12, 40, 3
_DRAWN = np.random.default_rng(7)
COUNTS: NDArray[np.uint16] = _DRAWN.integers(100, 60_000, (T, K)).astype(np.uint16)
NM = np.array([800 + 2 * at + 0.01 * at**2 for at in range(K)], dtype=np.float64)
MS = 0.125 * np.arange(T, dtype=np.float64)
NAMED = "Wavelength [nm]"
VOLUME: NDArray[np.uint16] = np.stack([COUNTS + place for place in range(X)], axis=1)
"""(T, X, K), of which the first place is `COUNTS`."""


class Written(NamedTuple):
    """What a file is opened with, and what it has."""

    asked: Mapping[str, Any] = {}
    axis: bool = True
    time: bool = True
    whole: bool = True
    """Whether counts stay whole numbers."""
    reverse: bool = False
    """Whether samples stand by falling wavelength."""
    spectra: int = T


def table(corner: str, top: Any, left: Any, inner: Any, separator: str, point: str = ".") -> str:
    """Return a table as text."""
    rows = [[corner, *top], *([one, *row] for one, row in zip(left, inner, strict=True))]
    cells = [
        [one if isinstance(one, str) else f"{one:.12g}".replace(".", point) for one in row]
        for row in rows
    ]
    return "".join(separator.join(row) + "\n" for row in cells)


def columns(separator: str = ",", point: str = ".", unit: str = " ms", corner: str = NAMED) -> str:
    """Return spectra as columns, headed by their times."""
    heads = [f"{one:.12g}".replace(".", point) + unit for one in MS]
    return table(corner, heads, NM, COUNTS.T, separator, point)


def rows(separator: str = ",", point: str = ".", corner: str = "time (ms)") -> str:
    """Return spectra as rows behind their times."""
    return table(corner, NM, MS, COUNTS, separator, point)


def _npy(values: NDArray[Any]) -> Callable[[Path], Any]:
    held = io.BytesIO()
    np.save(held, values)
    return lambda path: path.write_bytes(held.getvalue())


def _npz(*, packed: bool = False, **values: NDArray[Any]) -> Callable[[Path], Any]:
    held = io.BytesIO()
    (np.savez_compressed if packed else np.savez)(held, **values)  # type: ignore[arg-type]
    return lambda path: path.write_bytes(held.getvalue())


def _text(write: Callable[[], str], encoding: str = "utf-8") -> Callable[[Path], Any]:
    return lambda path: path.write_bytes(write().encode(encoding))


OCEAN = (
    "Data from FLMS{}.txt Node\n\nDate: Mon May 06 10:11:12 CEST 2024\nUser: lab\n"
    "Spectrometer: FLMS1\nTrigger mode: 0\nIntegration Time (sec): 1.000000E-1\n"
    "Scans to average: 1\nBoxcar width: 0\nXAxis mode: Wavelengths\n"
    "Number of Pixels in Spectrum: 40\n>>>>>Begin Spectral Data<<<<<\n"
)


def ocean_single() -> str:
    """Return one spectrum as OceanView writes it."""
    pairs = zip(NM, COUNTS[0], strict=True)
    return OCEAN + "".join(f"{nm:.3f}\t{count:.2f}\n" for nm, count in pairs)


def ocean_continuous() -> str:
    """Return spectra as OceanView writes them one after the other."""
    lines = ["\t\t" + "\t".join(f"{nm:.2f}" for nm in NM)]
    for ms, counts in zip(MS, COUNTS, strict=True):
        stamp = f"2024-05-06 10:11:{12 + ms / 1000:09.6f}"
        lines.append(f"{stamp}\t{ms:.12g}\t" + "\t".join(f"{count:.2f}" for count in counts))
    return OCEAN + "\n".join(lines) + "\n"


def thor_spectra(separator: str = ";", point: str = ".") -> str:
    """Return one spectrum as ThorSpectra writes it."""
    head = [
        "Thorlabs FTS", "[SpectrumHeader]", "Date;20240506", "Time;10111200", "XAxisUnit;nm_air",
        "YAxisUnit;intensity", "Average;0", "RollingAverage;0", "IntegrationTime;0.02",
        "InterferometerSerial;M00300000", "Source;", "[Data]",
    ]  # fmt: skip
    pairs = zip(NM, COUNTS[0], strict=True)
    data = [f"{nm:.3f};{count}".replace(".", point) for nm, count in pairs]
    return "\n".join([*head, *data, "[EndOfFile]", ""]).replace(";", separator)


def excel() -> str:
    """Return spectra as a spreadsheet saves them: empty cells at the end, and empty rows."""
    return "".join(f"{line};;\n" for line in columns(";", ",").splitlines()) + ";;;\n;;;\n"


def _cut_first(text: str) -> str:
    return "".join(line.partition(",")[2] for line in text.splitlines(keepends=True))


def _counted(text: str) -> str:
    first, *others = text.splitlines()
    return "\n".join([f"pixel,{first}", *(f"{row},{line}" for row, line in enumerate(others))])


def h5py() -> Any:
    """Return the library, without which a test is left out."""
    return pytest.importorskip("h5py")


def _hdf5_with_scales(path: Path) -> None:
    with h5py().File(path, "w") as file:
        data = file.create_dataset("raw/spectra", data=COUNTS.T, chunks=(K, 4), compression="gzip")
        for place, (name, values, unit) in enumerate((("lam", NM, "nm"), ("t", MS, "ms"))):
            scale = file.create_dataset(f"raw/{name}", data=values)
            scale.attrs["units"] = np.bytes_(unit)
            scale.make_scale(name)
            data.dims[place].attach_scale(scale)
        data.dims[1].label = "time"


def _hdf5(path: Path) -> None:
    with h5py().File(path, "w") as file:
        file["scan/raw"] = COUNTS
        file["scan/wl"] = NM
        file["scan/wl"].attrs["unit"] = "nm"
        file["scan/t_ms"] = MS
        file["scan/dark"] = COUNTS[:2]
        file["note"] = "a text"


def _hdf5_of_three(path: Path) -> None:
    with h5py().File(path, "w") as file:
        file["spectra"] = VOLUME.transpose(2, 1, 0)
        file["spectra"].dims[2].label = "time"
        file["wavelength"] = NM
        file["time"] = MS
        file["time"].attrs["units"] = "ms"


def _matlab(path: Path) -> None:
    held = {"spectra": COUNTS, "lambda_nm": NM, "t_ms": MS[:, np.newaxis], "label": "a text"}
    savemat(path, held, do_compression=True)


def _matlab_of_a_structure(path: Path) -> None:
    savemat(path, {"data": {"counts": COUNTS.T, "lambda": NM, "time_ms": MS}})


def _matlab_7_3(path: Path) -> None:
    with h5py().File(path, "w", userblock_size=512) as file:
        held: dict[str, NDArray[Any]]
        held = {"spectra": COUNTS, "lambda": NM[np.newaxis] * 1e-9, "t_ms": MS[np.newaxis]}
        for name, values in held.items():
            file[name] = values.T
            kind = {"u": "uint16", "f": "double"}[values.dtype.kind]
            file[name].attrs["MATLAB_class"] = np.bytes_(kind)
        file["note"] = np.array([[97], [98]], np.uint16)
        file["note"].attrs["MATLAB_class"] = np.bytes_("char")
    with path.open("r+b") as raw:
        raw.write(b"MATLAB 7.3 MAT-file, Platform: GLNXA64".ljust(124) + b"\x00\x02IM")


def tdms() -> Any:
    """Return the writer of the library, without which a test is left out."""
    return pytest.importorskip("nptdms")


def write_tdms(path: Path, *channels: tuple[str, str, NDArray[Any]]) -> None:
    """Write channels of groups."""
    library = tdms()
    with library.TdmsWriter(path) as writer:
        writer.write_segment([library.ChannelObject(*channel) for channel in channels])


def _tdms_of_channels(path: Path) -> None:
    spectra = [("camera", f"{ms} ms", row) for ms, row in zip(MS, COUNTS, strict=True)]
    write_tdms(path, ("camera", "wavelength (nm)", NM), *spectra)


def _tdms_of_one(path: Path) -> None:
    write_tdms(path, ("camera", "stream", COUNTS.ravel()))


def _tdms_beside_its_axis(path: Path) -> None:
    channels = ("axis", "Lambda (nm)", NM), ("axis", "time (ms)", MS)
    write_tdms(path, *channels, ("camera", "stream", COUNTS.ravel()))


def _netcdf(path: Path) -> None:
    with netCDF4.Dataset(path, "w") as file:
        file.createDimension("time", None)
        file.createDimension("wavelength", K)
        for name, kind, dims in (
            ("time", "f8", ("time",)), ("wavelength", "f4", ("wavelength",)),
            ("counts", "u2", ("time", "wavelength")),
        ):  # fmt: skip
            file.createVariable(name, kind, dims)
        file["time"].units, file["wavelength"].units = "ms", "um"
        file["time"][:], file["wavelength"][:], file["counts"][:] = MS, NM / 1000, COUNTS


def _netcdf_of_octsim(path: Path) -> None:
    with netCDF4.Dataset(path, "w", format="NETCDF3_64BIT_OFFSET") as file:
        file.createDimension("spectrum", T)
        file.createDimension("wavelength", K)
        file.createVariable("wavelength", "f8", ("wavelength",))[:] = NM / 1000
        file["wavelength"].units = "um"
        file.createVariable("intensity", "f8", ("spectrum", "wavelength"))[:] = COUNTS


DATA_FILE = '<DataFile Type="{}" SizeZ="{}" SizeX="{}" {}>data\\{}.data</DataFile>'


def thor_header(*entries: str) -> str:
    """Return a header of ThorImageOCT."""
    acquisition = "<Acquisition><RefractiveIndex>1.000</RefractiveIndex></Acquisition>"
    data = f"<DataFiles>{''.join(entries)}</DataFiles>"
    return f'<?xml version="1.0" encoding="utf-8"?><Ocity>{acquisition}{data}</Ocity>'


def write_oct(path: Path, header: str, members: Mapping[str, bytes], packed: int = 0) -> None:
    """Write a zip as ThorImageOCT does."""
    with zipfile.ZipFile(path, "w", packed) as archive:
        archive.writestr("Header.xml", header)
        for name, data in members.items():
            archive.writestr(name, data)


def _thorlabs(packed: int) -> Callable[[Path], None]:
    def write(path: Path) -> None:
        entries = [
            DATA_FILE.format("Raw", K, 7, 'BytesPerPixel="2"', "Spectral0"),
            DATA_FILE.format("Raw", K, T - 7, 'BytesPerPixel="2"', "Spectral1"),
            DATA_FILE.format("Real", K, 1, 'BytesPerPixel="4"', "Chirp"),
        ]
        members = {
            "data\\Spectral0.data": COUNTS[:7].tobytes(),
            "data/Spectral1.data": COUNTS[7:].tobytes(),
            "data/Chirp.data": np.arange(K, dtype="<f4").tobytes(),
        }
        write_oct(path, thor_header(*entries), members, packed)

    return write


_SINGLE = Written(time=False, whole=False, spectra=1)
_TEXT = Written(whole=False)
_BARE = Written({"samples": K}, axis=False, time=False)
KINDS: Mapping[str, tuple[Callable[[Path], Any], Written]] = {
    "columns, commas": (_text(columns), _TEXT),
    "columns, semicolons": (_text(lambda: columns(";")), _TEXT),
    "columns, tabs": (_text(lambda: columns("\t")), _TEXT),
    "columns, blanks": (_text(lambda: columns("  ", unit="ms")), _TEXT),
    "columns, decimal commas": (_text(lambda: columns(";", ",")), _TEXT),
    "columns, decimal commas and tabs": (_text(lambda: columns("\t", ",")), _TEXT),
    "columns, decimal commas and blanks": (_text(lambda: columns(" ", ",", "ms")), _TEXT),
    "columns of a spreadsheet": (_text(excel), _TEXT),
    "columns, quoted": (_text(lambda: columns(corner=f'"{NAMED}"')), _TEXT),
    "columns, with a mark": (_text(columns, "utf-8-sig"), _TEXT),
    "columns, UTF-16": (_text(columns, "utf-16"), _TEXT),
    "columns, Windows-1252": (
        _text(lambda: f"at 20 °C\n{columns()}".replace("\n", "\r\n"), "cp1252"),
        _TEXT,
    ),
    "columns, notes": (_text(lambda: "# made by us, 3, 4\n#\n" + columns() + "# 1,2,3\n"), _TEXT),
    "columns, heading in a note": (_text(lambda: "# " + columns()), _TEXT),
    "columns, notes between": (_text(lambda: "\n# n\n".join(columns().splitlines()) + "\n"), _TEXT),
    "columns below a header": (
        _text(lambda: "Camera: x\nGain, 5\n\nDate, 2024\n" + columns()),
        _TEXT,
    ),
    "columns, falling": (
        _text(
            lambda: table(NAMED, [f"{one:g} ms" for one in MS], NM[::-1], COUNTS[:, ::-1].T, ",")
        ),
        _TEXT._replace(reverse=True),
    ),
    "columns without headings": (
        _text(lambda: columns().partition("\n")[2]),
        _TEXT._replace(time=False),
    ),
    "columns behind pixels": (_text(lambda: _counted(columns())), _TEXT),
    "rows, commas": (_text(rows), _TEXT),
    "rows, semicolons": (_text(lambda: rows(";")), _TEXT),
    "rows, tabs": (_text(lambda: rows("\t")), _TEXT),
    "rows, decimal commas": (_text(lambda: rows(";", ",")), _TEXT),
    "rows below a header": (_text(lambda: "Camera: x\nGain, 5\n\n" + rows()), _TEXT),
    "rows without a heading": (_text(lambda: table("", NM, MS / 1000, COUNTS, ",")), _TEXT),
    "rows of numbers alone": (_text(lambda: table("0", NM, MS / 1000, COUNTS, "\t")), _TEXT),
    "rows, no corner": (_text(lambda: table("", NM, MS / 1000, COUNTS, " ").lstrip(" ")), _TEXT),
    "rows, no times": (_text(lambda: _cut_first(rows())), _TEXT._replace(time=False)),
    "OceanView": (_text(ocean_single), _SINGLE),
    "OceanView, decimal commas": (_text(lambda: ocean_single().replace(".", ",")), _SINGLE),
    "OceanView, continuous": (_text(ocean_continuous), _TEXT),
    "ThorSpectra": (_text(thor_spectra), _SINGLE),
    "ThorSpectra, commas": (_text(lambda: thor_spectra(",")), _SINGLE),
    "ThorSpectra, decimal commas": (_text(lambda: thor_spectra(";", ",")), _SINGLE),
    "npy": (_npy(COUNTS), _BARE),
    "npy, samples first": (_npy(COUNTS.T), _BARE),
    "npy, Fortran": (_npy(np.asfortranarray(COUNTS)), _BARE),
    "npy, big end": (_npy(COUNTS.astype(">u2")), _BARE),
    "npy of three": (_npy(VOLUME), _BARE._replace(asked={"samples": K, "x": 0})),
    "npz": (_npz(spectra=COUNTS, wavelength_nm=NM, time_ms=MS), Written()),
    "npz, packed": (
        _npz(packed=True, raw=COUNTS.T, wavelength=NM, t_ms=MS, dark=COUNTS[:1]),
        Written(),
    ),
    "npz, named": (
        _npz(a=COUNTS, b=COUNTS[:, :3], wl_um=NM / 1e3),
        Written({"at": "a"}, time=False),
    ),
    "HDF5 with scales": (_hdf5_with_scales, Written({"at": "/raw/spectra"})),
    "HDF5": (_hdf5, Written({"at": "scan"})),
    "HDF5 of three": (_hdf5_of_three, Written({"x": 0})),
    "MATLAB v5": (_matlab, Written()),
    "MATLAB v5, a structure": (_matlab_of_a_structure, Written({"at": "data.counts"})),
    "MATLAB v7.3": (_matlab_7_3, Written()),
    "TDMS of channels": (_tdms_of_channels, Written()),
    "TDMS of one channel": (_tdms_of_one, _BARE),
    "TDMS beside its axis": (_tdms_beside_its_axis, Written({"at": "camera/stream"})),
    "netCDF": (_netcdf, Written()),
    "netCDF of octsim": (_netcdf_of_octsim, Written(time=False, whole=False)),
    "raw, little end": (
        lambda path: path.write_bytes(COUNTS.astype("<u2").tobytes()),
        _BARE._replace(asked={"raw": RawForm("uint16", (-1, K))}),
    ),
    "raw, big end": (
        lambda path: path.write_bytes(b"head" + COUNTS.astype(">u2").tobytes()),
        _BARE._replace(asked={"raw": RawForm("uint16", (T, K), "big", 4)}),
    ),
    "raw of three": (
        lambda path: path.write_bytes(VOLUME.tobytes()),
        _BARE._replace(asked={"raw": RawForm("uint16", (T, X, K)), "x": 0}),
    ),
    ".oct": (_thorlabs(zipfile.ZIP_STORED), _BARE._replace(asked={})),
    ".oct, packed": (_thorlabs(zipfile.ZIP_DEFLATED), _BARE._replace(asked={})),
}
"""What writes the same spectra as a file of each kind, and what is read of it."""
