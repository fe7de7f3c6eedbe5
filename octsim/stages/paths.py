"""What each light path has in a spectrum: its amplitude, phase, optical path and share."""

from collections.abc import Iterator
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from octsim.config.models import Config
from octsim.datasets.layout import Coordinate, Layout
from octsim.datasets.reader import Stored
from octsim.datasets.streams import Part, Stream, Streamed
from octsim.instrument.build import surface_names
from octsim.schemes.field_sum import fields_in_groups
from octsim.schemes.light import Light
from octsim.stages.detections import stored_light
from octsim.stages.workload import point_cost, points_per_block
from octsim.tracing.light_paths import path_name

_SAMPLES = 101  # of the band, for means over it


def _mean_paths(light: Light, row: NDArray[np.int64], paths: int) -> NDArray[np.float64]:
    """Return each path's mean optical path, weighted with amplitudes, (P,); NaN without rays."""
    size = np.abs(light.amplitude)
    total = np.bincount(row, size * light.optical_path_length, paths)
    weight = np.bincount(row, size, paths)
    mean: NDArray[np.float64] = np.full(paths, np.nan)
    np.divide(total, weight, out=mean, where=weight > 0)
    return mean


def _strongest_first(layout: Layout, stored: Stored) -> NDArray[np.int64]:
    """Return every path of a sweep, that of the strongest field at mid-band first."""
    strength: dict[int, float] = {}
    for at, span in layout.blocks(_block_points):
        part = stored.part(at, span)
        codes, row = np.unique(part["path_code"].values, return_inverse=True)
        if codes.size == 0:
            continue
        k = at.config.spectrum.wavenumbers()
        point = np.repeat(np.arange(part.sizes["diameter"]), part["rays_detected"].values)
        phase = (k[0] + k[-1]) / 2 * part["optical_path_length"].values
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


def _block_points(config: Config) -> int:
    return points_per_block(point_cost(config).size + 1000)


@Streamed
def light_paths(config: Config, detected: xr.Dataset) -> Stream:
    r"""Return what each light path has in the spectra of a sweep.

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

    def swept(config: Config) -> dict[str, Coordinate]:
        return {"diameter": ("diameter", config.sweep.diameters.values())}

    title = "What each light path has in the spectra"
    unnamed = Layout("paths", config, title, swept, "diameter")
    stored = Stored(detected, "detections", config, unnamed)
    codes = _strongest_first(unnamed, stored)
    names = surface_names(config)
    named: dict[str, Coordinate] = {
        "path": ("path", np.array([path_name(code, names) for code in codes.tolist()], str)),
        "path_code": ("path", codes),
    }
    layout = Layout("paths", config, title, lambda config: named | swept(config), "diameter")
    return Stream(layout, _shared(layout, stored, codes))


def _shared(layout: Layout, stored: Stored, codes: NDArray[np.int64]) -> Iterator[Part]:
    order = np.argsort(codes)
    for at, span in layout.blocks(_block_points):
        k = at.config.spectrum.wavenumbers()
        step = (k[-1] - k[0]) / (_SAMPLES - 1)
        found = []
        for light in stored_light(stored.part(at, span)):
            row = order[np.searchsorted(codes, light.path, sorter=order)]
            found.append(_shares(light, row, order, k[0], step))
        variables = {
            name: (("path", "diameter"), np.stack([one[name] for one in found], axis=1))
            for name in found[0]
        }
        yield Part(at, span.start, len(found), variables)


def _shares(
    light: Light, row: NDArray[np.int64], order: NDArray[np.int64], first: float, step: float
) -> dict[str, NDArray[Any]]:
    """Return what each path has in one spectrum.

    `row` is the path's number, of each ray; `order` lists the paths as they are summed, so that
    those which only other spectra have change no bit. Real arithmetic, as the rounding of complex
    products hangs on the processor and on a value's place in memory.
    """
    paths = order.size
    real, imaginary = fields_in_groups(
        row, light.amplitude, light.optical_path_length, paths, first, step, _SAMPLES
    )
    whole, whole_i = real[order].sum(axis=0), imaginary[order].sum(axis=0)
    intensity = float((whole * whole + whole_i * whole_i).sum())
    taken = (real * whole + imaginary * whole_i).sum(axis=1)
    middle, middle_i = (part[:, _SAMPLES // 2].copy() for part in (real, imaginary))
    rays = np.bincount(row, minlength=paths)
    return {
        "field_amplitude": np.hypot(middle, middle_i),
        "field_phase": np.where(rays > 0, np.arctan2(middle_i, middle), np.nan),
        "mean_optical_path_length": _mean_paths(light, row, paths),
        "share": taken / intensity if intensity > 0 else np.zeros(paths),
        "path_rays": rays,
    }
