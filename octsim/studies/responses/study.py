"""Expansion by what? Phases and spectra as a neuron's diameter, gap, index and shells change."""

from collections.abc import Sequence
from typing import Any

import numpy as np
import xarray as xr

from octsim.base.threads import each
from octsim.config.models import Config
from octsim.datasets.files import flags, make
from octsim.instrument.points import Points
from octsim.phase.derivatives import Array
from octsim.schemes.light import AccuracyStatus
from octsim.stages.focus_law import focus_line
from octsim.studies.calibration.parameters import parameters_of
from octsim.studies.calibration.scheme import ModelStatus, converged, rays_because, require_budget
from octsim.studies.responses.at_diameter import Bench, responses_at, shifts_at
from octsim.studies.responses.missing import response_statuses
from octsim.studies.responses.observables import bands_of, observables_of
from octsim.studies.responses.quantities import CONFIGURED, quantities_of, variants_of
from octsim.studies.responses.separability import Separability
from octsim.studies.responses.sources import SOURCES, by_source


def diameters_of(config: Config) -> Array:
    """Return the diameters that responses are of, (D,), µm: those asked for, and expansion's."""
    given, own = config.responses.diameters.values(), config.expansion.diameter
    if np.isclose(given, own, rtol=0, atol=1e-9).any():
        return given
    return np.sort(np.append(given, own))


def responses(
    config: Config,
    law: xr.Dataset | None = None,
    threads: int = 1,
    points: Points | None = None,
) -> xr.Dataset:
    """Differentiate phases and spectra by each thing that an action potential may change.

    As for a calibration the focus is the law's at each diameter and held, and spectra are by
    ``calibration.scheme``.

    Parameters
    ----------
    config : Config
    law : Dataset, optional
        The fitted law; needed only where ``sweep.focus`` is ``law``.
    threads : int
        How many diameters are at work at a time.
    points : Points, optional
        Where light that was found before is kept.

    Returns
    -------
    Dataset
        Over variant (the scene as it is, and with a membrane), diameter and quantity: the phase
        response of each observable, the apparent expansion, the response of the spectrum; what
        standard errors shot noise leaves to each quantity alone, with another and with all others,
        by the spectrum and by phases, with a status; a trial on noisy spectra; and statuses, which
        say why a number is missing.

    Raises
    ------
    OctsimError
        If the law is needed and could not be fitted, the scheme that is given can't do the scene, a
        band has too few samples, or it takes longer than ``budget.cpu_hours``.
    """
    own, line = converged(config), focus_line(config, law)
    diameters = diameters_of(config)
    # of each quantity five spectra, of each parameter four, and of a scene with a membrane
    spectra = (len(quantities_of(own)) + 1) * (4 * len(parameters_of(own)) + 10)
    require_budget(own, "responses", "responses by scheme {} take", spectra, diameters)
    variants = variants_of(own)
    benches = {
        name: Bench(one, quantities_of(one), line.slope, points) for name, one in variants.items()
    }
    places = list(zip(diameters.tolist(), line.at(diameters).tolist(), strict=True))
    tasks = [(bench, *place) for bench in benches.values() for place in places]
    rows = list(each(lambda task: responses_at(*task), tasks, threads))
    believed = benches[CONFIGURED]
    shifts = list(each(lambda place: shifts_at(believed, *place), places, threads))
    quantities = max((bench.quantities for bench in benches.values()), key=len)
    names = [one.name for one in quantities]
    kept = [rows[len(places) * at : len(places) * (at + 1)] for at in range(len(benches))]
    observables = observables_of(config)
    k = config.spectrum.wavenumbers()
    return make(
        "responses",
        config,
        "Change of phases and spectra with what may change in a neuron",
        _variables(own, kept, names, shifts)
        | {
            "focus": ("diameter", line.at(diameters)),
            "quantity_unit": ("quantity", [one.unit for one in quantities]),
            "band_min": ("band", np.array([band[0] for band in bands_of(config)])),
            "band_max": ("band", np.array([band[1] for band in bands_of(config)])),
            "photons": config.action_potential.photons,
        },
        {
            "variant": list(benches), "diameter": diameters, "observable": observables,
            "quantity": names, "wavenumber": k, "source": list(SOURCES),
            "parameter": list(parameters_of(own)),
        },
    )  # fmt: skip


