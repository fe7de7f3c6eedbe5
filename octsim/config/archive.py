"""The config's section on the archive of a run: what a data repository wants to know of it."""

import contextlib
import datetime as dt
import re
from typing import Annotated

from pydantic import AfterValidator, BeforeValidator, StringConstraints

from octsim.config.fields import Section, key

LICENSE = "CC-BY-4.0"
_ORCID = re.compile(r"(?:https://orcid\.org/)?(\d{4}-\d{4}-\d{4}-\d{3}[\dX])")


def _orcid(text: str) -> str:
    """Return the bare ORCID iD; its last digit is a checksum of the others (ISO 7064, MOD 11-2)."""
    found = _ORCID.fullmatch(text)
    if not found:
        raise ValueError("it should be an ORCID iD as 0000-0002-1825-0097")
    *digits, last = list(found[1].replace("-", ""))
    total = 0
    for digit in digits:
        total = 2 * (total + int(digit))
    if "0123456789X"[(12 - total % 11) % 11] != last:
        raise ValueError("its last digit does not fit the others; look for a typing error")
    return found[1]


def _day(value: object) -> object:
    if type(value) is dt.date:  # YAML reads a day without quotes as one
        return value.isoformat()
    with contextlib.suppress(ValueError):
        if value is None or dt.date.fromisoformat(str(value)).isoformat() == value:
            return value
    raise ValueError("it should be a day as 2026-01-31")


def _license(text: str) -> str:
    """Return an SPDX id as the SPDX list spells it."""
    if text == LICENSE:
        return text  # a config at its default waits for no list
    from packaging.licenses import InvalidLicenseExpression, canonicalize_license_expression

    try:
        known = str(canonicalize_license_expression(text))
    except InvalidLicenseExpression:
        known = " "
    if " " in known or known.startswith("LicenseRef-"):
        raise ValueError("it should be one SPDX id, as CC-BY-4.0, CC0-1.0 or MIT")
    return known


def _line(text: str) -> str:
    if not text.isprintable():
        raise ValueError("it should be one line of text")
    return text


Paragraph = Annotated[str, StringConstraints(strip_whitespace=True, min_length=1)]
Line = Annotated[Paragraph, AfterValidator(_line)]
"""Text on one line."""


class Creator(Section):
    """Somebody who made the data."""

    name: Line
    orcid: Annotated[str, AfterValidator(_orcid)] | None = None
    affiliation: Line | None = None


def _distinct(creators: tuple[Creator, ...]) -> tuple[Creator, ...]:
    known = [one.orcid for one in creators if one.orcid]
    for orcid in known:
        if known.count(orcid) > 1:
            raise ValueError(f"the ORCID iD {orcid} is given for two of them; each has an own one")
    return creators


def _frozen(value: object) -> object:
    if not isinstance(value, list | tuple):
        raise ValueError("it should be a list, with {name: ...} for each")  # noqa: TRY004
    return tuple(value)


class ArchiveConfig(Section):
    """What an archive says of itself; no dataset or figure depends on it."""

    title: Line | None = key(None, "of the deposit; null names the run")
    description: Paragraph | None = key(None, "of the deposit; null says what octsim simulates")
    creators: Annotated[
        tuple[Creator, ...], BeforeValidator(_frozen), AfterValidator(_distinct)
    ] = key((), "who made the data: {name, orcid, affiliation} each, the last two optional")
    license: Annotated[str, AfterValidator(_license)] = key(LICENSE, "of the data, an SPDX id")
    date: Annotated[str | None, BeforeValidator(_day)] = key(
        None, "of publication, as 2026-01-31; null takes SOURCE_DATE_EPOCH, else 1980-01-01"
    )
