"""Names of what spectrometers write: headings, datasets and dimensions, with their units."""

import re
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from octsim.base.errors import DatasetError
from octsim.config.units import find_unit
from octsim.measured.recording import Values
from octsim.phase.measured_headings import QUANTITIES, Heading, parse, unknown_unit

Array = NDArray[np.float64]
AXES = ("wavelength", "wavenumber")
FEWEST = 8
"""Fewest numbers that are taken for an axis without a name."""
_ALIASES = {
    name: re.compile(rf"(?:{alias})(?![^\W\d_])(.*)", re.IGNORECASE)
    for name, alias in {
        "wavelength": "wave[ _-]?lengths?|lambdas?|λ|wls?|lam|wellenlängen?",
        "wavenumber": "wave[ _-]?numbers?|wellenzahl(?:en)?|(?-i:k)",
        "time": "time[ _-]?stamps?|elapsed[ _-]?time|times?|zeit|(?-i:t)",
    }.items()
}
"""What labs write for a name, apart from it; K is a temperature, and so is T."""
_OF_AN_AXIS = re.compile(r"[ _-](?:axis|array|vector|vec|values|vals)(?=$|[ _(\[/])", re.IGNORECASE)
_WORDS = {"sec": "s", "secs": "s", "msec": "ms", "usec": "us", "nsec": "ns"}
_BARE = {"length": ("wavelength", 1), "inverse length": ("wavenumber", 1e9), "time": ("time", 1)}
"""What a heading that is a unit alone is of, and the largest such unit."""
_PLAUSIBLE = {"nm": (200.0, 20000.0), "um": (0.2, 20.0), "m": (0.2e-6, 20e-6)}
"""Wavelengths that are taken to be in a unit that is not written."""
_COUNTS = re.compile(r"(?:pixels?|samples?|index|indices|no\.?|nr\.?|#|px)\W*(?:no|nr|number)?\W*")


def known(text: str) -> Heading | None:
    """Return what a name is known as: as `parse` does, and by what labs write for it.

    Examples
    --------
    >>> known("Lambda [nm]"), known("t_ms"), known("nm"), known("dark")
    (Heading(name='wavelength', unit='nm'), Heading(name='time', unit='ms'), \
Heading(name='wavelength', unit='nm'), None)
    """
    text = _OF_AN_AXIS.sub("", " ".join(text.split()))
    heading = parse(text)
    if heading is not None:
        return heading
    for name, alias in _ALIASES.items():
        match = alias.fullmatch(text)
        found = parse(name + match[1]) if match else None
        if found is not None:
            return found
    unit = text.strip("()[]{} ")
    of_unit = find_unit(unit)
    name, largest = _BARE.get(of_unit.dimension if of_unit else "", ("", 0.0))
    return Heading(name, unit) if of_unit is not None and of_unit.size <= largest else None


def last_of(name: str) -> str:
    """Return the last part of a name in a file, as ``wavelength`` of ``/raw/wavelength``."""
    return re.split(r"[/.]", name.strip("/"))[-1]


def counts_samples(text: str) -> bool:
    """Return whether a heading is of numbers that only count: ``pixel``, ``index``, ``#``."""
    return _COUNTS.fullmatch(text.casefold().strip()) is not None


def unit_of(text: str) -> str:
    """Return a unit as `find_unit` knows it, where it does.

    Examples
    --------
    >>> unit_of("[sec]"), unit_of("nm_air"), unit_of("seconds since 2024-05-01"), unit_of("furlong")
    ('s', 'nm', 'seconds', 'furlong')
    """
    text = text.strip().strip("()[]{} ").partition(" since ")[0].strip()
    text = re.sub(r"[_ ]\(?(?:air|vac|vacuum)\)?$", "", text)
    if find_unit(text) is not None:
        return text
    word = _WORDS.get(text.casefold(), text.casefold())
    return word if find_unit(word) is not None else text


def plausible(values: Array, unit: str | None = None) -> str | None:
    """Return the unit of numbers that may be wavelengths, rising or falling; None if they are none.

    Parameters
    ----------
    values : ndarray, shape (N,)
    unit : str or None
        The only one that they may be in, else nm or um.
    """
    if values.size < FEWEST or not np.isfinite(values).all():
        return None
    steps = np.diff(values) * np.sign(values[-1] - values[0])
    if not (steps > 0).all():
        return None
    return next((one for one in ([unit] if unit else ["nm", "um"]) if _within(values, one)), None)


