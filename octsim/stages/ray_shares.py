"""What each light path has in a spectrum that is a sum of rays."""

from collections.abc import Iterable
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from octsim.schemes.field_sum import fields_in_groups
from octsim.schemes.light import Light

SAMPLES = 101
"""Of the band, for means over it."""


def _mean_paths(light: Light, row: NDArray[np.int64], paths: int) -> NDArray[np.float64]:
    """Return each path's mean optical path, weighted with amplitudes, (P,); NaN without rays."""
    size = np.abs(light.amplitude)
    total = np.bincount(row, size * light.optical_path_length, paths)
    weight = np.bincount(row, size, paths)
    mean: NDArray[np.float64] = np.full(paths, np.nan)
    np.divide(total, weight, out=mean, where=weight > 0)
    return mean


def strongest_first(parts: Iterable[tuple[xr.Dataset, float]]) -> NDArray[np.int64]:
    """Return every path of a sweep, that of the strongest field first.

    Parameters
    ----------
    parts : iterable of Dataset and float
        Some diameters' rays, and the wavenumber (1/µm) at which fields are compared.
    """
    strength: dict[int, float] = {}
    for part, wavenumber in parts:
        codes, row = np.unique(part["path_code"].values, return_inverse=True)
        if codes.size == 0:
            continue
        point = np.repeat(np.arange(part.sizes["diameter"]), part["rays_detected"].values)
        phase = wavenumber * part["optical_path_length"].values
        field = [
            np.bincount(
                point * codes.size + row, part["amplitude"].values * wave,
                part.sizes["diameter"] * codes.size,
            )
            for wave in (np.cos(phase), np.sin(phase))
        ]  # fmt: skip
        size = np.hypot(*field).reshape(-1, codes.size)
        # one after the other, so that blocks of other sizes give the same bits
        for code, sizes in zip(codes.tolist(), size.T.tolist(), strict=True):
            for one in sizes:
                strength[code] = strength.get(code, 0.0) + one
    return np.array(sorted(strength, key=lambda code: (-strength[code], code)), np.int64)


def ray_shares(
    light: Light, codes: NDArray[np.int64], first: float, step: float
) -> dict[str, NDArray[Any]]:
    """Return what each path, of some codes, has in one spectrum, by the variable's name; all (P,).

    Paths are summed in the order of their codes, so that those which only other spectra have change
    no bit. Real arithmetic, as the rounding of complex products hangs on the processor and on a
    value's place in memory.

    Parameters
    ----------
    light : Light
        The rays.
    codes : ndarray, shape (P,)
        Of all paths of the sweep.
    first, step : float
        First of `SAMPLES` wavenumbers and their spacing, 1/µm.
    """
    order, paths = np.argsort(codes), codes.size
    row = order[np.searchsorted(codes, light.path, sorter=order)]
    real, imaginary = fields_in_groups(
        row, light.amplitude, light.optical_path_length, paths, first, step, SAMPLES
    )
    whole, whole_i = real[order].sum(axis=0), imaginary[order].sum(axis=0)
    intensity = float((whole * whole + whole_i * whole_i).sum())
    taken = (real * whole + imaginary * whole_i).sum(axis=1)
    middle, middle_i = (part[:, SAMPLES // 2].copy() for part in (real, imaginary))
    rays = np.bincount(row, minlength=paths)
    return {
        "field_amplitude": np.hypot(middle, middle_i),
        "field_phase": np.where(rays > 0, np.arctan2(middle_i, middle), np.nan),
        "mean_optical_path_length": _mean_paths(light, row, paths),
        "share": taken / intensity if intensity > 0 else np.zeros(paths),
        "path_rays": rays,
    }
