"""The search for the instrument that knows an expansion best (`snakemake design`)."""

from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np
import xarray as xr

from octsim.base.threads import each
from octsim.config.models import Config
from octsim.config.source import source_of
from octsim.datasets.files import flags, make
from octsim.phase.fringe_status import FringeStatus
from octsim.schemes.light import AccuracyStatus
from octsim.stages.focus_law import focus_line
from octsim.studies.design.cell import bench_of, cell
from octsim.studies.design.criteria import CRITERIA, CriterionStatus, peaks
from octsim.studies.design.settings import (
    ACCURACY,
    PARAMETERS,
    Band,
    apertures_of,
    bands_of,
    waves,
)
from octsim.studies.design.uncertainty import DRAWS, ESTIMATORS, SEED, Known, Neuron, known

_PLACES = ("aperture", "diameter", "focus_offset", "fill", "band")
"""Dimensions in the order in which they are gone through: a scene is solved once for all fills."""


class Column(NamedTuple):
    """What is solved by one thread: one diameter by one aperture, at all foci."""

    aperture: float
    diameter: float
    number: int
    """Of the diameter."""


class Found(NamedTuple):
    """What one setting gives."""

    known: Known
    error: float
    status: AccuracyStatus


def design(config: Config, law: xr.Dataset | None = None, threads: int = 1) -> xr.Dataset:
    """Search fill, focus, aperture, band and estimator for the least error of an expansion.

    Spectra are Maxwell's, whatever the run's scheme. The statistical error is that of one spectrum
    by its photons; the systematic one that of the slope, by what ``calibration.tolerances``
    leaves unknown, times the expansion.

    Parameters
    ----------
    config : Config
    law : Dataset, optional
        The fitted law; needed only where ``sweep.focus`` is ``law``.
    threads : int
        How many diameters, by one aperture each, are at work at a time.

    Returns
    -------
    Dataset
        Over estimator, aperture, band, fill, focus_offset and diameter: phase_slope,
        statistical_error, systematic_error and total_error; rms_error, over the diameters;
        slope_error of each parameter; of each setting the Cramér–Rao bound, brightness and fringe;
        and of each criterion where it finds the focus, and what is known there, or why it does
        not.

    Raises
    ------
    OctsimError
        If the law is needed and could not be fitted, or an aperture is not below the water's index.
    """
    settings, bands, apertures = config.design, bands_of(config), apertures_of(config)
    diameters, offsets = settings.diameters.values(), settings.focus_offsets.values()
    line = focus_line(config, law)

    def column(at: Column) -> list[Found]:
        rest = line.at(at.diameter)
        return list(_column(config, bands, at, (rest + offsets).tolist()))

    columns = [
        Column(aperture, diameter, number)
        for aperture in apertures
        for number, diameter in enumerate(diameters.tolist())
    ]
    found = [one for part in each(column, columns, threads) for one in part]
    coordinates: dict[str, Any] = {
        "aperture": apertures, "diameter": diameters, "focus_offset": offsets,
        "fill": list(settings.fills), "band": [band.name for band in bands],
        "estimator": list(ESTIMATORS), "parameter": list(PARAMETERS),
    }  # fmt: skip
    shape = [len(coordinates[name]) for name in _PLACES]
    table = _table(found, shape, settings.expansion, coordinates)
    codes = {
        "fringe_status": FringeStatus, "accuracy_status": AccuracyStatus,
        "criterion_status": CriterionStatus, "criterion_error_status": CriterionStatus,
    }  # fmt: skip
    named = {name: (table[name].dims, *flags(of, table[name].values)) for name, of in codes.items()}
    return make(
        "design", config, "How well an expansion is known, by each instrument and estimator",
        {str(name): (one.dims, one.values) for name, one in table.data_vars.items()}
        | named | {"focus": ("diameter", line.at(diameters)), "seed": SEED, "draws": DRAWS},
        coordinates | {"criterion": list(CRITERIA)},
    )  # fmt: skip