def _within(values: Array, unit: str) -> bool:
    low, high = _PLAUSIBLE.get(unit, (0.0, np.inf))
    return bool((values >= low).all() and (values <= high).all())


def with_unit(values: Array, heading: Heading, where: str) -> tuple[Values, str]:
    """Return numbers with the unit that they are written in, else with the likely one.

    Parameters
    ----------
    values : ndarray, shape (N,)
    heading : Heading
        What they are, and their unit, if it is written.
    where : str
        Where they stand, for what is said of them.

    Returns
    -------
    Values
    str
        What is to be said of the unit; empty where it is written.

    Raises
    ------
    DatasetError
        If it is none of theirs, or is not written and not likely.
    """
    name = heading.name
    if heading.unit:
        unit = unit_of(heading.unit)
        known_unit = find_unit(unit)
        if known_unit is None or known_unit.dimension != QUANTITIES[name].dimension:
            raise DatasetError(f"{where}: {unknown_unit(heading)}")
        return Values(values, name, unit), ""
    if name == "time":
        return Values(values, name, "s"), "; it has no unit, and is taken to be in s"
    lengths = values
    if name == "wavenumber":
        with np.errstate(divide="ignore"):
            lengths = 2 * np.pi / values
    units = {"um": "1/um"} if name == "wavenumber" else {unit: unit for unit in _PLAUSIBLE}
    for length, unit in units.items():
        if values.size and _within(lengths, length):
            return Values(values, name, unit), f"; it has no unit, and is taken to be in {unit}"
    example = QUANTITIES[name].units[0]
    raise DatasetError(
        f"{where}: {name} has no unit, and {spanned(values)} is none of a spectrometer in a likely "
        f"one; write it as '{name} ({example})', or as an attribute units"
    )


def spanned(values: Array) -> str:
    """Return where numbers begin and end, as a part of a line."""
    return f"{values[0]:.6g} to {values[-1]:.6g}" if values.size else "nothing"


def told_as(what: str, values: Values, unsaid: str) -> str:
    """Return the line that says what was taken for an axis or for times.

    Parameters
    ----------
    what : str
        Where they stand.
    values : Values
    unsaid : str
        Of `with_unit`; what had to be guessed is said as a warning.
    """
    line = f"{values.name} is {what}, {spanned(values.values)} {values.unit}{unsaid}"
    return f"warning: {line}" if unsaid else line


def is_counting(values: Array) -> bool:
    """Return whether numbers only count: 0, 1, 2, or 1, 2, 3."""
    return bool(
        values.size > 0
        and values[0] in (0, 1)
        and (values == values[0] + np.arange(values.size)).all()
    )


def rising(values: Array) -> bool:
    """Return whether numbers rise, each above the one before."""
    return bool(np.isfinite(values).all() and (np.diff(values) > 0).all())


_TIME = re.compile(
    r"(?:t(?:ime)?\s*[=:]?\s*)?([-+]?(?:\d+[.,]?\d*|[.,]\d+)(?:e[-+]?\d+)?)[\s_]*\(?([^\W\d_]*)\)?",
    re.IGNORECASE,
)


def times_of(headings: Sequence[str]) -> tuple[Values | None, str]:
    """Return the times that stand as headings of spectra, and what is to be said of them.

    Headings that are numbers without a unit are times in s where they rise and don't just count.
    """
    matches = [_TIME.fullmatch(text.strip()) for text in headings]
    if not headings or not all(matches):
        return None, ""
    values = np.array([float(one[1].replace(",", ".")) for one in matches if one])
    units = {unit_of(one[2]) for one in matches if one}
    unit = units.pop() if len(units) == 1 else None
    found = find_unit(unit) if unit else None
    if unit and found is not None and found.dimension == "time":
        return Values(values, "time", unit), f"headings are times in {unit}: {spanned(values)}"
    if unit != "" or values.size < 2 or is_counting(values) or not rising(values):
        return None, "headings are numbers, and not taken for times"
    return Values(values, "time", "s"), (
        f"warning: headings are taken for times in s, as they rise: {spanned(values)}"
    )
