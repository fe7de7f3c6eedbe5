"""Opens what a lab's spectrometer wrote, by what the file holds and not by its name."""

from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from zipfile import ZipFile

from octsim.base.errors import DatasetError, FileError, printable
from octsim.base.failures import said_in_a_line
from octsim.base.file_digest import require_undamaged
from octsim.base.files import reason, require_regular
from octsim.measured.readers.arrays import array_recording, arrays_recording
from octsim.measured.readers.hdf5 import hdf5_recording
from octsim.measured.readers.matlab import matlab_recording
from octsim.measured.readers.netcdf import netcdf_recording
from octsim.measured.readers.raw_binary import raw_recording
from octsim.measured.readers.tdms import tdms_recording
from octsim.measured.readers.text import text_recording
from octsim.measured.readers.thorlabs import HEADER, thorlabs_recording
from octsim.measured.recording import RawForm, Recording, Wanted

Reader = Callable[[Path, Wanted, ExitStack], Recording]
_KINDS = "text, npy, npz, HDF5, MATLAB, netCDF, TDMS or .oct, or raw binary with measured.raw"
_BEGIN = 1 << 16
_HDF5 = b"\x89HDF\r\n\x1a\n"
_NETCDF4 = b"_NCProperties"
_BY_MARK: tuple[tuple[bytes, str, Reader], ...] = (
    (b"\x93NUMPY", "npy", array_recording),
    (b"CDF\x01", "netCDF", netcdf_recording),
    (b"CDF\x02", "netCDF", netcdf_recording),
    (b"CDF\x05", "netCDF", netcdf_recording),
    (b"MATLAB 5.0 MAT-file", "MATLAB", matlab_recording),
    (b"TDSm", "TDMS", tdms_recording),
)
"""What a file begins with, what it is then, and what reads it."""
_OTHERS = (
    (b"TDSh", "an index of a TDMS file; give the .tdms itself"),
    (b"\x1f\x8b", "packed by gzip; unpack it"),
    (b"BZh", "packed by bzip2; unpack it"),
    (b"\xfd7zXZ", "packed by xz; unpack it"),
    (b"7z\xbc\xaf", "packed by 7-Zip; unpack it"),
    (b"\xd0\xcf\x11\xe0", "a workbook or document of Office; save it as CSV"),
    (b"%PDF", "a PDF; give the spectra themselves"),
    (b"\x89PNG", "an image; give the spectra themselves"),
    (b"\xff\xd8\xff", "an image; give the spectra themselves"),
    (b"II*\0", "an image (TIFF); save the spectra as npy or HDF5"),
    (b"MM\0*", "an image (TIFF); save the spectra as npy or HDF5"),
)
"""What a file begins with that is known and not read."""


@contextmanager
def opened_recording(
    path: str | Path,
    at: str | None = None,
    raw: RawForm | None = None,
    samples: int | None = None,
    x: int | None = None,
) -> Iterator[Recording]:
    """Open a file of raw spectra, and close it when they are done with.

    Parameters
    ----------
    path : path
        A text, ``.npy``, ``.npz``, HDF5, MATLAB, netCDF, TDMS or ``.oct`` file, told by what it
        holds; or raw binary.
    at : str, optional
        Name inside a file of several arrays, as ``/raw/spectra``.
    raw : RawForm, optional
        How numbers stand, of raw binary.
    samples : int, optional
        K, if it is known, as of a file with the axis. Without it the axis in the file tells; see
        `octsim.measured.readers.sides.told` for what else does.
    x : int, optional
        Index, counted from 0, along the dimension that is neither time nor samples, where there
        is one.

    Yields
    ------
    Recording

    Raises
    ------
    OctsimError
        If the file can't be read, or does not hold what is asked for; in one line.
    """
    path = Path(path)
    _require_file(path)
    wanted = Wanted(at, samples, x)
    with ExitStack() as stack:
        with said_in_a_line(str(path), "copy it anew, or give another"):
            require_undamaged(path)
            recording = _opened(path, raw, wanted, stack)
        yield recording._replace(understood=tuple(map(printable, recording.understood)))


def _require_file(path: Path) -> None:
    """Refuse what is no file, before anything waits for it."""
    try:
        require_regular(path)
    except FileNotFoundError:
        raise FileError(f"{path}: can't be read (not there); give a file with spectra") from None
    except IsADirectoryError:
        raise FileError(f"{path}: a folder; give the file in it that holds the spectra") from None
    except OSError as error:
        raise FileError(
            f"{path}: can't be read ({reason(error)}); give a file with spectra"
        ) from None
    if not path.stat().st_size:
        raise FileError(f"{path}: empty; give a file with spectra")


def _opened(path: Path, raw: RawForm | None, wanted: Wanted, stack: ExitStack) -> Recording:
    if raw is not None:
        _require_single(path, "raw binary", wanted)
        return raw_recording(path, raw, wanted, stack)
    with path.open("rb") as file:
        begin = file.read(_BEGIN)
    for mark, what in _OTHERS:
        if begin.startswith(mark):
            raise FileError(f"{path}: {what}")
    kind, reader = _reader(path, begin)
    if reader is None:
        if (
            b"\0" in begin
            and not begin.startswith((b"\xff\xfe", b"\xfe\xff"))
            and not _texty(begin)
        ):
            raise FileError(
                f"{path}: of no kind that is known; give {_KINDS} (dtype and shape of its numbers)"
            )
        _require_single(path, "a text", wanted)
        return text_recording(path, wanted)
    if kind in ("npy", ".oct"):
        _require_single(path, kind, wanted)
    recording = reader(path, wanted, stack)
    return recording._replace(understood=(f"it is {kind}", *recording.understood))


def _texty(begin: bytes) -> bool:
    """Whether a file is all but text, so that the byte 0 in it is worth a word of its own."""
    return begin.count(b"\0") * 20 < len(begin) and begin[:64].isascii() and b"\0" not in begin[:64]


def _reader(path: Path, begin: bytes) -> tuple[str, Reader | None]:
    """Return what a file is, and what reads it; None of a text."""
    for mark, kind, reader in _BY_MARK:
        if begin.startswith(mark):
            return kind, reader
    if begin.startswith((b"PK\x03\x04", b"PK\x05\x06")):
        return _in_zip(path)
    places = (0, 512, 1024, 2048, 4096, 8192, 16384, 32768)
    if any(begin[place : place + len(_HDF5)] == _HDF5 for place in places):
        if _NETCDF4 in begin or path.suffix in (".nc", ".nc4"):
            return "netCDF", netcdf_recording
        return ("MATLAB" if begin.startswith(b"MATLAB 7.3") else "HDF5"), hdf5_recording
    if path.suffix == ".mat":  # of MATLAB's v4, which begins with nothing of its own
        return "MATLAB", matlab_recording
    return "text", None


def _in_zip(path: Path) -> tuple[str, Reader]:
    with ZipFile(path) as archive:
        names = [name.replace("\\", "/").casefold() for name in archive.namelist()]
    if HEADER in names:
        return ".oct", thorlabs_recording
    if any(name.endswith(".npy") for name in names):
        return "npz", arrays_recording
    if "[content_types].xml" in names:
        raise FileError(f"{path}: a workbook or document of Office; save it as CSV")
    raise FileError(f"{path}: a zip with neither arrays of numpy nor a Header.xml; give {_KINDS}")


def _require_single(path: Path, kind: str, wanted: Wanted) -> None:
    if wanted.at is not None:
        raise DatasetError(
            f"{path}: {kind}, in which arrays have no names; leave measured.at ({wanted.at}) out"
        )
