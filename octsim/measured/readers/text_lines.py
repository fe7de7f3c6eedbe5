"""Text files as their lines and cells, whatever wrote them."""

import codecs
import csv
import re
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

from octsim.base.errors import FileError
from octsim.phase.measured_tables import split

BLANKS = " "
"""Stands for any number of blanks between cells."""
SEPARATORS = ("\t", ";", ",", BLANKS)
_NUMBERS = {
    point: re.compile(
        rf"[-+]?(?:\d+(?:{end})?|{mark}\d+)(?:[eE][-+]?\d+)?|[-+]?(?:nan|inf|infinity)",
        re.ASCII | re.IGNORECASE,
    )
    for point, mark, end in ((".", r"\.", r"\.\d*"), (",", ",", r",\d+"))
}
"""What a number is, by its decimal mark."""
_HEADINGS = re.compile(r"(?:\([^)]*\)|\[[^\]]*\]|\S)+(?:\s+(?:\([^)]*\)|\[[^\]]*\]))?")


class Line(NamedTuple):
    """A line of a file."""

    row: int
    """Counted from 1."""
    start: int
    """Byte that it begins at."""
    text: str


class Text(NamedTuple):
    """A text in UTF-8, with one kind of line end."""

    data: bytes
    encoding: str
    """That it was written in."""


def read_text(path: Path) -> Text:
    """Read a text, in UTF-8, UTF-16 with its mark, or Windows-1252.

    Raises
    ------
    FileError
        If it is none.
    """
    data = path.read_bytes()
    encoding = "UTF-8"
    if data.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)):
        data, encoding = _decoded(path, data, "utf-16").encode(), "UTF-16"
    data = data.removeprefix(codecs.BOM_UTF8)
    if b"\0" in data:
        row = 1 + data.count(b"\n", 0, data.index(b"\0"))
        raise FileError(
            f"{path}, row {row}: a byte 0x00, as no text has; give measured.raw (dtype and shape) "
            "if it is raw binary, else copy the file anew"
        )
    if not _is_utf_8(data):
        data, encoding = _decoded(path, data, "cp1252").encode(), "Windows-1252"
    if b"\r" in data:
        data = data.replace(b"\r\n", b"\n").replace(b"\r", b"\n")
    return Text(data, encoding)


def _is_utf_8(data: bytes) -> bool:
    if data.isascii():
        return True
    try:
        data.decode()
    except UnicodeDecodeError:
        return False
    return True


def _decoded(path: Path, data: bytes, encoding: str) -> str:
    try:
        return data.decode(encoding)
    except UnicodeDecodeError as error:
        row = 1 + data.count(b"\n", 0, error.start)
        raise FileError(
            f"{path}, row {row}: byte 0x{data[error.start]:02x} is no text in UTF-8, UTF-16 or "
            "Windows-1252; save it in UTF-8, or give measured.raw if it is raw binary"
        ) from None


def lines(data: bytes, start: int, row: int, end: int) -> Iterator[Line]:
    """Return the lines between two bytes of a text, the first of which is some row of it."""
    while start < end:
        stop = data.find(b"\n", start, end)
        stop = end if stop < 0 else stop
        yield Line(row, start, data[start:stop].decode("utf-8", "replace"))
        start, row = stop + 1, row + 1


def is_note(text: str) -> bool:
    """Return whether a line is one of notes."""
    return text.lstrip().startswith("#")


def is_empty(text: str) -> bool:
    """Return whether a line has nothing in it, or cells with nothing in them."""
    return not text.strip(" \t\r,;")


def cut(text: str, separator: str) -> list[str]:
    """Return the cells of a line, but for empty ones at its end."""
    if separator == BLANKS:
        return text.split()
    if '"' in text:
        try:
            cells = split(text, separator)
        except csv.Error:  # a quote that is left open: the cell is none of a number then
            cells = text.split(separator)
    else:
        cells = text.split(separator)
    cells = [cell.strip() for cell in cells]
    while cells and not cells[-1]:
        cells.pop()
    return cells


def cut_headings(text: str, separator: str) -> list[str]:
    """Return the headings in a line: a unit in brackets stands with what is before it."""
    if separator == BLANKS:
        return [one.group().strip() for one in _HEADINGS.finditer(text)]
    return cut(text, separator)


def is_number(cell: str, point: str) -> bool:
    """Return whether a cell is a number with that decimal mark."""
    return _NUMBERS[point].fullmatch(cell) is not None
