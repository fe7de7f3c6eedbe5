"""The values that a report's charts are drawn from, as the page's script reads them."""

import base64
from collections.abc import Mapping
from typing import Any

import matplotlib as mpl
import numpy as np
import xarray as xr
from numpy.typing import NDArray

from octsim.config.models import Config
from octsim.figures.envelope import band, extremes
from octsim.figures.expansion import TIME_UNIT, standard_error
from octsim.phase.fringe_status import FringeStatus
from octsim.phase.transform import optical_depths, prepared, without_source
from octsim.report.shown import Shown

MOST_DIAMETERS = 201
"""Diameters whose spectra are in a page."""
MOST_SAMPLES = 500
"""Samples of each spectrum that are in a page."""
MOST_DEPTHS = 300
"""Depths of each A-scan that are in a page."""
MOST_PATHS = 8
"""Light paths whose shares are listed."""
_NOMINAL_DEPTHS = 4
"""Depth to which an A-scan is shown, over the largest optical depth of the swept diameters."""
_PADDING = (8, 4, 2, 1)
"""How many times as long a spectrum is made by zeros, the finest first."""
_FLOOR = 1e-6
"""Least magnitude over the largest, that a logarithm is taken of: −120 dB."""

Array = NDArray[np.float64]


def packed(values: Any, double: bool = False) -> dict[str, str]:
    """Return numbers in base64, little-endian: single precision unless double is asked for."""
    form = "<f8" if double else "<f4"
    data = np.ascontiguousarray(values, dtype=form).tobytes()
    return {"type": form[1:], "data": base64.b64encode(data).decode()}


