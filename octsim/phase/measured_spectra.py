"""Measured spectra: read, checked, and brought to evenly spaced wavenumbers."""

import csv
import re
from pathlib import Path
from typing import NamedTuple

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from octsim.base.errors import DatasetError, FileError
from octsim.base.files import reason
from octsim.config.units import inverted, parse_length

Array = NDArray[np.float64]

EVEN = 1e-6
"""Largest departure from even spacing, over the spacing, that counts as none."""
FEWEST = 8
"""Fewest samples of a spectrum."""
_HEAD = re.compile(r"\s*(wavelength|wavenumber)\s*[(\[]?\s*([^)\]]*?)\s*[)\]]?\s*", re.IGNORECASE)
_FORM = (
    "write a first column headed 'wavelength (nm)' or 'wavenumber (1/um)' and a column of "
    "intensity for each spectrum"
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
    """Read spectra, and bring them to evenly spaced wavenumbers; see `read_raw` and `even`."""
    return even(*read_raw(source))


def read_raw(source: str | Path | xr.Dataset) -> Raw:
    """Read spectra from netCDF or CSV, or take them from a dataset.

    Parameters
    ----------
    source : path or Dataset
        A ``.csv`` file: a first column headed ``wavelength (nm)`` or ``wavenumber (1/um)``, any
        unit of length, and a column for each spectrum. Any other file is netCDF, and like a
        dataset holds ``intensity`` over a coordinate ``wavelength`` or ``wavenumber`` with the
        attribute ``units``, and over one other dimension or none.

    Raises
    ------
    FileError
        If a file can't be read.
    DatasetError
        If it does not hold spectra, or these can't be used.
    """
    if isinstance(source, xr.Dataset):
        return _of_dataset(source, "dataset")
    path = Path(source)
    if path.suffix.lower() == ".csv":
        return _of_csv(path)
    try:
        return _of_dataset(xr.load_dataset(path, engine="netcdf4"), str(path))
    except (OSError, RuntimeError, ValueError) as error:
        raise FileError(f"{path}: can't be read ({reason(error)}); give netCDF or CSV") from None


def _of_dataset(dataset: xr.Dataset, name: str) -> Raw:
    axes = [axis for axis in ("wavenumber", "wavelength") if axis in dataset.coords]
    if "intensity" not in dataset or not axes or axes[0] not in dataset["intensity"].dims:
        raise DatasetError(
            f"{name}: no variable intensity over a coordinate wavelength or wavenumber; name it so"
        )
    spectra = dataset["intensity"].transpose(..., axes[0])
    if spectra.ndim > 2:
        raise DatasetError(
            f"{name}: intensity has the dimensions {', '.join(map(str, spectra.dims))}; give one "
            f"besides {axes[0]}, or none"
        )
    units = str(dataset[axes[0]].attrs.get("units", ""))
    along = np.asarray(dataset[axes[0]].values, float)
    return Raw(_wavenumbers(along, axes[0], units, name), np.atleast_2d(spectra.values), name)


def _of_csv(path: Path) -> Raw:
    try:
        with path.open(encoding="utf-8-sig", newline="") as file:
            head, *rows = [row for row in csv.reader(file) if any(cell.strip() for cell in row)]
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        raise FileError(f"{path}: can't be read ({reason(error)}); give netCDF or CSV") from None
    except ValueError:
        raise DatasetError(f"{path}: empty; {_FORM}") from None
    match = _HEAD.fullmatch(head[0])
    if match is None or len(head) < 2:
        raise DatasetError(f"{path}: the header is {','.join(head)!r}; {_FORM}")
    values = np.empty((len(rows), len(head)))
    for number, row in enumerate(rows):
        try:
            values[number] = np.array([float(cell) for cell in row]).reshape(len(head))
        except ValueError:
            raise DatasetError(
                f"{path}, row {number + 2}: {','.join(row)!r} given; write {len(head)} numbers"
            ) from None
    axis = match[1].lower()
    return Raw(_wavenumbers(values[:, 0], axis, match[2], str(path)), values[:, 1:].T, str(path))


def _wavenumbers(along: Array, axis: str, units: str, name: str) -> Array:
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

    By a cubic spline, whose error falls with the fourth power of the spacing. Values are taken as
    they are, those of I at each wavenumber: no factor dλ/dk is applied.

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
    steps = np.diff(wavenumber)
    if not (steps > 0).all():
        place = int(np.argmax(steps <= 0))
        raise DatasetError(
            f"{name}: wavelengths or wavenumbers out of order, or twice, at "
            f"{wavenumber[place]:.6g} 1/um; sort them"
        )
    bad = ~np.isfinite(intensity)
    if bad.any():
        spectrum, sample = np.argwhere(bad)[0]
        raise DatasetError(
            f"{name}: {bad.sum()} values of intensity are not numbers, the first in spectrum "
            f"{spectrum}, at {wavenumber[sample]:.6g} 1/um; mend or leave them out"
        )
    target = np.linspace(wavenumber[0], wavenumber[-1], wavenumber.size)
    if np.abs(wavenumber - target).max() > EVEN * steps.mean():
        from scipy.interpolate import CubicSpline  # half a second that few need

        intensity = CubicSpline(wavenumber, intensity, axis=1)(target)
    return Measured(np.ascontiguousarray(intensity, float), target)
