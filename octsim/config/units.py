"""Lengths with their unit: read from text, kept as micrometres, written back as text."""

import re
from decimal import Decimal, DecimalException
from functools import cache, lru_cache
from typing import Annotated, Any

import pint
from pydantic import BeforeValidator, PlainSerializer, WithJsonSchema

_EXAMPLES = "write it with its unit, such as 5 nm, 1.4 um or 0.3 mm"
_NUMBER_PATTERN = r"[-+]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][-+]?[0-9]+)?"
_UNIT_PATTERN = r"[A-Za-zµμÅ]+"
_NUMBER = re.compile(rf"\s*{_NUMBER_PATTERN}\s*")
_LENGTH = re.compile(rf"\s*({_NUMBER_PATTERN})\s*({_UNIT_PATTERN})\s*")


@cache
def _registry() -> "pint.UnitRegistry[Decimal]":
    # Decimals convert exactly: '650 nm' and '0.65 um' are the same float.
    return pint.UnitRegistry(non_int_type=Decimal)


def parse_length(text: object) -> float:
    """Read a length such as ``"5 nm"``.

    Parameters
    ----------
    text : object
        A number with a unit of length, as text.

    Returns
    -------
    float
        The length in µm, correctly rounded.

    Raises
    ------
    ValueError
        If there is no unit, the unit is not one of length, or the number is not finite.
    """
    if isinstance(text, str):
        return _parsed(text)
    bare = isinstance(text, int | float) and not isinstance(text, bool)
    raise ValueError(f"{'a length needs its unit' if bare else 'not a length'}; {_EXAMPLES}")


@lru_cache(maxsize=100_000)  # the combinations of a grid repeat theirs
def _parsed(text: str) -> float:
    match = _LENGTH.fullmatch(text)
    if match is None:
        reason = "a length needs its unit" if _NUMBER.fullmatch(text) else "not a length"
        raise ValueError(f"{reason}; {_EXAMPLES}")
    number, unit = match.groups()
    try:
        quantity = _registry().Quantity(Decimal(number), unit)
        length = float(quantity.to("micrometer").magnitude)
    except pint.DimensionalityError:
        raise ValueError(f"'{unit}' is not a unit of length; {_EXAMPLES}") from None
    except DecimalException:
        raise ValueError(f"far out of range; {_EXAMPLES}") from None
    except (pint.UndefinedUnitError, ValueError):  # pint calls 'nan' and the like a scaling factor
        raise ValueError(f"'{unit}' is not a unit that is known; {_EXAMPLES}") from None
    return length


def format_length(length: float) -> str:
    """Write a length in µm as text that `parse_length` reads back to the same bits.

    Examples
    --------
    >>> format_length(0.005)
    '0.005 um'
    """
    return f"{length!r} um"


_SCHEMA: dict[str, Any] = {
    "type": "string",
    "pattern": rf"^{_LENGTH.pattern}$",
    "description": "a length with its unit",
    "examples": ["5 nm", "1.4 um", "300 um"],
}

Length = Annotated[
    float,
    BeforeValidator(parse_length),
    PlainSerializer(format_length, return_type=str),
    WithJsonSchema(_SCHEMA),
]
"""A length in µm, given as text with its unit."""
