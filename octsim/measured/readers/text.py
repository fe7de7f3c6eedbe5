"""Recordings in text: tables of any program, and what OceanView and ThorSpectra write."""

import re
from collections.abc import Iterator, Sequence
from pathlib import Path

from octsim.base.errors import DatasetError
from octsim.config.units import find_unit
from octsim.measured.readers.blocks import Blocks
from octsim.measured.readers.inside import described, empty
from octsim.measured.readers.names import is_counting, plausible, times_of, told_as, unit_of
from octsim.measured.readers.sides import Signs, told
from octsim.measured.readers.text_form import find_form
from octsim.measured.readers.text_lines import read_text
from octsim.measured.readers.text_numbers import Table, read_numbers
from octsim.measured.readers.text_table import Laid, Read, both, columns, laid_by_headings, rows
from octsim.measured.recording import Recording, Values, Wanted
from octsim.phase.measured_headings import Heading

_AXIS = re.compile(
    r"#?\s*x[ _-]?axis[ _-]?(?:unit|mode)s?\s*[:;,=\t]\s*(.+?)[\s;,]*", re.IGNORECASE
)
_OCEANVIEW = re.compile(r">{3,}\s*begin", re.IGNORECASE)
_SECTION = re.compile(r"\[Data\]", re.IGNORECASE)
_END = re.compile(rb"^\[End", re.IGNORECASE | re.MULTILINE)
_PIXELS = re.compile(r"Number of Pixels in Spectrum:\s*(\d{1,9})", re.ASCII)
_MODES = {
    "wavelengths": Heading("wavelength", "nm"), "wavelength": Heading("wavelength", "nm"),
    "wavenumbers": Heading("wavenumber", "1/cm"), "wavenumber": Heading("wavenumber", "1/cm"),
}  # fmt: skip
"""What OceanView calls its axis."""


def text_recording(path: Path, wanted: Wanted) -> Recording:
    """Return the recording in a text, which is read whole.

    Headings tell what is what; else what stands above or beside the counts and may be wavelengths;
    else `octsim.measured.readers.sides.told`. Counts are real numbers, as a text does not say of
    how many bits they are.

    Raises
    ------
    OctsimError
        If it is no such text.
    """
    text = read_text(path)
    form = find_form(path, text)
    table = read_numbers(path, text, form)
    ocean = any(_OCEANVIEW.match(line) for line in form.header)
    read = Read(path, form, table, _axis(path, form.header), ocean)
    laid = laid_by_headings(read, wanted.samples) or _laid_by_numbers(read, wanted.samples)
    written = () if text.encoding == "UTF-8" else (f"it is written in {text.encoding}",)
    samples = laid.counts.shape[1] if laid else max(table.numbers.shape)
    said = (*written, form.said, *_doubts(text.data, form.header, samples))
    if laid is None:
        return _untold(read, wanted, said)
    if not laid.counts.shape[0] and laid.axis is not None and wanted.samples is None:
        return empty(laid.axis, str(path), (*said, *laid.notes))
    found = told(laid.counts, Signs(1, 0, samples), wanted.samples, wanted.x, str(path))
    counts = Blocks(found.source, found.sides, str(path))
    what = described(counts.shape, laid.by)
    return Recording(counts, laid.axis, laid.time, str(path), (*said, what, *laid.notes))


def _doubts(data: bytes, header: Sequence[str], samples: int) -> Iterator[str]:
    """Return what says that a text may be cut short, as nothing in it contradicts that."""
    if not data.endswith(b"\n"):
        yield "warning: its last line has no end, and may be cut short"
    if any(_SECTION.match(line) for line in header) and not _END.search(data[-4096:]):
        yield "warning: [EndOfFile] does not stand at its end, and the file may be cut short"
    pixels = [int(match[1]) for line in header if (match := _PIXELS.fullmatch(line.strip()))]
    if pixels and pixels[-1] != samples:
        yield f"warning: it has {samples} samples, and its header speaks of {pixels[-1]} pixels"


