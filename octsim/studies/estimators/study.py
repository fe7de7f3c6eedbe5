"""Estimators compared: slopes, noise, a wrong scene (`snakemake estimators`)."""

import time
from typing import Any

import numpy as np
import xarray as xr

from octsim.base.threads import each
from octsim.config.derive import by_accuracy, by_rays
from octsim.config.models import Config
from octsim.config.processing import Processing
from octsim.datasets.files import make
from octsim.instrument.instrument import Instrument
from octsim.phase.estimators.estimate import Array, middle
from octsim.phase.estimators.likelihood import Model
from octsim.phase.modelled_spectra import MODEL_ACCURACY, model_of_sweep
from octsim.phase.slopes import trend
from octsim.stages.focus_law import sweep_foci
from octsim.studies.estimators.contenders import (
    COMMON,
    CONTENDERS,
    LIKELIHOOD,
    Band,
    contenders,
    slopes,
)
from octsim.studies.estimators.path_phase import path_slopes
from octsim.studies.estimators.resolution import (
    RATIOS,
    RUNS,
    Point,
    Resolution,
    point_of,
    resolution,
)
from octsim.studies.estimators.wrong_scene import Other, likelihood_offset, misreading, others

SEED = 20231115
"""Of all draws; each diameter, noise and ratio has its own stream."""
READ_NOISE = 5.0
"""Standard deviation of a dark sample, in photons, where there is read noise."""
PLACES = np.array([0.1, 0.3, 0.5, 0.7, 0.9])
"""Diameters whose resolution is looked for, as fractions of the sweep."""
PHASES = tuple(name for name in CONTENDERS if name not in (COMMON, LIKELIHOOD, "fringe"))
"""Those that know a phase of any one spectrum."""
_NOISES = {"resolution": 0.0, "read_noise_resolution": READ_NOISE}


def from_trend(diameter: Array, slope: Array) -> Array:
    """Give slopes (D,) less their trend, a polynomial of the fourth degree; NaN if one is."""
    if not np.isfinite(slope).all():
        return np.full(slope.size, np.nan)
    return slope - trend(diameter, slope)


def estimators(
    config: Config, law: xr.Dataset | None = None, threads: int = 1, runs: int = RUNS
) -> xr.Dataset:
    """Compare the estimators on a run's scene.

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

    Returns
    -------
    Dataset
        phase_slope and converged_phase_slope (estimator, diameter), of counted rays and of light
        paths; their scatter about a trend, bias and largest spike; resolution(estimator, snr) and
        its bound; and how another scene's spectra are misread.
    """
    diameter, foci = config.sweep.diameters.values(), sweep_foci(config, law)
    k, compared = config.spectrum.wavenumbers(), contenders(config)
    band = Band(config.scene.refractive_index.neuron, k)
    scenes = others(config, foci, threads)
    model = model_of_sweep(config, foci, threads)
    true = _true_slopes(config, diameter, foci, threads)
    counted = _counted(config, diameter, foci, threads)
    found = {
        **_slopes(compared, band, diameter, counted, model, ""),
        **_slopes(compared, band, diameter, scenes[0].intensity, model, "converged_"),
    }
    bias = {
        f"{prefix}bias": (
            "estimator",
            (found[f"{prefix}phase_slope"][1] - true["path_phase_slope"][1]).mean(axis=1),
        )
        for prefix in ("", "converged_")
    }
    variables: dict[str, Any] = {
        **true,
        **found,
        **bias,
        **_noise(config, compared, band, foci, threads, runs),
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
            "noise_diameter": _at_places(diameter),
            "scene": [one.name for one in scenes],
        },
    )


def _true_slopes(config: Config, diameter: Array, foci: Array, threads: int) -> dict[str, Any]:
    trace_at = Instrument(by_accuracy(config, MODEL_ACCURACY)).light
    points = zip(diameter.tolist(), foci.tolist(), strict=True)
    lights = list(each(lambda point: trace_at(*point), points, threads))
    phase, mean = path_slopes(lights, diameter, middle(config.spectrum.wavenumbers()))
    return {"path_phase_slope": ("diameter", phase), "mean_path_slope": ("diameter", mean)}


