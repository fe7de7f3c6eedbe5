"""The refractive index of a medium, as a config has it: a number, a dispersion or a name."""

import difflib
from collections.abc import Mapping
from typing import TYPE_CHECKING, Annotated, Any, Literal

from pydantic import (
    AfterValidator,
    BeforeValidator,
    Discriminator,
    Field,
    Tag,
    ValidationError,
)

from octsim.config.dispersion_files import read_indices
from octsim.config.dispersion_forms import CauchyIndex, SellmeierIndex, TableIndex
from octsim.config.fields import Index, Section, as_text
from octsim.config.units import find_unit
from octsim.config.wording import message_of
from octsim.optics.materials import Cauchy, Constant, Material, Sellmeier, Table
from octsim.optics.shipped_materials import SHIPPED

KINDS = ("cauchy", "sellmeier", "table")
"""Keys of dispersions, of which one has one."""
FORMS = (
    "it should be a number, {cauchy: [A, B, C]}, {sellmeier: {B: [...], C: [...]}}, {table: "
    f"file.csv}} or the name of a material that octsim has: {', '.join(SHIPPED)}"
)


def unit_of_length(unit: str) -> str:
    """Return a unit, if it is one of length that is known."""
    found = find_unit(unit)
    if found is None or found.dimension != "length":
        raise ValueError(f"{unit} is not a unit of length that is known; give one, as nm or um")
    return unit


class TableFile(Section):
    """A file with a table of refractive indices; a checked config holds what was in it."""

    table: Annotated[str, Field(min_length=1)]
    """Path of a CSV file, from the current folder: columns wavelength, n and maybe kappa."""
    unit: Annotated[str, AfterValidator(unit_of_length)] | None = None
    """Of its wavelengths, where their heading does not say it."""


def _inline(file: TableFile) -> TableIndex:
    rows = read_indices(file.table, file.unit)
    columns = {"wavelength": rows.wavelength, "n": rows.n, "kappa": rows.kappa}
    try:
        index = TableIndex.model_validate({"table": columns})
    except ValidationError as error:
        first = error.errors()[0]
        name, place = (*first["loc"][1:], "", "")[:2]
        where = f", row {rows.number[place]}" if isinstance(place, int) else ""
        what = ""
        if isinstance(place, int):
            given = columns[str(name)]
            what = f"{name} {given[place] if given else 0:g}: "
        said = message_of(first)
        if name == "wavelength" and first["type"] == "less_than_equal":
            what = what.replace(": ", " um: ")
            said += f" um, and the unit is {rows.unit}; are these nm?"
        raise ValueError(f"{file.table}{where}: {what}{said}") from None
    index.name_file(file.table)
    return index


def _shipped(name: str) -> str:
    if name not in SHIPPED:
        alike = {known.lower(): known for known in SHIPPED}
        nearest = alike[difflib.get_close_matches(name.lower(), alike, n=1, cutoff=0)[0]]
        raise ValueError(f"the nearest material that octsim has is {nearest}; {FORMS}")
    return name


def _form(value: object) -> object:
    if isinstance(value, bool | list | tuple) or value is None:
        raise ValueError(FORMS)
    kinds = [kind for kind in KINDS if kind in value] if isinstance(value, Mapping) else ["number"]
    if len(kinds) > 1:
        raise ValueError(f"it should be one of {' and '.join(kinds)}; leave the others out")
    if not kinds:
        raise ValueError(FORMS)
    return value


def _kind(value: object) -> str:
    match value:
        case CauchyIndex():
            return "cauchy"
        case SellmeierIndex():
            return "sellmeier"
        case TableIndex():
            return "table"
        case str():
            return "name" if value.strip()[:1].isalpha() else "number"
        case Mapping():
            if "table" in value:
                return "file" if isinstance(value["table"], str) else "table"
            return next((kind for kind in KINDS if kind in value), "table")
        case _:
            return "number"


TAGS = (*KINDS, "file", "name", "number")
"""What an index is read as, in the places of errors."""
Dispersion = CauchyIndex | SellmeierIndex | TableIndex
"""An index that is no number or name."""

if TYPE_CHECKING:
    from typing import TypeAlias

    # whoever asks for the index of one medium by its name knows which kind it is
    MediumIndex: TypeAlias = Any
else:
    MediumIndex = Annotated[
        Annotated[Index, Tag("number")]
        | Annotated[str, AfterValidator(_shipped), Tag("name")]
        | Annotated[CauchyIndex, Tag("cauchy")]
        | Annotated[SellmeierIndex, Tag("sellmeier")]
        | Annotated[TableIndex, Tag("table")]
        | Annotated[TableFile, AfterValidator(_inline), Tag("file")],
        Discriminator(_kind),
        BeforeValidator(_form),
    ]


def material_of(index: float | str | Dispersion) -> Material:
    """Return the material that an index of a config is."""
    if isinstance(index, str):
        return SHIPPED[index].material
    return index.material if isinstance(index, Dispersion) else Constant(index)


def described(index: float | str | Dispersion) -> str:
    """Write an index of a config on one line; of a table just where it is one."""
    if isinstance(index, TableIndex):
        first, last = index.table.wavelength[0], index.table.wavelength[-1]
        return f"{index.where} from {first:.10g} um to {last:.10g} um"
    if isinstance(index, Section):
        return as_text(index.model_dump(mode="json"))
    return str(index)


def span_of(index: float | str | Dispersion) -> tuple[float, float] | None:
    """Return between which wavelengths, µm, an index is known; None where nothing says so."""
    if isinstance(index, str):
        return SHIPPED[index].wavelength
    if isinstance(index, TableIndex):
        return index.table.wavelength[0], index.table.wavelength[-1]
    return None


def absorbs(index: float | str | Dispersion) -> bool:
    """Return whether an index is complex."""
    return isinstance(index, TableIndex) and any(index.table.kappa or ())


def without_absorption(index: Any) -> Any:
    """Return an index of a config, not checked, whose κ is zero."""
    if not absorbs(index):
        return index
    return TableIndex(table=index.table.model_copy(update={"kappa": None}))


def moved(
    index: float | str | Dispersion, n: float, wavenumber: float
) -> float | dict[Literal["cauchy", "sellmeier", "table"], Any]:
    """Return an index of a config, as plain data, moved so that it is n at a wavenumber, 1/µm.

    It is as dispersive as before: a table and Cauchy's formula are moved by the same everywhere,
    Sellmeier's in its square.
    """
    material = material_of(index)
    by = n - material.index(wavenumber).real
    match material:
        case Cauchy(coefficients=(first, *others)):
            return {"cauchy": [first + by, *others]}
        case Sellmeier(b=b, c=c):
            # a resonance at zero is a constant
            square = n**2 - material.index(wavenumber).real ** 2
            return {"sellmeier": {"B": [*b, square], "C": [*c, 0.0]}}
        case Table():
            columns = index.table.model_dump(mode="json")  # type: ignore[union-attr]
            return {"table": {**columns, "n": [one + by for one in material.n]}}
        case _:
            return n