def best(table: xr.Dataset) -> dict[str, Any]:
    """Return the setting of the least rms_error, as a selection; empty where there is none.

    Parameters
    ----------
    table : Dataset
        design.nc, or a part of it.
    """
    error = table["rms_error"]
    if bool(error.isnull().all()):
        return {}
    places = {str(name): int(at) for name, at in error.argmin(error.dims).items()}
    return {name: error[name].values[at] for name, at in places.items()}


def summary(table: xr.Dataset) -> str:
    """Return what the search found, in one line."""
    at = best(table)
    if not at:
        return "no setting has a fringe at every diameter; give design.diameters or bands otherwise"
    chosen = table.sel(at)
    return (
        f"least error of an expansion {float(chosen['rms_error']):.3g} nm, by a fill of "
        f"{at['fill']:g}, the focus {1e3 * at['focus_offset']:+.0f} nm from the law, NA "
        f"{at['aperture']:g}, {at['band']}, {at['estimator']}; the photons' bound is "
        f"{float(np.sqrt((chosen['least_error'] ** 2).mean())):.3g} nm"
    )


def doubts(table: xr.Dataset) -> Iterator[str]:
    """Say, a line each, where spectra are not as accurate as asked, or the best is at an end."""
    missed = int((table["accuracy_status"] != AccuracyStatus.REACHED).sum())
    if missed:
        yield (
            f"design: {missed} of {table['accuracy_status'].size} settings are not as accurate as "
            f"{ACCURACY:g}, the worst {float(table['intensity_error'].max()):.1e}; give "
            "design.diameters or focus_offsets a smaller range"
        )
    at, offsets = best(table), table["focus_offset"].values
    if at and at["focus_offset"] in offsets[[0, -1]]:
        yield (
            f"design: the best focus is at the end of design.focus_offsets, "
            f"{1e3 * at['focus_offset']:+.0f} nm; give it a wider range"
        )


def _column(config: Config, bands: list[Band], at: Column, foci: list[float]) -> Iterator[Found]:
    """Return what each focus, fill and band gives, in this order."""
    bench, settings = bench_of(config, at.aperture), config.design
    solved, tolerance = waves(config, at.aperture), config.calibration.tolerances.diameter
    index, material = solved.swept_group_index, solved.swept_material
    source = source_of(config.spectrum.source)
    for focus in foci:
        for of_fill in cell(config, bench, bands, at.diameter, focus):
            for band, seen in zip(bands, of_fill, strict=True):
                neuron = Neuron(
                    at.diameter, index, band.wavenumber, seen.around, material,
                    None if source is None else source.power(band.wavenumber),
                )  # fmt: skip
                seed = SEED, at.number
                yield Found(
                    known(seen, neuron, settings.photons, tolerance, seed), seen.error, seen.status
                )


def _table(
    found: list[Found], shape: list[int], expansion: float, coordinates: dict[str, Any]
) -> xr.Dataset:
    def over(values: Any, *further: str) -> xr.DataArray:
        array = np.asarray(values)
        return xr.DataArray(array.reshape(*shape, *array.shape[1:]), dims=(*_PLACES, *further))

    def root(values: xr.DataArray) -> xr.DataArray:
        return values.copy(data=np.sqrt(values.values))

    knowns = [one.known for one in found]
    relative = over([one.relative for one in knowns], "estimator", "parameter")
    statistical = over([one.statistical for one in knowns], "estimator")
    systematic = 1e3 * expansion * root(relative.dot(relative, "parameter"))
    squared = statistical**2 + systematic**2
    seen = xr.Dataset(
        {
            "phase_slope": over([one.slope for one in knowns], "estimator"),
            "statistical_error": statistical,
            "systematic_error": systematic,
            "total_error": root(squared),
            "rms_error": root(squared.mean("diameter", skipna=False)),
            "slope_error": relative,
            "least_error": over([one.bound for one in knowns]),
            "brightness": over([one.brightness for one in knowns]),
            "fringe_visibility": over([one.fringe.visibility[0] for one in knowns]),
            "depth_peak": over([one.depth_peak for one in knowns]),
            "fringe_status": over([one.fringe.status[0] for one in knowns]),
            "intensity_error": over([one.error for one in found]),
            "accuracy_status": over([one.status for one in found]),
        },
        coordinates,
    )
    return seen.assign(peaks(seen))