def _counted(config: Config, diameter: Array, foci: Array, threads: int) -> Array:
    """Trace the sweep by counted rays, as many as the run's, to spectra (D, K)."""
    counted = by_rays(config, config.tracing.rays)
    look = Instrument(counted).spectrum
    points = zip(diameter.tolist(), foci.tolist(), strict=True)
    return np.stack(list(each(lambda point: look(*point)[0], points, threads)))


def _slopes(
    compared: dict[str, Processing],
    band: Band,
    diameter: Array,
    intensity: Array,
    model: Model,
    prefix: str,
) -> dict[str, Any]:
    """Give slopes by each estimator of a sweep's spectra (D, K), and how they scatter."""
    slope = np.full((len(compared), diameter.size), np.nan)
    seconds = np.full(len(compared), np.nan)
    for row, (name, processing) in enumerate(compared.items()):
        if name != COMMON:
            start = time.thread_time()
            slope[row] = slopes(processing, band, diameter, intensity, model)
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
        f"{prefix}largest_spike_diameter": (
            "estimator",
            np.where(known, diameter[spike], np.nan),
        ),
        "estimator_seconds": ("estimator", seconds),
    }


def _at_places(swept: Array) -> Array:
    """Give a swept quantity (D,) where the resolution is looked for, (P,)."""
    found: Array = np.interp(PLACES * (swept.size - 1), np.arange(swept.size), swept)
    return found


def _noise(
    config: Config,
    compared: dict[str, Processing],
    band: Band,
    foci: Array,
    threads: int,
    runs: int,
) -> dict[str, Any]:
    """Give the resolution of each estimator, the bound and the photons, over the ratios."""
    at = list(
        zip(_at_places(config.sweep.diameters.values()).tolist(), _at_places(foci), strict=True)
    )
    points = list(each(lambda one: point_of(config, one[0], float(one[1])), at, threads))
    found: dict[str, Any] = {}
    for number, (name, read_noise) in enumerate(_NOISES.items()):
        tasks = [
            (point, ratio, (SEED, number, p, r))
            for p, point in enumerate(points)
            for r, ratio in enumerate(RATIOS)
        ]

        def measure(task: tuple[Point, float, tuple[int, ...]], sigma: float = read_noise) -> Any:
            point, ratio, seed = task
            return resolution(point, band, compared, ratio, sigma, seed, runs)

        found |= _table(name, list(each(measure, tasks, threads)), list(compared))
    return found


def _table(name: str, measured: list[Resolution], compared: list[str]) -> dict[str, Any]:
    """Arrange resolutions, diameter after diameter, ratio after ratio."""
    shape = (len(PLACES), len(RATIOS))
    bound = np.array([one.bound for one in measured]).reshape(shape)
    photons = np.array([one.photons for one in measured]).reshape(shape)
    of_each = np.array(
        [[one.of_each[estimator] for one in measured] for estimator in compared]
    ).reshape(-1, *shape)
    over, prefix = of_each / bound, name.removesuffix("resolution")
    return {
        # over the diameters, as noise of each has as much to say
        name: (("estimator", "snr"), np.sqrt(np.mean(of_each**2, axis=1))),
        f"{prefix}bound": ("snr", np.sqrt(np.mean(bound**2, axis=0))),
        f"{prefix}photons": ("snr", photons.mean(axis=0)),
        f"{name}_over_bound": (("estimator", "noise_diameter", "snr"), over),
    }


def _misreadings(
    compared: dict[str, Processing],
    band: Band,
    diameter: Array,
    model: Model,
    scenes: list[Other],
) -> dict[str, Any]:
    """Give how changes of diameter are misread by each estimator in each scene."""
    found = np.full((2, len(compared), len(scenes)), np.nan)
    for row, (name, processing) in enumerate(compared.items()):
        if name != COMMON:
            for column, scene in enumerate(scenes):
                found[:, row, column] = misreading(
                    processing, band, diameter, scenes[0].intensity, scene.intensity, model
                )
    offsets = [likelihood_offset(model, diameter, scene.intensity) for scene in scenes]
    return {
        "misreading": (("estimator", "scene"), found[0]),
        "misreading_scatter": (("estimator", "scene"), found[1]),
        "likelihood_offset": ("scene", np.array(offsets)),
    }


def summary(compared: xr.Dataset) -> str:
    """Say in one line which phase estimator wins, and by how much."""
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
