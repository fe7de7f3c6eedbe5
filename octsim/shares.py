"""What each light path has in a spectrum: its amplitude, phase, optical path and share."""

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from octsim.config import Config
from octsim.datasets import make
from octsim.light import Light
from octsim.paths import path_name
from octsim.spectrum import wavenumbers
from octsim.sweep import stored_light

_SAMPLES = 101  # of the band, for means over it


def _path_fields(
    light: Light, codes: NDArray[np.int64], wavenumber: NDArray[np.float64]
) -> NDArray[np.complex128]:
    """Sum the rays of each path, (P, K)."""
    row = np.searchsorted(codes, light.path)
    rays = light.amplitude * np.exp(1j * wavenumber[:, None] * light.optical_path_length)
    fields = np.zeros((codes.size, wavenumber.size), complex)
    np.add.at(fields, row, rays.T)
    return fields


def _mean_paths(light: Light, codes: NDArray[np.int64]) -> NDArray[np.float64]:
    """Mean optical path of each path's rays, weighted with their amplitudes, (P,); NaN if none."""
    row, size = np.searchsorted(codes, light.path), np.abs(light.amplitude)
    total = np.bincount(row, size * light.optical_path_length, codes.size)
    weight = np.bincount(row, size, codes.size)
    mean: NDArray[np.float64] = np.full(codes.size, np.nan)
    np.divide(total, weight, out=mean, where=weight > 0)
    return mean


def light_paths(config: Config, detected: xr.Dataset) -> xr.Dataset:
    r"""Tell what each light path has in the spectra of a sweep.

    A path's share of the intensity is

    .. math:: \int \mathrm{Re}(E_p^* E)\, dk \Big/ \int |E|^2\, dk, \quad E = \sum_p E_p

    over the band: shares sum to one, and that of a path which takes away is negative.

    Returns
    -------
    Dataset
        field_amplitude and field_phase, at the middle of the band, mean_optical_path_length, share
        and path_rays (path, diameter); path_code(path). The strongest path is first. A path that
        does not reach the detector at a diameter has no rays there, and its phase and optical path
        are NaN.
    """
    lights, k = stored_light(detected), wavenumbers(config.spectrum)
    codes = np.unique(detected["path_code"].values)
    band = np.linspace(k[0], k[-1], _SAMPLES)
    fields = np.stack([_path_fields(light, codes, band) for light in lights], axis=1)
    whole = fields.sum(axis=0)
    intensity = (np.abs(whole) ** 2).sum(axis=1)
    taken = (fields.conj() * whole).real.sum(axis=2)
    share = np.divide(taken, intensity, out=np.zeros_like(taken), where=intensity > 0)
    middle = fields[:, :, _SAMPLES // 2]
    rays = np.stack(
        [np.bincount(np.searchsorted(codes, light.path), minlength=codes.size) for light in lights],
        axis=1,
    )
    order = np.argsort(-np.abs(middle).mean(axis=1), kind="stable")
    dimensions = ("path", "diameter")
    optical = np.stack([_mean_paths(light, codes) for light in lights], axis=1)
    phase = np.where(rays > 0, np.angle(middle), np.nan)
    return make(
        "paths",
        config,
        "What each light path has in the spectra",
        {
            "field_amplitude": (dimensions, np.abs(middle)[order]),
            "field_phase": (dimensions, phase[order]),
            "mean_optical_path_length": (dimensions, optical[order]),
            "share": (dimensions, share[order]),
            "path_rays": (dimensions, rays[order]),
            "path_code": ("path", codes[order]),
        },
        {
            "path": [path_name(code) for code in codes[order].tolist()],
            "diameter": detected["diameter"].values,
        },
        __name__,
    )
