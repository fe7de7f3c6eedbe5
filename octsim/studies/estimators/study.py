"""Estimators compared: slopes, noise, a wrong scene (`snakemake estimators`)."""

import time
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import xarray as xr

from octsim.base.threads import each
from octsim.config.derive import by_accuracy, by_rays
from octsim.config.models import Config
from octsim.config.processing import Processing
from octsim.datasets.files import flags, make
from octsim.instrument.instrument import Instrument
from octsim.instrument.points import Points
from octsim.phase.estimators.estimate import Array, middle
from octsim.phase.estimators.likelihood import Model
from octsim.phase.estimators.visible import require_fringe
from octsim.phase.modelled_spectra import MODEL_ACCURACY, model_of_sweep
from octsim.phase.slopes import trend
from octsim.stages.focus_law import sweep_foci
from octsim.studies.estimators.contenders import (
    COMMON,
    CONTENDERS,
    LIKELIHOOD,
    Band,
    EstimateStatus,
    contenders,
    estimate_status,
    sweep_slopes,
)
from octsim.studies.estimators.path_phase import path_slopes
from octsim.studies.estimators.resolution import RATIOS, RUNS
from octsim.studies.estimators.resolution_table import (
    READ_NOISE,
    SEED,
    at_places,
    resolution_variables,
)
from octsim.studies.estimators.wrong_scene import (
    OtherScene,
    likelihood_offset,
    misreading,
    other_scenes,
)

PHASES = tuple(name for name in CONTENDERS if name not in (COMMON, LIKELIHOOD, "fringe"))
"""Those that know a phase of any one spectrum."""


def from_trend(diameter: Array, slope: Array) -> Array:
    """Return slopes (D,) less their trend, a polynomial of the fourth degree; NaN if one is."""
    if not np.isfinite(slope).all():
        return np.full(slope.size, np.nan)
    return slope - trend(diameter, slope)


def estimators(
    config: Config,
    law: xr.Dataset | None = None,
    threads: int = 1,
    runs: int = RUNS,
    points: Points | None = None,
) -> xr.Dataset:
    """Return how the estimators compare on a run's scene.

    Parameters
    ----------
    config : Config
        The run.
    law : Dataset, optional
        Its fitted focus law, where ``sweep.focus`` is ``law``.
    threads : int
        For tracing and for the noisy spectra.
    runs : int
        Noisy spectra of each diameter, noise and ratio.
    points : Points, optional
        Where light that was found before is kept.

    Returns
    -------
    Dataset
        phase_slope and converged_phase_slope (estimator, diameter), of counted rays and of light
        paths; their scatter about a trend, bias and largest spike; resolution(estimator, snr) and
        its bound; and how another scene's spectra are misread. Statuses say where an estimator has
        no such number.

    Raises
    ------
    OctsimError
        If a diameter has no fringe.
    """
    diameter, foci = config.sweep.diameters.values(), sweep_foci(config, law)
    by_paths = Instrument(by_accuracy(config, MODEL_ACCURACY), points)
    counted = Instrument(by_rays(config, config.tracing.rays), points)
    compared = contenders(config)
    band = Band(
        config.swept_group_index, by_paths.wavenumber, config.swept_material, by_paths.power
    )
    scenes = other_scenes(config, foci, threads, points)
    depth = band.n_neuron * diameter
    require_fringe("estimators", scenes[0].intensity, band.wavenumber, depth, source=band.power)
    model = model_of_sweep(config, foci, threads, points)
    true = _true_slopes(by_paths, diameter, foci, threads)
    rough = counted.spectra(diameter, foci, threads)
    estimated = {
        **_slopes(compared, band, diameter, rough, model, ""),
        **_slopes(compared, band, diameter, scenes[0].intensity, model, "converged_"),
    }
    bias = {
        f"{prefix}bias": (
            "estimator",
            (estimated[f"{prefix}phase_slope"][1] - true["path_phase_slope"][1]).mean(axis=1),
        )
        for prefix in ("", "converged_")
    }
    variables: dict[str, Any] = {
        **true,
        **estimated,
        **bias,
        **resolution_variables(config, compared, band, foci, threads, runs, points),
        **_misreadings(compared, band, diameter, model, scenes),
        "seed": SEED,
        "noise_runs": runs,
        "read_noise": READ_NOISE,
    }
    return make(
        "estimators",
        config,
        "Estimators of the phase and of the diameter, compared",
        variables,
        {
            "estimator": list(compared),
            "processing": ("estimator", [p.model_dump_json() for p in compared.values()]),
            "diameter": diameter,
            "snr": np.array(RATIOS),
            "noise_diameter": at_places(diameter),
            "scene": [one.name for one in scenes],
        },
    )


