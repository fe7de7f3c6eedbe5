"""Measured spectra: read, checked, and brought to evenly spaced wavenumbers."""

from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from octsim.base.errors import DatasetError
from octsim.config.units import inverted, parse_length
from octsim.phase.measured_headings import listed, of_errors, parse
from octsim.phase.measured_netcdf import read_variables
from octsim.phase.measured_tables import Table, is_netcdf, numbers, read_table, shown
from octsim.phase.stand_ins import stand_ins

Array = NDArray[np.float64]

EVEN = 1e-6
"""Largest departure from even spacing, over the spacing, that counts as none."""
FEWEST = 8
"""Fewest samples of a spectrum."""
_DEGREE = 5
AXES = ("wavenumber", "wavelength")
SHORTEST, LONGEST = 0.05, 100.0
"""Wavelengths, µm, between which they may be those of a spectrometer: 'um' is no 'nm'."""
_FORM = (
    "write a first column headed 'wavelength (nm)' or 'wavenumber (1/um)' and a named "
    "column for each spectrum"
)


class Measured(NamedTuple):
    """Measured spectra over evenly spaced, increasing wavenumbers."""

    intensity: Array
    """Spectra, (D, K), in their own unit."""
    wavenumber: Array
    """Wavenumbers 2π/λ, (K,), 1/µm."""


class Raw(NamedTuple):
    """Spectra as they were measured, over wavenumbers in any spacing, rising or falling."""

    wavenumber: Array
    """Wavenumbers 2π/λ, (K,), 1/µm."""
    intensity: Array
    """Spectra, (D, K), in their own unit."""
    name: str
    """Where they are from, for what is said of them."""


def read_spectra(source: str | Path | xr.Dataset) -> Measured:
    """Read spectra, and bring them to evenly spaced wavenumbers; see `read_raw` and `even`.

    Examples
    --------
    >>> import octsim
    >>> import numpy as np, xarray as xr
    >>> k = np.linspace(7, 9.7, 500)
    >>> spectra = xr.Dataset(
    ...     {"intensity": ("wavenumber", 2 + np.cos(2 * 1.9 * k))},
    ...     {"wavenumber": ("wavenumber", k, {"units": "um-1"})},
    ... )
    >>> octsim.read_spectra(spectra).intensity.shape
    (1, 500)
    """
    return even(*read_raw(source))


def read_raw(source: str | Path | xr.Dataset) -> Raw:
    """Read spectra from netCDF or CSV, or take them from a dataset.

    Parameters
    ----------
    source : path or Dataset
        A CSV file: a first column headed ``wavelength (nm)`` or ``wavenumber (1/um)``, any unit of
        length, and a column for each spectrum; see `octsim.phase.measured_tables.read_table` for
        how strictly it is read. A netCDF file, like a dataset, holds ``intensity`` over a
        coordinate ``wavelength`` or ``wavenumber`` with the attribute ``units``, and over one other
        dimension or none. The first bytes of a file tell which it is.

    Raises
    ------
    FileError
        If a file can't be read.
    DatasetError
        If it does not hold spectra, or these can't be used.
    """
    if isinstance(source, xr.Dataset):
        return _of_dataset(source, "dataset")
    if not isinstance(source, str | Path):
        raise DatasetError(
            f"spectra: {type(source).__name__} given; give a file's name, or a Dataset as "
            'xr.Dataset({"intensity": (("time", "wavelength"), counts)}, '
            '{"wavelength": ("wavelength", nm, {"units": "nm"})})'
        )
    path = Path(source)
    return _of_dataset(read_variables(path), str(path)) if is_netcdf(path) else _of_csv(path)


def _of_dataset(dataset: xr.Dataset, name: str) -> Raw:
    axes = [axis for axis in AXES if axis in dataset.coords]
    if "intensity" not in dataset or not axes or axes[0] not in dataset["intensity"].dims:
        raise DatasetError(
            f"{name}: no variable intensity over a coordinate wavelength or wavenumber; name it so "
            f"(it holds {listed(list(map(str, dataset.variables))) or 'nothing'})"
        )
    spectra = dataset["intensity"].transpose(..., axes[0])
    if spectra.ndim > 2:
        raise DatasetError(
            f"{name}: intensity has the dimensions {', '.join(map(str, spectra.dims))}; give one "
            f"besides {axes[0]}, or none"
        )
    units = str(dataset[axes[0]].attrs.get("units", ""))
    along = np.asarray(dataset[axes[0]].values, float)
    return Raw(wavenumbers_of(along, axes[0], units, name), np.atleast_2d(spectra.values), name)


def _problem(headings: Sequence[str]) -> str | None:
    """Return in a line what is wrong with the headings of spectra, if something is."""
    if not headings:
        return _FORM
    axis, *spectra = headings
    named, first = [text for text in spectra if text], parse(axis)
    if first is None or first.name not in AXES or not named:
        return f"the header is {shown(','.join(headings))}; {_FORM}"
    others = [text for text in named if parse(text) or of_errors(text)]
    if others:
        return f"the column {others[0]!r} is of no spectrum, and would be read as one; leave it out"
    twice = [text for text in named if named.count(text) > 1]
    if twice:
        return f"{named.count(twice[0])} columns are headed {twice[0]!r}; give each its own name"
    return None


