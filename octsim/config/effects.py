"""The config's parts on what the thesis left out of the light's way: each is off by default."""

import difflib
import re
from collections.abc import Iterator, Mapping
from typing import Annotated, Literal

from pydantic import BeforeValidator, ConfigDict, Field, PlainSerializer, WithJsonSchema

from octsim.config.fields import Number, Position, PositiveLength, Section, Wavelength, absent
from octsim.config.fields import key as _key
from octsim.config.units import (
    LENGTH,
    Length,
    PerLength,
    Ratio,
    format_length,
    parse_length,
    schema_of,
)
from octsim.optics import focal_shift as shifts
from octsim.optics.zernike import MOST, NAMES

ZERNIKE_FORM = (
    "it should be Zernike terms by Noll's number or name, as {11: 10 nm} or {spherical: 10 nm}"
)
FOCAL_SHIFT_FORM = (
    "it should be none, or {reference: 755 nm, linear: 0.4 um/um, quadratic: 0 um/um^2}"
)
REFERENCE_FORM = "it should be none, or {amplitude: 0.004, length: 9 um}"
_NOTHING = {"type": "null"}


_DIRECTIONS = {"x", "y", "oblique", "vertical", "horizontal"}


def _families() -> dict[str, dict[int, str]]:
    """Return the terms of each name without its direction, where it has several: their names."""
    found: dict[str, dict[int, str]] = {}
    for name, number in NAMES.items():
        words = name.split()
        family = " ".join(word for word in words if word not in _DIRECTIONS)
        if family != name:
            found.setdefault(family, {}).setdefault(number, name)
    return {family: terms for family, terms in found.items() if len(terms) > 1}


_FAMILIES = _families()
_NAME_OF: Mapping[int, str] = {
    **{number: name for name, number in reversed(list(NAMES.items()))},
    **{number: name for terms in _FAMILIES.values() for number, name in terms.items()},
}


def zernike_name(number: int) -> str:
    """Return what a Zernike term of Noll's number is called; nothing where it has no name."""
    return _NAME_OF.get(number, "")


def zernike_number(term: object) -> int:
    """Return Noll's number of a term by that or by its name.

    Raises
    ------
    ValueError
        If there is none, or there are two.
    """
    text = " ".join(str(term).lower().replace("_", " ").replace("-", " ").split())
    if text in _FAMILIES and text not in NAMES:
        both = " or ".join(f"{name} ({number})" for number, name in _FAMILIES[text].items())
        raise ValueError(f"{text} has a direction: write {both}")
    whole = re.fullmatch(r"\s*[-+]?[0-9]+\s*", str(term))
    number = int(str(term)) if whole else NAMES.get(text)
    if number is None:
        nearest = difflib.get_close_matches(text, NAMES, n=1, cutoff=0)[0]
        raise ValueError(
            f"{term!r} is no Zernike term that is known; the nearest is {nearest!r}, or give "
            f"Noll's number, 1 to {MOST}"
        )
    if not 1 <= number <= MOST:
        raise ValueError(f"{number} is none of Noll's numbers that are known, 1 to {MOST}")
    return number


def _numbered(given: Mapping[object, object]) -> Iterator[tuple[int, object]]:
    """Return Noll's number of each term, and its coefficient."""
    for term, coefficient in given.items():
        yield zernike_number(term), coefficient


def _terms(given: object) -> object:
    """Return Zernike terms by Noll's numbers as text, increasing."""
    if isinstance(given, ZernikeConfig):
        return given
    if given is None or given == "none":
        return {}
    if not isinstance(given, Mapping):
        raise ValueError(ZERNIKE_FORM)  # noqa: TRY004
    found: dict[int, object] = {}
    for (number, coefficient), term in zip(_numbered(given), given, strict=True):
        if number in found:
            raise ValueError(
                f"the term {number} is given twice, once as {term!r}; write it one way, as "
                f"{number}, and once"
            )
        found[number] = coefficient
    return {str(number): found[number] for number in sorted(found)}