def _true_slopes(
    instrument: Instrument, diameter: Array, foci: Array, threads: int
) -> dict[str, Any]:
    """Return the slopes of the light's own phase, and of its mean path."""
    places = zip(diameter.tolist(), foci.tolist(), strict=True)
    lights = list(each(lambda place: instrument.rays(*place), places, threads))
    phase, mean = path_slopes(lights, diameter, middle(instrument.wavenumber))
    return {"path_phase_slope": ("diameter", phase), "mean_path_slope": ("diameter", mean)}


def _slopes(
    compared: Mapping[str, Processing],
    band: Band,
    diameter: Array,
    intensity: Array,
    model: Model,
    prefix: str,
) -> dict[str, Any]:
    """Return slopes by each estimator of a sweep's spectra (D, K), and how they scatter."""
    slope = np.full((len(compared), diameter.size), np.nan)
    seconds = np.full(len(compared), np.nan)
    for row, (name, processing) in enumerate(compared.items()):
        if name != COMMON:
            start = time.thread_time()
            slope[row] = sweep_slopes(processing, band, diameter, intensity, model)
            seconds[row] = time.thread_time() - start
    residual = np.stack([from_trend(diameter, one) for one in slope])
    spike = np.nan_to_num(np.abs(residual)).argmax(axis=1)
    rows, known = np.arange(len(compared)), np.isfinite(residual).all(axis=1)
    light = "light paths" if prefix else "counted rays"
    meaning = {"long_name": f"phase slope by each estimator, of spectra by {light}"}
    return {
        f"{prefix}phase_slope": (("estimator", "diameter"), slope, meaning),
        f"{prefix}scatter": ("estimator", residual.std(axis=1)),
        f"{prefix}largest_spike": ("estimator", residual[rows, spike]),
        f"{prefix}largest_spike_diameter": ("estimator", np.where(known, diameter[spike], np.nan)),
        f"{prefix}slope_status": (
            ("estimator", "diameter"),
            *flags(EstimateStatus, estimate_status(slope, compared)),
        ),
        "estimator_seconds": ("estimator", seconds),
        "estimator_status": (
            "estimator",
            *flags(EstimateStatus, estimate_status(seconds, compared)),
        ),
    }


def _misreadings(
    compared: Mapping[str, Processing],
    band: Band,
    diameter: Array,
    model: Model,
    scenes: Sequence[OtherScene],
) -> dict[str, Any]:
    """Return how changes of diameter are misread by each estimator in each scene."""
    misread = np.full((2, len(compared), len(scenes)), np.nan)
    for row, (name, processing) in enumerate(compared.items()):
        if name != COMMON:
            for column, scene in enumerate(scenes):
                misread[:, row, column] = misreading(
                    processing, band, diameter, scenes[0].intensity, scene.intensity, model
                )
    offsets = [likelihood_offset(model, diameter, scene.intensity) for scene in scenes]
    return {
        "misreading": (("estimator", "scene"), misread[0]),
        "misreading_scatter": (("estimator", "scene"), misread[1]),
        "misreading_status": (
            ("estimator", "scene"),
            *flags(EstimateStatus, estimate_status(misread[0], compared)),
        ),
        "likelihood_offset": ("scene", np.array(offsets)),
    }


def summary(compared: xr.Dataset) -> str:
    """Return which phase estimator wins, and by how much, in one line."""
    phases = compared.sel(estimator=[n for n in PHASES if n in compared["estimator"]])
    best = phases.isel(estimator=int(phases["converged_scatter"].values.argmin()))
    thesis = compared.sel(estimator="fft")
    series = compared.sel(estimator=COMMON)
    return (
        f"estimators: {best['estimator'].item()} scatters least, by "
        f"{float(best['scatter']):.4f} mrad/nm on counted rays and "
        f"{float(best['converged_scatter']):.4f} on converged spectra (fft "
        f"{float(thesis['scatter']):.3f} and {float(thesis['converged_scatter']):.3f}); under shot "
        f"noise {COMMON} is within {float(series['resolution_over_bound'].max()):.2f} of the "
        f"Cramér–Rao bound (fft {float(thesis['resolution_over_bound'].max()):.2f})"
    )