def _axis(path: Path, header: Sequence[str]) -> Heading | None:
    """Return what a header says that the axis is.

    Raises
    ------
    DatasetError
        If it is neither a wavelength nor a wavenumber.
    """
    found = [match[1] for line in header if (match := _AXIS.fullmatch(line.strip()))]
    if not found or found[-1].casefold() == "pixels":
        return None
    mode = _MODES.get(found[-1].casefold())
    unit = find_unit(unit_of(found[-1]))
    names = {"length": "wavelength", "inverse length": "wavenumber"}
    if mode is None and unit is not None and unit.dimension in names:
        mode = Heading(names[unit.dimension], unit_of(found[-1]))
    if mode is None:
        raise DatasetError(
            f"{path}: its header says that the axis is in {found[-1][:60]!r}; save the spectra "
            "over wavelengths in nm"
        )
    return mode


def _laid_by_numbers(read: Read, samples: int | None) -> Laid | None:
    """Return the spectra as rows or columns that may be wavelengths tell them; None if none do."""
    numbers, lead = read.numbers, read.form.lead
    if not lead and read.axis is not None and len(numbers) > 1:
        return columns(read, 0, read.axis, "the header")
    if not lead and min(numbers.shape) > 1 and is_counting(numbers[:, 0]):
        found = _laid_by_numbers(_without_first(read), samples)
        note = "the first column is not read, as it does but count"
        return found._replace(notes=(note, *found.notes)) if found else None
    if min(numbers.shape) < 2:
        return None
    either = (_over_rows(read), None if lead else _beside(read))
    likely = [one for one in either if one and samples in (None, one.counts.shape[1])]
    if len(likely) > 1:
        raise both(read)
    return likely[0] if likely else None


def _without_first(read: Read) -> Read:
    """Return a text without its first column."""
    form = read.form._replace(columns=read.form.columns - 1, top=read.form.top[1:])
    return read._replace(form=form, table=Table(read.table.lead, read.numbers[:, 1:]))


def _over_rows(read: Read) -> Laid | None:
    """Return the spectra as rows, if the first one may be of wavelengths; None if it may not."""
    if read.form.top:
        return None
    first = read.numbers[0]
    skipped = 0 if plausible(first) else 1
    unit = plausible(first[skipped:])
    if unit is None or (skipped and read.form.lead):
        return None
    axis = Values(first[skipped:], "wavelength", unit)
    below = Table(read.table.lead[1:], read.numbers[1:])
    what = f"row {read.form.row}"
    said = told_as(what, axis, f"; nothing says so, but it may be of wavelengths in {unit}")
    return rows(read._replace(table=below), skipped + read.form.lead, axis, "the first row", said)


def _beside(read: Read) -> Laid | None:
    """Return the spectra as columns, if the first one may be of wavelengths; None if it may not."""
    first = read.numbers[:, 0]
    if not plausible(first):
        if read.form.top or not plausible(first[1:]):
            return None
        # the first row is of what the spectra are of, as their times
        top = tuple(f"{value:.17g}" for value in read.numbers[0])
        form = read.form._replace(top=top, top_row=read.form.row)
        read = read._replace(form=form, table=Table([], read.numbers[1:]))
    by = "the first column, which may be of wavelengths"
    return columns(read, 0, Heading("wavelength", None), by)


def _untold(read: Read, wanted: Wanted, said: Sequence[str]) -> Recording:
    """Return numbers without an axis, whose rows or columns are spectra by their length."""
    notes = list(said)
    if min(read.numbers.shape) > 1 and is_counting(read.numbers[:, 0]) and not read.form.lead:
        read = _without_first(read)
        notes.append("the first column is not read, as it does but count")
    name = str(read.path)
    found = told(read.numbers, Signs(), wanted.samples, wanted.x, name)
    counts = Blocks(found.source, found.sides, name)
    by_columns = found.sides.samples == 0 and read.form.top
    time, of_times = times_of(read.form.top) if by_columns else (None, "")
    notes += [described(counts.shape, found.by), *([of_times] if of_times else [])]
    if time is not None and time.values.size != counts.shape[0]:
        time = None
    return Recording(counts, None, time, name, tuple(notes))
