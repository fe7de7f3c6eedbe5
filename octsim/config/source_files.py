"""Files that hold a source's spectrum: a wavelength and a power in each row."""

from octsim.config.table_text import WAVELENGTH, is_number, read_blocks, unit_in, unit_of
from octsim.config.units import parse_length

FORM = "write a first row as 'wavelength (nm),power', and a row of numbers for each wavelength"


def read_source(file: str, unit: str | None) -> dict[str, list[float]]:
    """Return the columns wavelength (µm) and power of a file, by rising wavelength.

    Parameters
    ----------
    file : str
        Path of it, from the current folder: read as `octsim.config.table_text.read_blocks` does.
    unit : str or None
        Of the wavelengths; None is as their heading says.

    Raises
    ------
    ValueError
        If it can't be read or does not hold them; with the row, counted from 1.
    """
    blocks = read_blocks(file, lambda cells: WAVELENGTH.fullmatch(cells[0].strip()) is not None)
    if len(blocks) != 1 or not blocks[0].rows:
        raise ValueError(
            f"{file} holds {len(blocks)} blocks of rows, where it should be one; {FORM}"
        )
    heading, rows = blocks[0]
    match = WAVELENGTH.fullmatch(heading[0].strip()) if heading else None
    if heading and (match is None or len(heading) != 2):
        raise ValueError(f"{file} has the headings {', '.join(heading)}; {FORM}")
    unit = unit_of(file, unit, match and unit_in(match), FORM)
    found = []
    for number, row in rows:
        if len(row) != 2 or not all(map(is_number, row)):
            raise ValueError(f"{file}, row {number}: {' '.join(row)!r} given; {FORM}")
        found.append((parse_length(f"{row[0]} {unit}"), float(row[1])))
    if len(found) > 1 and found[0][0] > found[-1][0]:
        found.reverse()
    return {"wavelength": [one for one, _ in found], "power": [one for _, one in found]}
