"""The forms of a dispersion in a config: Cauchy's and Sellmeier's formulas, and a table."""

import itertools
from collections.abc import Mapping
from typing import Annotated

from pydantic import AfterValidator, BeforeValidator, Field, PrivateAttr, model_validator

from octsim.config.fields import Index, Number, Section, Wavelength, listed
from octsim.config.units import format_length
from octsim.optics.materials import Cauchy, Material, Sellmeier, Table

_Coefficients = Annotated[tuple[Number, ...], BeforeValidator(listed), Field(min_length=1)]


class CauchyIndex(Section):
    """Cauchy's formula, with the wavelength λ in vacuum."""

    cauchy: Annotated[_Coefficients, Field(max_length=8)]
    """A, B, C, … of n = A + B/λ² + C/λ⁴ + …, with λ in µm."""

    @property
    def material(self) -> Material:
        """What it is as optics."""
        return Cauchy(self.cauchy)


def _only(*names: str, form: str) -> BeforeValidator:
    """Return the validator of a mapping that has some keys alone; said in one line."""

    def read(value: object) -> object:
        if isinstance(value, Mapping) and (others := [key for key in value if key not in names]):
            raise ValueError(f"{', '.join(map(str, others))} can't stand here; {form}")
        return value

    return BeforeValidator(read)


class SellmeierCoefficients(Section):
    """What Sellmeier's formula has."""

    B: _Coefficients
    C: _Coefficients
    """µm²."""

    @model_validator(mode="after")
    def _pairs(self) -> "SellmeierCoefficients":
        if len(self.B) != len(self.C):
            raise ValueError(
                f"B has {len(self.B)} numbers and C {len(self.C)}; give each B its C, in um^2"
            )
        return self


class SellmeierIndex(Section):
    """Sellmeier's formula, n² = 1 + Σ B λ²/(λ² − C), with the wavelength λ in vacuum, µm."""

    sellmeier: Annotated[
        SellmeierCoefficients, _only("B", "C", form="write B and C, as {B: [...], C: [...]}")
    ]

    @property
    def material(self) -> Material:
        """What it is as optics."""
        return Sellmeier(self.sellmeier.B, self.sellmeier.C)


def _wavelength(value: object) -> object:
    # the validator of a length, which comes next, reads text
    bare = isinstance(value, int | float) and not isinstance(value, bool)
    return f"{value!r} um" if bare else value


def _increasing(values: tuple[float, ...]) -> tuple[float, ...]:
    for row, (one, other) in enumerate(itertools.pairwise(values), 2):
        if not one < other:
            raise ValueError(
                f"{format_length(other)} in row {row} is not above {format_length(one)} in the one "
                "before; sort the rows by wavelength, each once"
            )
    return values


Ascending = Annotated[
    tuple[
        Annotated[Wavelength, BeforeValidator(_wavelength, json_schema_input_type=str | float)],
        ...,
    ],
    BeforeValidator(listed),
    Field(min_length=2),
    AfterValidator(_increasing),
]
"""Wavelengths in vacuum, of a table."""


class TableColumns(Section):
    """Refractive indices at some wavelengths in vacuum."""

    wavelength: Ascending
    n: Annotated[tuple[Index, ...], BeforeValidator(listed)]
    kappa: (
        Annotated[tuple[Annotated[Number, Field(ge=0, le=10)], ...], BeforeValidator(listed)] | None
    ) = None

    @model_validator(mode="after")
    def _as_many(self) -> "TableColumns":
        for name, column in (("n", self.n), ("kappa", self.kappa)):
            if column is not None and len(column) != len(self.wavelength):
                raise ValueError(
                    f"{name} has {len(column)} numbers and wavelength {len(self.wavelength)}; give "
                    "each wavelength one"
                )
        return self


class TableIndex(Section):
    """A table of refractive indices."""

    table: Annotated[
        TableColumns,
        _only("wavelength", "n", "kappa", form="its columns are wavelength, n and maybe kappa"),
    ]
    _file: str = PrivateAttr("")

    def __eq__(self, other: object) -> bool:
        return isinstance(other, TableIndex) and self.table == other.table

    def __hash__(self) -> int:
        return hash(self.table)

    def name_file(self, file: str) -> None:
        """Keep which file it was read from, for messages alone."""
        self._file = file

    @property
    def where(self) -> str:
        """What it is called: its file, as long as that is known."""
        return self._file or "a table"

    @property
    def material(self) -> Material:
        """What it is as optics."""
        return Table(self.table.wavelength, self.table.n, self.table.kappa or ())
