"""Quantities with their unit: read from text, kept as numbers, written back as text.

A unit is a row of one table, with its dimension. Another quantity of the config takes a `Quantity`
and a named type, as `LENGTH` and `Length` are.
"""

import difflib
import re
from collections.abc import Callable, Mapping
from decimal import Decimal, DecimalException
from functools import cache, lru_cache, partial
from typing import Annotated, Any, NamedTuple

from pydantic import BeforeValidator, PlainSerializer, WithJsonSchema


class Unit(NamedTuple):
    """What a unit measures, and how much of it."""

    dimension: str
    size: Decimal
    """How many of its dimension's base units it is: um, s, Hz, rad, 1/um and, else, SI's."""


PREFIXES: Mapping[str, tuple[tuple[str, ...], int]] = {
    "quecto": (("q",), -30), "ronto": (("r",), -27), "yocto": (("y",), -24),
    "zepto": (("z",), -21), "atto": (("a",), -18), "femto": (("f",), -15), "pico": (("p",), -12),
    "nano": (("n",), -9), "micro": (("u", "\u00b5", "\u03bc"), -6), "milli": (("m",), -3),
    "centi": (("c",), -2), "deci": (("d",), -1), "deca": (("da",), 1), "hecto": (("h",), 2),
    "kilo": (("k",), 3), "mega": (("M",), 6), "giga": (("G",), 9), "tera": (("T",), 12),
    "peta": (("P",), 15), "exa": (("E",), 18), "zetta": (("Z",), 21), "yotta": (("Y",), 24),
    "ronna": (("R",), 27), "quetta": (("Q",), 30),
}  # fmt: skip
"""SI's prefixes: the symbols and the power of ten of each."""

# dimension, symbol, names and size of what takes prefixes
_PREFIXED = (
    ("length", "m", ("meter", "meters", "metre", "metres"), "1e6"),
    ("time", "s", ("second", "seconds"), "1"),
    ("frequency", "Hz", ("hertz",), "1"),
    ("angle", "rad", ("radian", "radians"), "1"),
    ("mass", "g", ("gram", "grams"), "1e-3"),
    ("temperature", "K", ("kelvin",), "1"),
    ("current", "A", ("ampere", "amperes"), "1"),
    ("voltage", "V", ("volt", "volts"), "1"),
    ("power", "W", ("watt", "watts"), "1"),
    ("energy", "J", ("joule", "joules"), "1"),
    ("energy", "eV", ("electronvolt", "electronvolts"), "1.602176634e-19"),
    ("force", "N", ("newton", "newtons"), "1"),
    ("pressure", "Pa", ("pascal", "pascals"), "1"),
)
_DEGREE = "0.01745329251994329576923690768488612713"
# dimension, symbols and names, and size of what takes none
_PLAIN = (
    ("length", ("\u00c5", "\u212b", "angstrom", "angstroms", "ångström", "ångströms"), "1e-4"),
    ("length", ("\u00b5", "\u03bc", "micron", "microns"), "1"),
    ("length", ("in", "inch", "inches"), "25400"),
    ("length", ("mil", "mils", "thou"), "25.4"),
    ("length", ("ft", "foot", "feet"), "304800"),
    ("length", ("yd", "yard", "yards"), "914400"),
    ("time", ("min", "minute", "minutes"), "60"),
    ("time", ("h", "hour", "hours"), "3600"),
    ("angle", ("deg", "°", "degree", "degrees"), _DEGREE),
    ("ratio", ("%", "percent"), "0.01"),
)
_INVERSE = re.compile(r"(?:1|rad)\s*/\s*(\S+)|(\S+?)\s*(?:\^|\*\*)?\s*-1")
_PER = re.compile(r"([^\W\d_]+)\s*/\s*([^\W\d_]+?)((?:(?:\^|\*\*)?2|²)?)")
_NUMBER_PATTERN = r"[-+]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][-+]?[0-9]+)?"
_NUMBER = re.compile(rf"\s*{_NUMBER_PATTERN}\s*")
_COMMA = re.compile(r"^(\s*[-+]?[0-9]+),([0-9]+)")
_LONGEST = 500  # characters: what is longer takes long to be found none
_QUANTITY = re.compile(rf"\s*({_NUMBER_PATTERN})\s*([^\W\d_]\S*|[°%]|\s1?/\S+)\s*")


