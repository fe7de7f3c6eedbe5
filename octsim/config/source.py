"""The part of the config on the source's spectrum: flat, a Gaussian, or a file's."""

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Annotated, Any, Literal, Protocol

from pydantic import (
    AfterValidator,
    BeforeValidator,
    Discriminator,
    Field,
    Tag,
    ValidationError,
    model_validator,
)

from octsim.config.dispersion import unit_of_length
from octsim.config.dispersion_forms import Ascending
from octsim.config.fields import Number, PositiveLength, Section, Wavelength, listed
from octsim.config.source_files import read_source
from octsim.config.units import format_length
from octsim.config.wording import message_of
from octsim.optics.source import GaussianSource, MeasuredSource, Source

FORMS = (
    "it should be flat, {gaussian: {centre: 840 nm, fwhm: 50 nm}}, or a CSV file of wavelength and "
    "power, as source.csv or {table: source.csv, unit: nm}"
)
FAINTEST = 0.01
"""Power over the largest, below which there is hardly any light: of negative ones noise about 0."""
_MOSTLY, _TRIED = 0.5, 401


class GaussianShape(Section):
    """A Gaussian over the wavelength in vacuum."""

    centre: Wavelength
    fwhm: PositiveLength
    """Full width at half maximum."""


class GaussianSpectrum(Section):
    """A source whose spectrum is a Gaussian."""

    gaussian: GaussianShape

    @property
    def source(self) -> Source:
        """What it is as optics."""
        return GaussianSource(self.gaussian.centre, self.gaussian.fwhm)


class SourceColumns(Section):
    """The power of a source at some wavelengths in vacuum, of any unit."""

    wavelength: Ascending
    power: Annotated[tuple[Number, ...], BeforeValidator(listed)]

    @model_validator(mode="after")
    def _powers(self) -> "SourceColumns":
        if len(self.power) != len(self.wavelength):
            raise ValueError(
                f"power has {len(self.power)} numbers and wavelength {len(self.wavelength)}; give "
                "each wavelength one"
            )
        largest = max(self.power)
        if largest <= 0:
            raise ValueError("no power is above 0; give a source that has light")
        for row, power in enumerate(self.power, 1):
            if power < -FAINTEST * largest:
                raise ValueError(
                    f"power {power:g} in row {row} is below 0; subtract the dark spectrum, once"
                )
        return self


class SourceTable(Section):
    """A source that was measured."""

    table: SourceColumns

    @property
    def source(self) -> MeasuredSource:
        """What it is as optics."""
        return MeasuredSource(
            self.table.wavelength, tuple(max(one, 0.0) for one in self.table.power)
        )


class SourceFile(Section):
    """A file with a source's spectrum; a checked config holds what was in it."""

    table: Annotated[str, Field(min_length=1)]
    """Path of a CSV file, from the current folder: columns wavelength and power."""
    unit: Annotated[str, AfterValidator(unit_of_length)] | None = None
    """Of its wavelengths, where their heading does not say it."""


def _inline(file: SourceFile) -> SourceTable:
    columns = read_source(file.table, file.unit)
    try:
        return SourceTable.model_validate({"table": columns})
    except ValidationError as error:
        raise ValueError(f"{file.table}: {message_of(error.errors()[0])}") from None


def _form(value: object) -> object:
    if isinstance(value, str) and value != "flat" and not Path(value).suffix:
        raise ValueError(FORMS)
    if isinstance(value, str) and value != "flat":
        return {"table": value}
    kinds = [kind for kind in ("gaussian", "table") if isinstance(value, Mapping) and kind in value]
    known = value == "flat" or isinstance(value, Section)
    if not known and len(kinds) != 1:
        raise ValueError(FORMS)
    return value


def _kind(value: object) -> str:
    if isinstance(value, GaussianSpectrum | SourceTable):
        return "gaussian" if isinstance(value, GaussianSpectrum) else "table"
    if isinstance(value, Mapping):
        if "gaussian" in value:
            return "gaussian"
        return "file" if isinstance(value.get("table"), str) else "table"
    return "flat"


SourceConfig = Annotated[
    Annotated[Literal["flat"], Tag("flat")]
    | Annotated[GaussianSpectrum, Tag("gaussian")]
    | Annotated[SourceTable, Tag("table")]
    | Annotated[SourceFile, AfterValidator(_inline), Tag("file")],
    Discriminator(_kind),
    BeforeValidator(_form),
]


def source_of(given: Any) -> Source | None:
    """Return the source that a checked config has; None of a flat one."""
    return None if given == "flat" else given.source


class Band(Protocol):
    """Wavelengths, µm."""

    @property
    def min(self) -> float:
        """The shortest."""

    @property
    def max(self) -> float:
        """The longest."""


def unlit(given: Any, band: Band) -> Iterator[str]:
    """Say if a source is not known all over a band, or has no light in it."""
    if isinstance(given, SourceTable):
        first, last = given.table.wavelength[0], given.table.wavelength[-1]
        if not given.source.spans(band.min, band.max):
            yield (
                f"spectrum.source: known from {format_length(first)} to {format_length(last)}, but "
                f"asked for from {format_length(band.min)} to {format_length(band.max)}; give a "
                "source that spans the band, or a narrower spectrum.wavelength"
            )
            return
    if _dark_share(given, band) == 1:
        yield (
            f"spectrum.source: less than {FAINTEST:.0%} of its largest power all over "
            f"{format_length(band.min)} to {format_length(band.max)}; give a band that it lights"
        )


def dim(given: Any, band: Band) -> Iterator[str]:
    """Say if much of a band is hardly lit."""
    if _MOSTLY < (dark := _dark_share(given, band)) < 1:
        yield (
            f"spectrum.source: has less than {FAINTEST:.0%} of its largest power in {dark:.0%} of "
            "the band, whose samples cost time and hold noise alone; narrow spectrum.wavelength"
        )


def _dark_share(given: Any, band: Band) -> float:
    """Return which share of a band has hardly any light."""
    source = source_of(given)
    if source is None:
        return 0.0
    import numpy as np  # here, as reading a config takes half as long without

    k = np.linspace(2 * np.pi / band.max, 2 * np.pi / band.min, _TRIED)
    return float((source.power(k) < FAINTEST).mean())
