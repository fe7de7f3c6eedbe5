"""Recordings of ThorImageOCT: a zip with raw spectra, and a header that says how they stand."""

import re
from contextlib import ExitStack
from pathlib import Path
from typing import NamedTuple
from xml.etree import ElementTree as ET
from zipfile import ZipInfo

import numpy as np

from octsim.base.errors import DatasetError, FileError
from octsim.measured.readers.blocks import Joined, Source
from octsim.measured.readers.inside import Container, Held, recording_of
from octsim.measured.readers.zips import Zip, array_in, member, opened_zip
from octsim.measured.recording import Recording, Wanted

HEADER = "header.xml"
_MOST = 64_000_000
"""Bytes of a header."""
_RAW = "raw"
_BESIDE = ("Chirp.data", "OffsetErrors.data", "ApodizationSpectrum.data")


class _Raw(NamedTuple):
    """Raw spectra, as the header names them."""

    place: str
    """Of the member in the zip."""
    samples: int
    each: int
    """Bytes of a number."""
    signed: bool
    spectra: int | None
    scanned: tuple[int, int] | None
    """Those that are of the sample: before them stand some of the source alone."""


class _Undeclared(ET.TreeBuilder):
    """Builds a tree of XML, of which nothing is declared that could be put in its place."""

    def doctype(self, *_: object) -> None:
        """Refuse a declaration of the document's type, where entities are declared."""
        raise FileError("it declares a DOCTYPE, as no header of an instrument does")


def thorlabs_recording(path: Path, wanted: Wanted, stack: ExitStack) -> Recording:
    """Return the recording in a file ``.oct``, the files of raw spectra one after the other.

    The file has a table that brings its samples to even wavenumbers, but no wavelengths.

    Raises
    ------
    OctsimError
        If it holds no raw spectra, or others than its header says.
    """
    opened = opened_zip(path, stack)
    members = {_place(info.filename): info for info in opened.archive.infolist()}
    raws = [
        _raw(element, f"{path}, Header.xml")
        for element in _header(opened, members[HEADER], stack).iter()
        if element.tag.rpartition("}")[2] == "DataFile"
        and (element.get("Type") or "").casefold() == _RAW
    ]
    if not raws:
        raise DatasetError(f"{path}: holds no raw spectra; have ThorImageOCT save raw data too")
    kinds = sorted({(one.samples, one.each, one.signed) for one in raws})
    if len(kinds) > 1:
        raise DatasetError(
            f"{path}: its files of spectra have {kinds[0][0]} and {kinds[1][0]} samples, or other "
            "numbers; give a file with one kind"
        )
    source = Joined([_part(opened, members, raw, stack) for raw in raws])
    held = Held("spectra", source.shape, source.dtype, rows=True)
    recording = recording_of(Container(path, [held], lambda _: source), wanted)
    return recording._replace(
        name=str(path), understood=(*recording.understood, *_said(raws, members))
    )


def _said(raws: list[_Raw], members: dict[str, ZipInfo]) -> list[str]:
    said = [f"spectra are in {', '.join(one.place for one in raws[:3])}" + " ..." * (len(raws) > 3)]
    if any(one.scanned for one in raws):
        said.append("spectra before and behind the scan, by Header.xml, are not read")
    beside = [name for name in _BESIDE if f"data/{name.casefold()}" in members]
    if beside:
        said.append(f"not read: {', '.join(beside)}; wavelengths are not in this kind of file")
    return said


def _place(name: str) -> str:
    """Return a name in the zip, or in the header, as both are compared: neither by case."""
    return _plain(name).casefold()


def _plain(name: str) -> str:
    return " ".join(name.replace("\\", "/").lstrip("/").split())


def _header(opened: Zip, info: ZipInfo, stack: ExitStack) -> ET.Element:
    name = f"{opened.path}, {info.filename}"
    data = member(opened, info, stack).read(_MOST + 1)
    if len(data) > _MOST:
        raise FileError(f"{name}: is longer than {_MOST} bytes, as no header is; give another file")
    try:
        return ET.fromstring(data, ET.XMLParser(target=_Undeclared()))
    except FileError as error:
        raise FileError(f"{name}: can't be read ({error}); give another file") from None
    except ET.ParseError as error:
        raise FileError(f"{name}: is no XML ({error}); copy the file anew") from None


def _raw(element: ET.Element, name: str) -> _Raw:
    """Return what an entry of the header says."""
    place = _plain(element.text or "")
    attributes = {key.casefold(): value for key, value in element.attrib.items()}

    def whole(key: str, usual: str = "") -> int | None:
        text = attributes.get(key.casefold(), usual).strip()
        if not text:
            return None
        if not re.fullmatch(r"\d{1,12}", text, re.ASCII):
            raise DatasetError(f"{name}: {key} of {place} is {text[:60]!r}; it should be a number")
        return int(text)

    samples, each = whole("SizeZ"), whole("BytesPerPixel", "2")
    if not samples or each not in (1, 2, 4):
        raise DatasetError(
            f"{name}: {place} has SizeZ {samples} and BytesPerPixel {each}; it should have samples "
            "of 1, 2 or 4 bytes"
        )
    scan = whole("ScanRegionStart0"), whole("ScanRegionEnd0")
    scanned = (scan[0], scan[1]) if scan[0] is not None and scan[1] is not None else None
    signed = attributes.get("signed", "").casefold() in ("true", "1")
    return _Raw(place, samples, each, signed, whole("SizeX"), scanned)


def _part(opened: Zip, members: dict[str, ZipInfo], raw: _Raw, stack: ExitStack) -> Source:
    """Return the spectra of one file in the zip."""
    if _place(raw.place) not in members:
        raise DatasetError(
            f"{opened.path}: {raw.place} is named in Header.xml, and not there; copy the file anew"
        )
    info = members[_place(raw.place)]
    row = raw.samples * raw.each
    count = raw.spectra if raw.spectra is not None else info.file_size // row
    if info.file_size != count * row or not count:
        raise DatasetError(
            f"{opened.path}: {raw.place} has {info.file_size} bytes, and {count} spectra of "
            f"{raw.samples} samples take {count * row}; copy the file anew"
        )
    first, last = raw.scanned or (0, count)
    if not first < last <= count:
        raise DatasetError(
            f"{opened.path}: {raw.place} has {count} spectra, and its scan is said to be from "
            f"{first} to {last}; copy the file anew"
        )
    dtype = np.dtype(f"<{'i' if raw.signed else 'u'}{raw.each}")
    return array_in(opened, info, dtype, (last - first, raw.samples), first * row, stack)