def _filled(rows: Sequence[Array], axes: tuple[int, ...], quantities: int) -> Array:
    """Stack arrays (V, D), NaN for the quantities that a variant does not have, along some axes."""
    found = []
    for one in rows:
        missing = [
            (0, quantities - one.shape[axis] if axis in axes else 0) for axis in range(one.ndim)
        ]
        found.append(np.pad(one, missing, constant_values=np.nan))
    return np.stack(found)


def _variables(
    own: Config, kept: list[list[dict[str, Any]]], names: list[str], shifts: list[Array]
) -> dict[str, Any]:
    column = {name: [np.array([row[name] for row in rows]) for rows in kept] for name in kept[0][0]}
    place, watched = ("variant", "diameter"), ("variant", "diameter", "observable")
    many = len(names)
    response = _filled(column["phase_response"], (2,), many)
    # NaN without a membrane: what is not known of the instrument is of the scene as it is
    shift = _filled([np.array(shifts)], (4,), many)[0]
    difference = _filled(column["phase_response_difference_error"], (2,), many)
    by_rays = bool(rays_because(own))
    error = np.full_like(response, np.nan)
    error[0] = np.sqrt((shift**2).sum(axis=(1, 2)) + difference[0] ** 2)
    if by_rays:
        error[0] = np.nan  # as far as rays are from Maxwell's equations is not in it
    shape = _filled(column["intensity_response"], (1,), many)
    intensity = np.stack(column["intensity"])
    noise = np.stack(column["phase_noise_covariance"])
    told = by_source(own, intensity, shape, response, noise)
    status = np.full(1, ModelStatus.NOT_COMPARED if by_rays else ModelStatus.BY_MAXWELL)[0]
    quantity, other = ("quantity",), ("quantity", "other_quantity")
    statuses = response_statuses(shape, response.shape[2], told.correlation, by_rays=by_rays)
    return {
        "phase_response": ((*watched, "quantity"), response),
        "phase_response_standard_error": ((*watched, "quantity"), error),
        "phase_response_difference_error": ((*watched, "quantity"), difference),
        "phase_response_shift": (
            ("diameter", "parameter", "side", "observable", "quantity"), shift
        ),
        "phase_noise_covariance": ((*watched, "other_observable"), noise),
        "apparent_expansion": ((*watched, "quantity"), response / response[..., :1]),
        "depth": (watched, np.stack(column["depth"])),
        "intensity": ((*place, "wavenumber"), intensity),
        "intensity_response": ((*place, "quantity", "wavenumber"), shape),
        "intensity_response_error": (
            (*place, *quantity), _filled(column["intensity_response_error"], (1,), many)
        ),
        "apparent_expansion_of_shape": ((*place, *quantity), told.apparent),
        "error_alone": (("source", *place, *quantity), told.alone),
        "error_with_other": (("source", *place, *other), told.pair),
        "error_together": (("source", *place, *quantity), told.together),
        "error_correlation": (("source", *place, *other), told.correlation),
        "separability": (
            ("source", *place, *quantity), *flags(Separability, told.status.astype(int))
        ),
        "separability_with_other": (
            ("source", *place, *other), *flags(Separability, told.pair_status.astype(int))
        ),
        "trial_bias": ((*place, *quantity), _filled(column["trial_bias"], (1,), many)),
        "trial_coverage": ((*place, *quantity), _filled(column["trial_coverage"], (1,), many)),
        "intensity_error": (place, np.stack(column["intensity_error"])),
        "accuracy_status": (
            place, *flags(AccuracyStatus, np.stack(column["accuracy_status"]))
        ),
        "model_status": ((), *flags(ModelStatus, np.array(status))),
        **statuses,
    }  # fmt: skip
