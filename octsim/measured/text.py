"""Recordings in text: tables of any program, and what OceanView and ThorSpectra write."""

import re
from collections.abc import Sequence
from pathlib import Path

from octsim.base.errors import DatasetError
from octsim.config.units import find_unit
from octsim.measured.blocks import Blocks
from octsim.measured.inside import described, empty
from octsim.measured.names import is_counting, plausible, spanned, times_of, unit_of
from octsim.measured.recording import Recording, Values, Wanted
from octsim.measured.sides import Signs, told
from octsim.measured.text_form import find_form
from octsim.measured.text_lines import read_text
from octsim.measured.text_numbers import Table, read_numbers
from octsim.measured.text_table import Laid, Read, both, columns, laid_by_headings, rows
from octsim.phase.measured_headings import Heading

_AXIS = re.compile(
    r"#?\s*x[ _-]?axis[ _-]?(?:unit|mode)s?\s*[:;,=\t]\s*(.+?)[\s;,]*", re.IGNORECASE
)
_OCEANVIEW = re.compile(r">{3,}\s*begin", re.IGNORECASE)
_MODES = {
    "wavelengths": Heading("wavelength", "nm"), "wavelength": Heading("wavelength", "nm"),
    "wavenumbers": Heading("wavenumber", "1/cm"), "wavenumber": Heading("wavenumber", "1/cm"),
}  # fmt: skip
"""What OceanView calls its axis."""


def text_recording(path: Path, wanted: Wanted) -> Recording:
    """Return the recording in a text, which is read whole.

    Headings tell what is what; else what stands above or beside the counts and may be wavelengths;
    else `octsim.measured.sides.told`. Counts are real numbers, as a text does not say of how many
    bits they are.

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
    said = (*written, form.said)
    if laid is None:
        return _untold(read, wanted, said)
    if not laid.counts.shape[0] and laid.axis is not None and wanted.samples is None:
        return empty(laid.axis, str(path), (*said, *laid.notes))
    samples = laid.counts.shape[1]
    found = told(laid.counts, Signs(1, 0, samples), wanted.samples, wanted.x, str(path))
    counts = Blocks(found.source, found.sides, str(path))
    what = described(counts.shape, laid.by)
    return Recording(counts, laid.axis, laid.time, str(path), (*said, what, *laid.notes))


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
    said = f"row {read.form.row} is taken for wavelengths in {unit}, {spanned(axis.values)}"
    return rows(read._replace(table=below), skipped + read.form.lead, axis, "the first row", said)


def _beside(read: Read) -> Laid | None:
    """Return the spectra as columns, if the first one may be of wavelengths; None if it may not."""
    first = read.numbers[:, 0]
    unit = plausible(first)
    if unit is not None:
        heading = Heading("wavelength", unit)
        found = columns(read, 0, heading, "the first column, which is taken for wavelengths")
    else:
        unit = plausible(first[1:])
        if unit is None or read.form.top:
            return None
        above = tuple(f"{value:.17g}" for value in read.numbers[0])
        below = read._replace(
            form=read.form._replace(top=above, top_row=read.form.row),
            table=Table([], read.numbers[1:]),
        )
        by = "the first column, which is taken for wavelengths"
        found = columns(below, 0, Heading("wavelength", unit), by)
    return found


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
