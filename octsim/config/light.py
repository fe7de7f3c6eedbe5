"""The config's sections on the light: the objective with its pupil, and the polarisation."""

import difflib
from collections.abc import Mapping
from math import pi
from typing import Annotated, Literal

from pydantic import BeforeValidator, Discriminator, PlainSerializer, Tag, WithJsonSchema

from octsim.config.effects import FocalShift, Zernike
from octsim.config.fields import PositiveLength, PositiveNumber, Section, absent
from octsim.config.fields import key as _key
from octsim.config.scene import Medium
from octsim.config.units import ANGLE, format_angle, parse_angle, schema_of


class GaussianFill(Section):
    """A pupil that a Gaussian beam fills."""

    gaussian: PositiveNumber
    """Fill: 1/e² radius of intensity over the pupil's radius."""


class FibreMode(Section):
    """A pupil that the mode of a fibre fills."""

    fibre: PositiveLength
    """Mode-field diameter, seen at the magnification, µm."""


PUPIL_FORM = "it should be uniform, {gaussian: 1.0} or {fibre: 5 um}, or null"
_PUPILS = ("gaussian", "fibre")


def _pupil(value: object) -> object:
    if isinstance(value, Mapping) and value.keys() >= set(_PUPILS):
        raise ValueError("it should be one of the two")
    if isinstance(value, Mapping) and not (set(_PUPILS) & value.keys()):
        near = (difflib.get_close_matches(str(key).lower(), _PUPILS, n=1) for key in value)
        told = [f"the nearest that is known is {name}; " for names in near for name in names]
        raise ValueError(f"{''.join(told[:1])}{PUPIL_FORM}")
    return absent(value)


def _pupil_kind(value: object) -> str:
    if isinstance(value, GaussianFill) or (isinstance(value, Mapping) and "fibre" not in value):
        return "gaussian"
    return "fibre" if isinstance(value, FibreMode | Mapping) else "name"


Pupil = Annotated[
    Annotated[Literal["uniform"] | None, Tag("name")]
    | Annotated[GaussianFill, Tag("gaussian")]
    | Annotated[FibreMode, Tag("fibre")],
    Discriminator(_pupil_kind),
    BeforeValidator(_pupil),
]


class Objective(Section):
    """The objective lens, an ideal thin one."""

    numerical_aperture: PositiveNumber = _key(1.2, "below the index of glass")
    focus_distance: PositiveLength = _key(
        "300 um", "from the objective plane to the focus; beyond every focus"
    )
    immersion: Annotated[Medium | None, BeforeValidator(absent)] = _key(
        None,
        "what is between objective and slide, as oil, where its index is another; the lowest of "
        "scene.layers, the slide, then has a thickness; null or none is no other",
    )
    magnification: PositiveNumber = _key(20.0, "object to fibre")
    pupil: Pupil = _key(
        None,
        "how light fills it: uniform, {gaussian: 1.0} (1/e² radius of intensity over the pupil's) "
        "or {fibre: 5 um} (mode-field diameter); null is the scheme's own",
    )
    apodisation: Annotated[Literal["aplanatic"] | None, BeforeValidator(absent)] = _key(
        None, "aplanatic: √cos θ in, 1/√cos θ out; null or none is the scheme's own"
    )
    zernike: Zernike = _key(
        {},
        "aberrations, in and out, by Noll's number or name: {11: 10 nm} or {spherical: 10 nm}; the "
        "rms of each over the pupil, and a positive one is a longer way",
    )
    zernike_rays: Literal["normal", "phase"] = _key(
        "normal", "rays are turned to stay normal to the wavefront, or take its phase alone"
    )
    focal_shift: FocalShift = _key(
        None,
        "a focus that is higher by linear (λ − reference) + quadratic (λ − reference)², as "
        "{reference: 755 nm, linear: 0.4 um/um, quadratic: 0 um/um^2}; null or none is one focus",
    )


_TURN = 2 * pi
_STATES = ("unpolarised", "left", "right")
_ALONG = {
    **dict.fromkeys(("x", "h", "horizontal"), "0 deg, along x"),
    **dict.fromkeys(("y", "v", "vertical"), "90 deg, along y"),
    "linear": "an angle from x to y, such as 0 deg",
    "circular": "left or right",
    "unpolarized": "unpolarised",
}


def _state(value: object) -> object:
    if value in _STATES:
        return value
    if along := _ALONG.get(str(value).lower()):
        raise ValueError(
            f"it should be an angle as 30 deg, unpolarised, left or right; did you mean {along}?"
        )
    try:
        return _direction(value)
    except ValueError as error:
        raise ValueError(f"{error}; or unpolarised, left or right") from None


def _direction(value: object) -> float | None:
    if absent(value) is None:
        return None
    if along := _ALONG.get(str(value).lower()):
        raise ValueError(f"it should be an angle as 30 deg; did you mean {along}?")
    angle = parse_angle(value)
    if abs(angle) > _TURN:
        raise ValueError("it should be within a turn, -360 deg to 360 deg")
    return angle


def _written(value: object) -> object:
    return format_angle(value) if isinstance(value, float) else value


_Written = PlainSerializer(_written, return_type=str | None)
_ANGLE = schema_of(ANGLE)
_NOTHING = {"type": "null"}


class PolarisationConfig(Section):
    """Polarisation of the light that goes in, and of what is detected."""

    input: Annotated[
        float | Literal["unpolarised", "left", "right"] | None,
        BeforeValidator(_state),
        _Written,
        WithJsonSchema({"anyOf": [_ANGLE, {"enum": list(_STATES)}, _NOTHING]}),
    ] = _key(
        None,
        "unpolarised, left, right, or an angle from x to y as 30 deg; null or none is the scheme's "
        "own",
    )
    analyser: Annotated[
        float | None,
        BeforeValidator(_direction),
        _Written,
        WithJsonSchema({"anyOf": [_ANGLE, _NOTHING]}),
    ] = _key(None, "angle of one for the returned light, as 30 deg; null or none is none")

    @property
    def given(self) -> bool:
        """Whether either is given, so that light has a polarisation by any scheme."""
        return self.input is not None or self.analyser is not None
