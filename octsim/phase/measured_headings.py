"""Headings of measured data: what a column or a variable holds, and in which unit."""

import difflib
import re
from collections import Counter
from collections.abc import Mapping, Sequence
from typing import NamedTuple

from octsim.config.units import find_unit


class Quantity(NamedTuple):
    """What may stand under a heading."""

    dimension: str
    units: tuple[str, ...]
    """Units that are proposed; without a word it is the first."""
    largest: float
    """Unit that is taken at most, in the dimension's base unit: 'Ms' is no 'ms'."""


class Heading(NamedTuple):
    """A heading that is known."""

    name: str
    unit: str | None
    """As it is written; None without one."""


_ANGLE = Quantity("angle", ("rad", "mrad", "deg"), 1.0)
QUANTITIES: Mapping[str, Quantity] = {
    "time": Quantity("time", ("s", "ms", "us"), 3600.0),
    "phase": _ANGLE,
    "phase_error": _ANGLE,
    "wavelength": Quantity("length", ("nm", "um"), 1e6),
    "wavenumber": Quantity("inverse length", ("1/um", "rad/um", "1/nm"), 1e6),
}
"""What is read, by its name in a heading."""
_NAMES = {
    name: re.compile(name.replace("_", r"[\s_-]*") + r"(?![^\W\d_])\s*(.*)", re.IGNORECASE)
    for name in sorted(QUANTITIES, key=len, reverse=True)  # phase_error before phase
}
_BRACKETS = re.compile(r"[(\[{]\s*(.*?)\s*[)\]}]")
_ERROR = re.compile(
    r"(?:\b|(?<=phase)|(?<=phi)|(?<=φ))(?:errs?|errors?|std|stderr|stdev|stddev|sd|se|"
    r"sem|sigma|σ|unc|uncert|precision|jitter|ci ?\d\d|tolerance|tol|accuracy|spread|"
    r"fehler|unsicherheit|erreur|incertitude|"
    r"uncertainty|uncertainties|deviation|dev|rmse?|variance|var|noise)(?:\b|(?=phase|phi|φ))"
)
_PHASE = re.compile(r"phase|phi|φ|\bm?rad\b|deg|°")
_OF_PHASE = re.compile(r"(?:d|delta|δ|e|u|s|σ)[\W_]*(?:phase|phi|φ)\W*")
"""As formulas name the error of a phase: ``dphi``, ``u(phase)``."""
_ALIKE = 0.8
"""Likeness of a name and a known one, from which it is taken for one misspelt."""


def parse(text: str) -> Heading | None:
    """Return what a heading is known as, such as ``phase (mrad)``, ``Phase/mrad``, ``phase_mrad``.

    Case, and whether a space, a hyphen or nothing stands for an underscore, make no difference. A
    unit stands in brackets or behind a slash, whatever it is; else only one that is known is one.
    """
    text = " ".join(text.split())
    for name, pattern in _NAMES.items():
        match = pattern.fullmatch(text)
        if match is None:
            continue
        rest = match[1]
        if not rest:
            return Heading(name, None)
        bracketed = _BRACKETS.fullmatch(rest.removeprefix("/").strip())
        if bracketed:
            return Heading(name, bracketed[1] or None)
        if rest.startswith("/"):
            return Heading(name, rest[1:].strip())
        unit = re.sub(r"^[\s_,:-]*(?:in\s+)?", "", rest)
        return Heading(name, unit) if _fits(name, unit) else None
    return None


def _fits(name: str, unit: str) -> bool:
    """Whether something of that name may have that unit."""
    known, quantity = find_unit(unit), QUANTITIES[name]
    fits = known is not None and known.dimension == quantity.dimension
    return fits and known is not None and float(known.size) <= quantity.largest


def factor(heading: Heading) -> float:
    """Return the size of a heading's unit: in s, rad, µm or 1/µm."""
    known = find_unit(heading.unit or QUANTITIES[heading.name].units[0])
    if known is None:
        raise ValueError(f"{heading.unit!r} is no unit")
    return float(known.size)


def places(headings: Sequence[str], names: Sequence[str]) -> dict[str, tuple[int, Heading]]:
    """Return where each of the names stands, for those that do, and as what."""
    parsed = [parse(text) for text in headings]
    return {
        heading.name: (place, heading)
        for place, heading in enumerate(parsed)
        if heading is not None and heading.name in names
    }