def _of_csv(path: Path) -> Raw:
    table = read_table(path, _problem)
    heading, *columns = [
        (text, _intensities(table, place, text))
        for place, text in enumerate(table.headings)
        if text or _nameless(table, place)
    ]
    axis = parse(heading[0])
    assert axis is not None, "as _problem has seen"
    along = heading[1]
    turned = np.diff(along) * np.sign(along[-1:] - along[:1]) <= 0
    if turned.any():
        at = 1 + int(turned.argmax())
        raise DatasetError(
            f"{path}, row {table.rows[at]}: {heading[0]} goes from {along[at - 1]:g} to "
            f"{along[at]:g}; sort the rows, each once"
        )
    k = wavenumbers_of(along, axis.name, axis.unit or "", str(path))
    return Raw(k, np.array([values for _, values in columns]), str(path))


def _nameless(table: Table, place: int) -> bool:
    """Refuse a column of values without a heading; one without values is none."""
    for row, cells in zip(table.rows, table.cells, strict=True):
        if cells[place]:
            raise DatasetError(
                f"{table.path}, row {row}: {shown(cells[place])} stands in column {place + 1}, "
                "which has no heading; give it one"
            )
    return False


def _intensities(table: Table, place: int, name: str) -> Array:
    """Return the numbers in a column, each of which has to be one."""
    found = numbers(table, place, name)
    bad = ~np.isfinite(found) | stand_ins(found)
    if bad.any():
        at = int(bad.argmax())
        given = shown(table.cells[at][place])
        raise DatasetError(
            f"{table.path}, row {table.rows[at]}: {name} is {given}, which is no value; give one, "
            "or leave the row out"
        )
    return found


def wavenumbers_of(along: Array, axis: str, units: str, name: str) -> Array:
    """Convert wavelengths or wavenumbers of some unit to wavenumbers in 1/µm."""
    length = units if axis == "wavelength" else inverted(units)
    if axis == "wavenumber" and length == "cm":
        raise DatasetError(
            f"{name}: wavenumber has the unit {units!r}, by which most mean 1/λ; here it is 2π/λ: "
            "give wavelengths, or rad/um"
        )
    try:
        scale = parse_length(f"1 {length}")
    except ValueError:
        example = "nm" if axis == "wavelength" else "1/um"
        raise DatasetError(
            f"{name}: {axis} has the unit {units!r}; give one such as {example}"
        ) from None
    with np.errstate(divide="ignore"):
        return 2 * np.pi / (along * scale) if axis == "wavelength" else along / scale


def even(wavenumber: Array, intensity: Array, name: str) -> Measured:
    """Bring spectra to as many evenly spaced wavenumbers between the same ends.

    By a spline, see `resampled`. Values are taken as they are, those of I at each wavenumber: no
    factor dλ/dk is applied.

    Parameters
    ----------
    wavenumber : ndarray, shape (K,)
        Rising or falling wavenumbers, 1/µm.
    intensity : ndarray, shape (D, K)
        Spectra.
    name : str
        Where they are from, for what is said of them.

    Raises
    ------
    DatasetError
        If there are too few samples, values that are no numbers, or wavenumbers out of order.
    """
    if wavenumber.size < FEWEST:
        raise DatasetError(f"{name}: {wavenumber.size} samples given; give {FEWEST} or more")
    if wavenumber[0] > wavenumber[-1]:
        wavenumber, intensity = wavenumber[::-1], intensity[:, ::-1]
    if not (np.isfinite(wavenumber).all() and wavenumber[0] > 0):
        raise DatasetError(f"{name}: a wavelength or wavenumber is not a positive number; mend it")
    longest, shortest = (2 * np.pi / float(wavenumber[end]) for end in (0, -1))
    if longest > LONGEST or shortest < SHORTEST:
        raise DatasetError(
            f"{name}: wavelengths from {shortest:.3g} to {longest:.3g} um given, not "
            "those of a spectrometer; look at their unit, and for values that stand for none"
        )
    steps = np.diff(wavenumber)
    if not (steps > 0).all():
        place = int(np.argmax(steps <= 0))
        raise DatasetError(
            f"{name}: wavelengths or wavenumbers out of order, or twice, at "
            f"{wavenumber[place]:.6g} 1/um; sort them"
        )
    bad = ~np.isfinite(intensity) | stand_ins(intensity)
    if bad.any():
        spectrum, sample = np.argwhere(bad)[0]
        raise DatasetError(
            f"{name}: {bad.sum()} values of intensity are not numbers, the first in spectrum "
            f"{spectrum}, {intensity[spectrum, sample]:g} at {wavenumber[sample]:.6g} 1/um; mend "
            "or leave them out"
        )
    target = np.linspace(wavenumber[0], wavenumber[-1], wavenumber.size)
    if np.abs(wavenumber - target).max() > EVEN * steps.mean():
        intensity = resampled(intensity, wavenumber, target)
    return Measured(np.ascontiguousarray(intensity, float), target)


def resampled(intensity: Array, wavenumber: Array, target: Array) -> Array:
    """Return spectra (D, K) at other wavenumbers within the same band, by a quintic spline.

    A fringe of half as many oscillations as the samples resolve keeps its phase to 0.03 mrad (a
    cubic one: 0.3 mrad), of a quarter as many to 3e-4 mrad.
    """
    from scipy.interpolate import make_interp_spline  # half a second that few need

    found: Array = make_interp_spline(wavenumber, intensity, k=_DEGREE, axis=1)(target)
    return found