@cache
def known_units() -> Mapping[str, Unit]:
    """Return every unit by each way to write it, but for quotients of lengths."""
    units = {}
    for dimension, symbol, names, size in _PREFIXED:
        for prefix, (shorts, power) in {"": (("",), 0), **PREFIXES}.items():
            unit = Unit(dimension, Decimal(size).scaleb(power))
            spelt = (*(short + symbol for short in shorts), *(prefix + name for name in names))
            units.update(dict.fromkeys(spelt, unit))
    for dimension, spelt, size in _PLAIN:
        units.update(dict.fromkeys(spelt, Unit(dimension, Decimal(size))))
    return units


def find_unit(name: str) -> Unit | None:
    """Return the unit of a name, as ``um``, ``micrometers``, ``1/um``, ``nm/um`` or ``um/um^2``.

    It is None if it is not known.
    """
    unit = known_units().get(name)
    inverse = None if unit else known_units().get(inverted(name) or "")
    if inverse and inverse.dimension == "length":
        return Unit("inverse length", 1 / inverse.size)
    return unit or _quotient(name)


def _quotient(name: str) -> Unit | None:
    """Return the unit that is a length over a length, or over the square of one; None of others."""
    match = _PER.fullmatch(name)
    over, under = (known_units().get(match[place]) if match else None for place in (1, 2))
    if not (match and over and under) or {over.dimension, under.dimension} != {"length"}:
        return None
    if match[3]:
        return Unit("inverse length", over.size / under.size**2)
    return Unit("ratio", over.size / under.size)


def inverted(name: str) -> str | None:
    """Return what a unit is the inverse of: ``um`` for 1/um, rad/um, um-1, um^-1 and um**-1."""
    match = _INVERSE.fullmatch(name)
    return match[1] or match[2] if match else None


class Quantity(NamedTuple):
    """A quantity of the config."""

    dimension: str
    noun: str
    """What it is called, with its article."""
    unit: str
    """In which it is kept: the base unit of its dimension."""
    examples: tuple[str, ...]
    letters: str = "A-Za-z\u00b5\u03bc\u00c5\u212b\u00e5\u00f6"
    """Of its units."""

    @property
    def remedy(self) -> str:
        """What to do, where one is not given as it should be."""
        *first, last = self.examples
        return f"write it with its unit, such as {', '.join(first)} or {last}"


LENGTH = Quantity("length", "a length", "um", ("5 nm", "1.4 um", "0.3 mm"))
ANGLE = Quantity("angle", "an angle", "rad", ("30 deg", "0.5 rad"), "A-Za-z°")
ATTENUATION = Quantity(
    "inverse length", "an attenuation", "1/um", ("100 /cm", "10 /mm"), "A-Za-z\u00b5\u03bc1/^ -"
)
RATIO = Quantity(
    "ratio", "a length per length", "um/um", ("0.4 um/um", "400 nm/um"), "A-Za-z\u00b5\u03bc/%"
)
PER_LENGTH = Quantity(
    "inverse length", "a length per length squared", "1/um", ("0.2 um/um^2", "0.2 /um"),
    "A-Za-z\u00b5\u03bc12/^\u00b2 -",
)  # fmt: skip


_LENGTHS = {
    "length": "a length", "inverse length": "an inverse length", "ratio": "a length per length",
}  # fmt: skip
"""Dimensions that are easily taken for each other, with their articles."""


def parse(quantity: Quantity, text: object) -> float:
    """Read a quantity such as ``"5 nm"``.

    Parameters
    ----------
    quantity : Quantity
        What is asked for.
    text : object
        A number with a unit, as text.

    Returns
    -------
    float
        The number in the quantity's unit, correctly rounded.

    Raises
    ------
    ValueError
        If there is no unit, it is not one of that quantity, or the number is far out of range.
    """
    if isinstance(text, str):
        return _parsed(quantity, text)
    bare = isinstance(text, int | float) and not isinstance(text, bool)
    raise ValueError(_unreadable(quantity, bare))


