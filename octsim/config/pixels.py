"""The part of the config on a spectrometer's pixels: which wavelength each of them sees."""

from collections.abc import Mapping
from typing import TYPE_CHECKING, Annotated, Any

from pydantic import BeforeValidator, Discriminator, Field, Tag

from octsim.config.dispersion_forms import Ascending
from octsim.config.fields import Number, Section, absent, listed
from octsim.config.source import Band
from octsim.config.table_text import WAVELENGTH, is_number, read_blocks, unit_in, unit_of
from octsim.config.units import format_length, parse_length

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    Array = NDArray[np.float64]

FORMS = (
    "it should be lab, which is measured.axis, {wavelength: calib.csv}, or {polynomial: [c0, c1, "
    "c2]} over pixels from 0, in nm"
)
LAB = "lab"
FEWEST = 8
"""Pixels of a band."""
_MOST = 1_000_000
_ROUNDING = 1e-9  # µm
_FILE_FORM = "write a first row as 'wavelength (nm)', and a number for each pixel"


class PixelTable(Section):
    """Wavelengths in vacuum at the pixels' middles; a checked config has those of its band."""

    wavelength: Ascending

    @property
    def middles(self) -> "Array":
        """Rising, µm."""
        import numpy as np  # here, as reading a config takes half as long without

        return np.array(self.wavelength)


class PixelPolynomial(Section):
    """Wavelengths in nm as a polynomial of the pixel's number, counted from 0."""

    polynomial: Annotated[
        tuple[Number, ...], BeforeValidator(listed), Field(min_length=2, max_length=10)
    ]

    def up_to(self, band: Band) -> "Array":
        """Return those from pixel 0 on up to beyond a band, rising, µm."""
        import numpy as np

        of, count = np.polynomial.Polynomial(self.polynomial), 1024
        while True:
            nm = of(np.arange(count, dtype=float))
            turn = np.flatnonzero(np.diff(nm) * np.sign(nm[1] - nm[0]) <= 0)
            if turn.size:
                nm = nm[: turn[0] + 1]
            beyond = nm[-1] > 1e3 * band.max if nm[-1] > nm[0] else nm[-1] < 1e3 * band.min
            if beyond or turn.size or count >= _MOST:
                return np.sort(nm) / 1e3
            count *= 4


def _columns_of(file: str) -> list[float]:
    """Return the wavelengths in a file, µm.

    Raises
    ------
    ValueError
        If it can't be read, or holds other than a column of them.
    """
    blocks = read_blocks(file, lambda cells: WAVELENGTH.fullmatch(cells[0].strip()) is not None)
    rows = [row for block in blocks for row in block.rows]
    if len(blocks) != 1 or not rows:
        raise ValueError(f"{file} holds no column of numbers; {_FILE_FORM}")
    match = WAVELENGTH.fullmatch(blocks[0].heading[0].strip()) if blocks[0].heading else None
    unit = unit_of(file, None, match and unit_in(match), _FILE_FORM, "nm")
    for number, row in rows:
        if len(row) != 1 or not is_number(row[0]):
            raise ValueError(f"{file}, row {number}: {' '.join(row)!r} given; {_FILE_FORM}")
    found = [parse_length(f"{row[0]} {unit}") for _, row in rows]
    return found if found[0] < found[-1] else found[::-1]


def _form(value: object) -> object:
    if isinstance(value, Section) or absent(value) is None:
        return absent(value)
    if value == LAB:
        raise ValueError(
            "lab given, but measured.axis is not: wavelengths that stand in the file of spectra "
            "are not seen here; give measured.axis"
        )
    given = value if isinstance(value, Mapping) else {}
    given = {key: one for key, one in given.items() if one is not None}
    if set(given) not in ({"wavelength"}, {"polynomial"}):
        raise ValueError(FORMS)
    if isinstance(given.get("wavelength"), str):
        return {"wavelength": _columns_of(given["wavelength"])}
    return given


def _kind(value: object) -> str:
    polynomial = isinstance(value, PixelPolynomial) or (
        isinstance(value, Mapping) and "polynomial" in value
    )
    return "polynomial" if polynomial else "table"


PixelsConfig = Annotated[
    Annotated[
        Annotated[PixelTable, Tag("table")] | Annotated[PixelPolynomial, Tag("polynomial")],
        Discriminator(_kind),
    ]
    | None,
    BeforeValidator(_form),
]


def inside(known: "Array", band: Band) -> "Array":
    """Return the wavelengths within a band, µm, those at its ends with them."""
    return known[(known >= band.min - _ROUNDING) & (known <= band.max + _ROUNDING)]


def within(given: PixelTable | PixelPolynomial, band: Band) -> PixelTable:
    """Return the pixels of a band, with one beyond each end where it is known.

    Raises
    ------
    ValueError
        If they do not reach over the band, or are too few.
    """
    import numpy as np

    known = given.middles if isinstance(given, PixelTable) else given.up_to(band)
    own, asked = inside(known, band), f"{format_length(band.min)} to {format_length(band.max)}"
    if own.size < FEWEST:
        raise ValueError(
            f"{own.size} pixels are within {asked}, and {FEWEST} are needed; give the "
            "spectrometer's own wavelengths, or a wider spectrum.wavelength"
        )
    step = np.diff(known)
    if known[0] - step[0] > band.min or known[-1] + step[-1] < band.max:
        first, last = (format_length(round(float(one), 6)) for one in known[[0, -1]])
        raise ValueError(
            f"the spectrometer sees {first} to {last}, but spectrum.wavelength is {asked}; give a "
            "band within that"
        )
    first_of, end = np.searchsorted(known, own[0]), np.searchsorted(known, own[-1])
    kept = known[max(int(first_of) - 1, 0) : int(end) + 2]
    return PixelTable(wavelength=tuple(kept.tolist()))


def with_lab_pixels(data: Any) -> Any:
    """Return a config's plain data with ``spectrum.pixels: lab`` as ``measured.axis`` has them."""
    spectrum = data.get("spectrum") if isinstance(data, Mapping) else None
    if not isinstance(spectrum, Mapping) or spectrum.get("pixels") != LAB:
        return data
    measured = data.get("measured")
    axis = measured.get("axis") if isinstance(measured, Mapping) else None
    if not isinstance(axis, Mapping):
        return data
    return {**data, "spectrum": {**spectrum, "pixels": dict(axis)}}