def problem(
    headings: Sequence[str], needed: Sequence[str], optional: Sequence[str], form: str
) -> str | None:
    """Return in a line what is wrong with headings, if something is.

    Other headings may stand beside, but for those that may be meant as one that is not there.

    Parameters
    ----------
    headings : sequence of str
    needed, optional : sequence of str
        Names that have to be there, and that may be.
    form : str
        How headings stand in a file, for what is said where one is not there.
    """
    names = (*needed, *optional)
    parsed = [parse(text) for text in headings]
    counts = Counter(one.name for one in parsed if one is not None and one.name in names)
    for name in needed:
        if name not in counts:
            return _missing(name, headings, form)
    for name, count in counts.items():
        if count > 1:
            alike = [headings[at] for at, one in enumerate(parsed) if one and one.name == name]
            return (
                f"{count} headings are of {name} ({listed(alike)}), and only one can be read; "
                "leave one, and rename the others, such as 'channel 2'"
            )
    read = [one for one in parsed if one is not None and one.name in counts]
    for one in read:
        if one.unit is not None and not _fits(one.name, one.unit):
            return unknown_unit(one)
        kin = [other for other in read if _dimension(other) == _dimension(one) and other.unit]
        if one.unit is None and kin:
            return (
                f"{kin[0].name} is in {kin[0].unit}, and {one.name} has no unit; write "
                f"'{one.name} ({kin[0].unit})' if it has the same"
            )
    others = [text for text, one in zip(headings, parsed, strict=True) if one is None]
    for name in optional:
        meant = [text for text in others if _may_be(text, name)]
        units = [one.unit for one in read if one.unit and _fits(name, one.unit)]
        if name not in counts and meant:
            return (
                f"the heading {meant[0]!r} is not known; write "
                f"{_proposed(name, meant[0], units)} if it is that, else another name"
            )
    return None


def _dimension(heading: Heading) -> str:
    return QUANTITIES[heading.name].dimension


def unknown_unit(heading: Heading) -> str:
    """Return in a line that a heading's unit is none of what it names."""
    known = ", ".join(QUANTITIES[heading.name].units)
    return f"the unit of {heading.name} is {heading.unit!r}; the known ones are such as {known}"


def _missing(name: str, headings: Sequence[str], form: str) -> str:
    if not headings:
        return f"it holds no '{name}'; write a heading {_proposed(name)}"
    meant = [text for text in headings if parse(text) is None and _may_be(text, name)]
    proposed = _proposed(name, *meant[:1])
    instead = f" in place of {meant[0]!r}" if meant else ""
    return (
        f"it holds no '{name}' under the headings {listed(headings)}; write {proposed}{instead}, "
        f"{form}"
    )


def _proposed(name: str, meant: str = "", others: Sequence[str] = ()) -> str:
    """Return how to write a heading: in the unit of the one that is meant, else of others."""
    written = re.search(r"[(\[{/]\s*([^)\]}]*)", meant) or re.search(r"[_\s](\S+)$", meant)
    unit = written[1].strip() if written else ""
    known = [unit] if _fits(name, unit) else [*others, *QUANTITIES[name].units]
    return f"'{name} ({known[0]})'"


_SHORT = {
    "time": ("t", "zeit"),
    "phase": ("phi", "φ", "ph"),
    "phase_error": ("phaseerr",),
}


def of_errors(text: str) -> bool:
    """Return whether a heading speaks of errors, such as ``sigma (mrad)`` or ``s1_std``."""
    return "±" in text or "+/-" in text or _ERROR.search(_words(text)) is not None


def _words(text: str) -> str:
    return re.sub(r"[\W_]+", " ", text.casefold()).strip()


def _may_be(text: str, name: str) -> bool:
    """Whether a heading that is not known may be meant as one of that name."""
    plain = _words(re.split(r"[(\[{/]", text)[0])
    letters = plain.replace(" ", ""), name.replace("_", "")
    if plain in _SHORT[name] or difflib.SequenceMatcher(None, *letters).ratio() > _ALIKE:
        return True
    if name != "phase_error":
        return (plain.startswith(name) or name in plain.split()) and not of_errors(text)
    if _OF_PHASE.fullmatch(plain) or _OF_PHASE.fullmatch(text.casefold()):
        return True
    alone = not _ERROR.sub("", plain).replace("standard", "").strip()
    return of_errors(text) and (alone or _PHASE.search(text.casefold()) is not None)


def listed(headings: Sequence[str]) -> str:
    """Return some headings as a part of a line."""
    shown = ", ".join(repr(text) for text in headings[:6])
    return shown if len(headings) <= 6 else f"{shown}, ..."