@lru_cache(maxsize=100_000)  # the combinations of a grid repeat theirs
def _parsed(quantity: Quantity, text: str) -> float:
    if len(text) > _LONGEST:
        raise ValueError(_unreadable(quantity, bare=False))
    match = _QUANTITY.fullmatch(text)
    if match is None:
        pointed = _COMMA.sub(r"\1.\2", text)
        if pointed != text and _QUANTITY.fullmatch(pointed):
            raise ValueError(f"write it with a point, as {pointed.strip()}")
        raise ValueError(_unreadable(quantity, bare=_NUMBER.fullmatch(text) is not None))
    number, name = match[1], match[2].strip()
    name = f"1{name}" if name.startswith("/") else name
    unit = find_unit(name)
    if unit is None:
        nearest = _nearest(quantity, name)
        meant = f"; did you mean '{nearest}'?" if nearest else ""
        raise ValueError(f"'{name}' is not a unit that is known{meant}; {quantity.remedy}")
    dimensions = {unit.dimension, quantity.dimension}
    if len(dimensions) > 1 and dimensions <= _LENGTHS.keys() and name not in {"%", "percent"}:
        raise ValueError(
            f"{number} {match[2].strip()} is {_LENGTHS[unit.dimension]}; give "
            f"{_LENGTHS[quantity.dimension]}, as {quantity.examples[0]}"
        )
    if unit.dimension != quantity.dimension:
        raise ValueError(f"'{name}' is not a unit of {quantity.dimension}; {quantity.remedy}")
    try:
        # Decimals convert exactly: '650 nm' and '0.65 um' are the same float
        return float(Decimal(number) * unit.size)
    except DecimalException:
        raise ValueError(f"far out of range; {quantity.remedy}") from None


def _unreadable(quantity: Quantity, bare: bool) -> str:
    reason = f"{quantity.noun} needs its unit" if bare else f"not {quantity.noun}"
    return f"{reason}; {quantity.remedy}"


def _nearest(quantity: Quantity, name: str) -> str | None:
    names = [known for known, unit in known_units().items() if unit.dimension == quantity.dimension]
    alike = [known for known in names if known.lower() == name.lower()]
    return next(iter(alike or difflib.get_close_matches(name, names, n=1, cutoff=0.75)), None)


def parse_length(text: object) -> float:
    """Read a length such as ``"5 nm"``, in µm; see `parse`."""
    return parse(LENGTH, text)


def parse_angle(text: object) -> float:
    """Read an angle such as ``"30 deg"``, in rad; see `parse`."""
    return parse(ANGLE, text)


def written_in(unit: str) -> Callable[[float], str]:
    """Return what writes a number in a unit as text that `parse` reads back to the same bits.

    Examples
    --------
    >>> written_in("um")(0.005)
    '0.005 um'
    """
    return lambda number: f"{number!r} {unit}"


format_length, format_angle = written_in(LENGTH.unit), written_in(ANGLE.unit)
"""Write a length in µm, and an angle in rad."""


def schema_of(quantity: Quantity) -> dict[str, Any]:
    """Return the JSON Schema of a quantity as text."""
    return {
        "type": "string",
        "pattern": rf"^\s*({_NUMBER_PATTERN})\s*([{quantity.letters}]+)\s*$",
        "description": f"{quantity.noun} with its unit",
        "examples": list(quantity.examples),
    }


Length = Annotated[
    float,
    BeforeValidator(parse_length),
    PlainSerializer(format_length, return_type=str),
    WithJsonSchema(schema_of(LENGTH) | {"examples": ["5 nm", "1.4 um", "300 um"]}),
]
"""A length in µm, given as text with its unit."""

Angle = Annotated[
    float,
    BeforeValidator(parse_angle),
    PlainSerializer(format_angle, return_type=str),
    WithJsonSchema(schema_of(ANGLE)),
]
"""An angle in rad, given as text with its unit."""

Attenuation = Annotated[
    float,
    BeforeValidator(partial(parse, ATTENUATION)),
    PlainSerializer(written_in("1/um"), return_type=str),
    WithJsonSchema(schema_of(ATTENUATION)),
]
"""An attenuation in 1/µm, given as text with its unit."""

Ratio = Annotated[
    float,
    BeforeValidator(partial(parse, RATIO)),
    PlainSerializer(written_in("um/um"), return_type=str),
    WithJsonSchema(schema_of(RATIO)),
]
"""A length per length, given as text with its unit."""

PerLength = Annotated[
    float,
    BeforeValidator(partial(parse, PER_LENGTH)),
    PlainSerializer(written_in("1/um"), return_type=str),
    WithJsonSchema(schema_of(PER_LENGTH)),
]
"""A length per length squared in 1/µm, given as text with its unit."""
