"""The part of the config on a lab's own spectra: files, and the chain before a phase."""

from collections.abc import Mapping
from functools import partial
from typing import Annotated, Any, Literal

from pydantic import (
    BeforeValidator,
    Discriminator,
    Field,
    PlainSerializer,
    Tag,
    WithJsonSchema,
)

from octsim.config.fields import Number, PositiveLength, Section, absent, listed
from octsim.config.fields import key as _key
from octsim.config.units import Quantity, parse, schema_of, written_in

FREQUENCY = Quantity("frequency", "a frequency", "Hz", ("20 kHz", "500 Hz"))
Frequency = Annotated[
    float,
    BeforeValidator(partial(parse, FREQUENCY)),
    Field(gt=0),
    PlainSerializer(written_in("Hz"), return_type=str),
    WithJsonSchema(schema_of(FREQUENCY)),
]
"""A frequency in Hz, given as text with its unit."""
File = Annotated[str, Field(min_length=1)]
AXIS_FORM = (
    "it should be {wavelength: calib.csv}, {wavenumber: calib.csv} or {polynomial: [c0, c1, c2]} "
    "over pixels from 0, in nm"
)

INSIDE_FORM = (
    "it should be a file, as {key}.csv, or {{at: /raw/{key}}}, in the file of spectra, or {{file: "
    "{key}.h5, at: /raw/{key}}}"
)
SUBTRACTED = "subtracted"


class RawBinary(Section):
    """How numbers stand in a raw binary file."""

    dtype: Literal["uint8", "int8", "uint16", "int16", "uint32", "int32", "float32", "float64"]
    """Of a number, as uint16."""
    shape: Annotated[
        tuple[Annotated[int, Field(ge=-1)], ...], BeforeValidator(listed), Field(max_length=3)
    ]
    """Spectra and samples; −1 once for what follows from the file's size."""
    order: Literal["little", "big"] = "little"
    """Of bytes."""
    offset: Annotated[int, Field(ge=0)] = 0
    """Bytes of a header before them."""


class AxisFile(Section):
    """A file with a wavelength or a wavenumber for each sample."""

    wavelength: File | None = None
    wavenumber: File | None = None


class AxisPolynomial(Section):
    """Wavelengths in nm as a polynomial of the sample's number, counted from 0."""

    polynomial: Annotated[
        tuple[Number, ...], BeforeValidator(listed), Field(min_length=2, max_length=10)
    ]


class Inside(Section):
    """Spectra that stand in a file beside others."""

    at: File
    """Name inside the file, as /raw/dark."""
    file: File | None = None
    """Null is that of ``measured.spectra``."""


def _place_kind(value: object) -> str:
    return "inside" if isinstance(value, Inside | Mapping) else "file"


def _place_form(key: str, value: object) -> object:
    value = absent(value)
    known = value is None or isinstance(value, str | Inside)
    if known or (isinstance(value, Mapping) and {"at"} <= value.keys() <= {"at", "file"}):
        return value
    raise ValueError(INSIDE_FORM.format(key=key))


_Place = Annotated[
    Annotated[File, Tag("file")] | Annotated[Inside, Tag("inside")], Discriminator(_place_kind)
]


def _axis_kind(value: object) -> str:
    if isinstance(value, AxisPolynomial) or (isinstance(value, Mapping) and "polynomial" in value):
        return "polynomial"
    return "file"


def _axis_form(value: object) -> object:
    value = absent(value)
    if isinstance(value, Mapping):
        given = {key: one for key, one in value.items() if one is not None}
        if len(given) == 1:
            return given
    if value is None or isinstance(value, Section):
        return value
    raise ValueError(AXIS_FORM)


class Dispersion(Section):
    """What dispersion turns the fringe by at the band's edge."""

    a2: Number = 0.0
    """Of the square of the place in the band, from −1 to 1, rad."""
    a3: Number = 0.0
    """Of its cube, rad."""


def _dispersion_kind(value: object) -> str:
    return "fit" if isinstance(value, str) else "given"


def _none_given(value: object) -> object:
    return {} if absent(value) is None else value


class Measured(Section):
    """A lab's own spectra, for `snakemake measured` and `octsim import`."""

    spectra: File | None = _key(
        None, "file with raw spectra: text, npy, npz, HDF5, MATLAB, netCDF, TDMS, .oct, raw binary"
    )
    at: str | None = _key(None, "name inside the file, as /raw/spectra")
    raw: RawBinary | None = _key(
        None, "of raw binary, as {dtype: uint16, shape: [20000, 2048], order: little}"
    )
    x: Annotated[int, Field(ge=0)] | None = _key(
        None, "which place across, counted from 0, where a file has more than one"
    )
    axis: Annotated[
        Annotated[
            Annotated[AxisFile, Tag("file")] | Annotated[AxisPolynomial, Tag("polynomial")],
            Discriminator(_axis_kind),
        ]
        | None,
        BeforeValidator(_axis_form),
    ] = _key(
        None, "{wavelength: calib.csv} or {polynomial: [c0, c1, c2, c3]} in nm; null: in the file"
    )
    dark: Annotated[_Place | None, BeforeValidator(partial(_place_form, "dark"))] = _key(
        None,
        "file with spectra without light, or {file: run7.h5, at: /raw/dark}: their mean is "
        "subtracted, from the reference too; subtracted: it was, from all spectra",
    )
    reference: Annotated[_Place | None, BeforeValidator(partial(_place_form, "reference"))] = _key(
        None,
        "file with the source's own spectra, raw, or {file: run7.h5, at: /raw/source}; null is "
        "spectrum.source, or a flat one",
    )
    dispersion: Annotated[
        Annotated[Literal["fit"], Tag("fit")] | Annotated[Dispersion, Tag("given")],
        Discriminator(_dispersion_kind),
        BeforeValidator(_none_given),
    ] = _key({}, "{a2: 0, a3: 0}, rad at the band's edge, or fit")
    rate: Frequency | None = _key(None, "of spectra, as 20 kHz; null: times are in the file")
    full_scale: Annotated[Number, Field(gt=0)] | None = _key(
        None,
        "counts at which the camera is full; null: a converter's largest, where spectra reach it",
    )
    reference_depth: PositiveLength | None = _key(
        None, "optical depth of a reflector that does not move: its phase is subtracted"
    )
    average: Annotated[int, Field(ge=1, le=1_000_000)] = _key(
        1, "spectra whose phases are averaged, one after the other"
    )

    @property
    def dark_place(self) -> Inside | str | None:
        """Where spectra without light are; None where there are none."""
        return None if self.dark == SUBTRACTED else self.dark

    def file_and_name(self, place: Inside | str) -> tuple[str, str | None]:
        """Return the file in which spectra are, and their name inside it, if they have one."""
        if isinstance(place, str):
            return place, None
        return place.file or self.spectra or "", place.at

    @property
    def files(self) -> dict[str, str]:
        """The files that are named, by their keys."""
        named: dict[str, Any] = {"spectra": self.spectra}
        for key, place in (("dark", self.dark_place), ("reference", self.reference)):
            if place is not None:
                named[key] = self.file_and_name(place)[0] or None
        if isinstance(self.axis, AxisFile):
            named |= {
                "axis.wavelength": self.axis.wavelength,
                "axis.wavenumber": self.axis.wavenumber,
            }
        return {f"measured.{key}": file for key, file in named.items() if file is not None}