def every(count: int, most: int) -> slice:
    """Return the slice that takes every so many of some things, and at most so many of them."""
    return slice(None, None, -(-count // most) or 1)


def values_of(shown: Shown) -> dict[str, Any]:
    """Return all that the charts are drawn from; a chart without its dataset is None."""
    there = shown.datasets
    slopes, spectra = there.get("phase_slope"), there.get("spectra")
    swept = slopes if slopes is not None else spectra
    diameter = None if swept is None else swept["diameter"].values
    chosen = slice(None) if diameter is None else every(diameter.size, MOST_DIAMETERS)
    paths = there.get("paths")
    return {
        "diameter": None if diameter is None else packed(diameter[chosen], double=True),
        "every": chosen.step or 1,
        "slope": None if slopes is None else _slopes(slopes, chosen) | _band(there),
        "spectra": None if spectra is None else _spectra(shown.config, spectra, chosen),
        "paths": None if paths is None else _paths(paths, chosen),
        "traces": _traces(there["expansion"]) if "expansion" in there else [],
    }


def _slopes(slopes: xr.Dataset, chosen: slice) -> dict[str, Any]:
    names = ("diameter", "phase_slope", "ideal_phase_slope", "exact_phase_slope")
    columns = {name: packed(slopes[name], double=True) for name in names if name in slopes}
    status = slopes["fringe_status"].values[chosen].tolist() if "fringe_status" in slopes else []
    words = {int(one): one.name.lower().replace("_", " ") for one in FringeStatus}
    return {
        "columns": columns,
        "predicted": _finite(float(slopes["predicted_phase_slope"])),
        "component": slopes["strongest_component"].values[chosen].tolist(),
        "fringe": [words.get(one, "") for one in status],
    }


def _band(there: Mapping[str, xr.Dataset]) -> dict[str, Any]:
    """Return the band of the slope: its standard error by a calibration, else its scatter."""
    if "calibration" in there:
        table = there["calibration"]
        slope = table["fixed_focus_phase_slope"].values
        error = table["fixed_focus_phase_slope_standard_error"].values
        return {
            "band": "calibration, focus held ± standard error",
            "band_diameter": packed(table["diameter"], double=True),
            "middle": packed(slope, double=True),
            "low": packed(slope - error, double=True),
            "high": packed(slope + error, double=True),
        }
    slopes = there["phase_slope"]
    mean, scatter = (
        float(slopes[name]) for name in ("mean_phase_slope", "phase_slope_standard_deviation")
    )
    ends = slopes["diameter"].values[[0, -1]]
    return {
        "band": "mean ± scatter over the diameters",
        "band_diameter": packed(ends, double=True),
        "middle": packed(np.full(2, mean), double=True),
        "low": packed(np.full(2, mean - scatter), double=True),
        "high": packed(np.full(2, mean + scatter), double=True),
    }


def _spectra(config: Config, spectra: xr.Dataset, chosen: slice) -> dict[str, Any]:
    few = spectra.isel(diameter=chosen)
    intensity, k = few["intensity"].values, few["wavenumber"].values
    samples = every(k.size, MOST_SAMPLES)
    depth, magnitude = a_scans(config, intensity, k, few["diameter"].values)
    known, shades = np.isfinite(intensity), mpl.colormaps["cividis"](np.linspace(0, 1, 64))
    return {
        "wavenumber": packed(k[samples], double=True),
        "every": samples.step,
        "of": int(k.size),
        "intensity": packed(intensity[:, samples]),
        "largest": float(intensity[known].max()) if known.any() else None,
        "focus": packed(few["focus"]),
        "error": packed(few["intensity_error"]),
        "depth": packed(depth),
        "decibel": packed(magnitude),
        "nominal": packed(config.swept_group_index * few["diameter"].values),
        "colours": [mpl.colors.to_hex(one) for one in shades],
    }  # fmt: skip


def a_scans(config: Config, intensity: Array, k: Array, diameter: Array) -> tuple[Array, Array]:
    """Return A-scans over the optical depth: spectra's transforms, as the run's `fourier` has them.

    Zeros are appended, so that a peak between two components is seen as one.

    Parameters
    ----------
    config : Config
        A plain one.
    intensity : array, shape (D, K)
        Spectra.
    k : array, shape (K,)
        Wavenumbers, 1/µm.
    diameter : array, shape (D,)
        µm.

    Returns
    -------
    tuple of array
        Optical depth, (Z,), µm, and magnitude over the largest of each A-scan, (D, Z), dB; NaN of a
        spectrum that is not known, or dark.
    """
    deepest = _NOMINAL_DEPTHS * config.swept_group_index * float(diameter.max())
    for padding in _PADDING:
        depth = optical_depths(k, padding * k.size)
        kept = depth[: int(np.searchsorted(depth, deepest)) + 1][: MOST_DEPTHS + 1]
        if kept.size <= MOST_DEPTHS:
            break
    shaped = prepared(without_source(intensity, config.spectrum.power()), config.processing)
    found = np.abs(np.fft.rfft(shaped, padding * k.size, axis=-1))[:, : kept.size]
    largest = found.max(axis=-1, keepdims=True)
    relative = np.divide(found, largest, out=np.full_like(found, np.nan), where=largest > 0)
    return kept, 20 * np.log10(np.maximum(relative, _FLOOR))


def _paths(paths: xr.Dataset, chosen: slice) -> dict[str, Any]:
    # of a grid, a path may be another combination's alone
    there = np.flatnonzero((paths["field_amplitude"] > 0).any("diameter"))
    few = paths.isel(path=there[:MOST_PATHS], diameter=chosen)
    columns = ("share", "field_amplitude", "mean_optical_path_length")
    return {"names": [str(one) for one in few["path"].values]} | {
        name: packed(few[name].transpose("path", "diameter")) for name in columns
    }


def _traces(found: xr.Dataset) -> list[dict[str, Any]]:
    """Return a lab's own traces: of the diameter, or of each quantity that was fitted."""
    if "quantity" not in found.dims:
        return [_trace(found, "change of the diameter", "nm")]
    kinds = ("statistical_error", "systematic_error")
    traces = []
    for number in range(found.sizes["quantity"]):
        one = found.isel(quantity=number)
        errors = {kind: one[f"change_{kind}"] for kind in kinds}
        name = str(one["quantity"].item()).replace("_", " ")
        unit = str(one["quantity_unit"].item()).replace("1e-3", "10⁻³")
        single = one.assign({"expansion": one["change"], **errors})
        traces.append(_trace(single, f"change of the {name}", unit))
    return traces


def _trace(found: xr.Dataset, name: str, unit: str) -> dict[str, Any]:
    """Return one trace over time: of a long one what can be seen of it."""
    time, change = TIME_UNIT * found["time"].values, found["expansion"].values
    error = standard_error(found)
    at = extremes(time, change)
    edge, low, high = band(time, change - error, change + error)
    return {
        "name": name, "unit": unit, "every": bool(at.size == time.size), "of": int(time.size),
        "time": packed(time[at], double=True), "change": packed(change[at], double=True),
        "error": packed(error[at]), "edge": packed(edge, double=True), "low": packed(low),
        "high": packed(high),
    }  # fmt: skip


def _finite(value: float) -> float | None:
    return value if np.isfinite(value) else None