class ZernikeConfig(Section):
    """Aberrations of the pupil by Noll's numbers: the rms of each as a length, in and out."""

    model_config = ConfigDict(extra="allow")
    __pydantic_extra__: dict[str, Annotated[Length, Field(ge=-100, le=100)]]

    @property
    def of(self) -> Mapping[int, float]:
        """Coefficients that are not zero by Noll's number, µm."""
        return {int(number): rms for number, rms in self if rms}


Zernike = Annotated[ZernikeConfig, BeforeValidator(_terms)]


class FocalShiftConfig(Section):
    """A focus whose height depends on the wavelength λ, by a(λ − λ₀) + b(λ − λ₀)²."""

    reference: Wavelength
    """λ₀."""
    linear: Annotated[Ratio, Field(ge=-1e6, le=1e6)] = _key("0 um/um", "a")
    quadratic: Annotated[PerLength, Field(ge=-1e6, le=1e6)] = _key("0 um/um^2", "b")

    @property
    def moves(self) -> bool:
        """Whether it is not zero at all wavelengths."""
        return bool(self.linear or self.quadratic)

    @property
    def formula(self) -> shifts.FocalShift:
        """What it is at each wavelength."""
        return shifts.FocalShift(self.reference, self.linear, self.quadratic)


FocalShift = Annotated[FocalShiftConfig | None, BeforeValidator(absent)]


def _length_or(*others: str | None, least: float, most: float) -> BeforeValidator:
    """Return the validator of a length within limits, µm, or of a word, or of None."""
    (word,) = (other for other in others if other)

    def read(value: object) -> object:
        if value in others:
            return value
        try:
            length = parse_length(value)
        except ValueError as error:
            raise ValueError(f"{error}; or {word}") from None
        if not least <= length <= most:
            raise ValueError(f"it should be from {least:g} um to {most:g} um, or {word}")
        return length

    return BeforeValidator(read)


def _written(value: object) -> object:
    return format_length(value) if isinstance(value, float) else value


_Written = PlainSerializer(_written, return_type=str | None)


class BeamConfig(Section):
    """The beam at its focus."""

    waist: Annotated[
        float | Literal["diffraction"] | None,
        _length_or("diffraction", None, least=1e-6, most=1e6),
        BeforeValidator(absent),
        _Written,
        WithJsonSchema({"anyOf": [schema_of(LENGTH), {"enum": ["diffraction", "none"]}, _NOTHING]}),
    ] = _key(
        None,
        "radius at 1/e² of intensity, with rays as the rulings of a Gaussian beam: diffraction is "
        "λ/(π NA), or a length; null or none is rays that meet in the focus",
    )
    wavelength: Annotated[
        float | Literal["each"],
        _length_or("each", least=1e-3, most=1e3),
        _Written,
        WithJsonSchema({"anyOf": [schema_of(LENGTH), {"enum": ["each"]}]}),
    ] = _key(
        "each", "of the beam whose rulings rays are: each one's own, or one for all, as 755 nm"
    )


class ReferenceArmConfig(Section):
    """A reference arm: light that comes back from a mirror."""

    amplitude: Annotated[Number, Field(ge=0, le=1e6)]
    length: Position
    """One way, from the focus."""


class Interferometer(Section):
    """What the returned light is brought to interference with."""

    reference: Annotated[ReferenceArmConfig | None, BeforeValidator(absent)] = _key(
        None,
        "light of a reference arm that is added, as {amplitude: 0.004, length: 9 um}, one way, "
        "from the focus; null or none is none",
    )


class DetectorConfig(Section):
    """The fibre that collects the light."""

    core_diameter: PositiveLength = _key(
        "4.4 um", "of the fibre; R_det = core_diameter / (2 magnification)"
    )
    falloff: Literal["parabolic", "top_hat", "cosine", "gaussian", "fibre"] = _key(
        "parabolic", "of the detected amplitude, over the distance from the axis"
    )
    mode_field_diameter: PositiveLength | None = _key(
        None, "of the falloff gaussian; null is one with 1/e of amplitude at R_det"
    )
    fibre_na: Annotated[Number, Field(gt=0, lt=1)] = _key(
        0.13, "of the falloff fibre, whose mode is that of the core in each wavelength"
    )
