"""The calibration: how far the phase moves when the neuron alone does (`snakemake calibration`)."""

from collections.abc import Sequence
from typing import Any

import numpy as np
import xarray as xr
from scipy.interpolate import CubicSpline

from octsim.base.threads import each
from octsim.config.derive import by_accuracy, by_rays
from octsim.config.models import Config
from octsim.config.processing import Processing
from octsim.datasets.files import flags, make
from octsim.instrument.points import Points
from octsim.optics.two_beams import predicted_phase_slope
from octsim.phase.derivatives import Array
from octsim.schemes.light import AccuracyStatus
from octsim.stages.focus_law import focus_line
from octsim.studies.calibration.slopes import bench_of, slopes_at
from octsim.studies.calibration.tolerances import INDICES, PARAMETERS

ACCURACY = 1e-8
"""Of the spectra: 1e-6 moves slopes over 0.1 nm by up to 2e-4 mrad/nm, this by less than 1e-5."""
RAYS = 3000
"""The thesis's rays, whose slope over such steps is stored beside, to compare."""


def converged(config: Config) -> Config:
    """Return the config of the same instrument, traced as accurately as small steps need."""
    return by_accuracy(config, ACCURACY)


def calibrating(config: Config) -> Processing:
    """Return the run's processing with the calibration's estimator."""
    return config.processing.model_copy(update={"estimator": config.calibration.estimator})


def by_fft(config: Config) -> Processing:
    """Return the run's processing with the thesis's estimator."""
    return config.processing.model_copy(update={"estimator": "fft"})


def calibration(
    config: Config,
    law: xr.Dataset | None = None,
    threads: int = 1,
    points: Points | None = None,
) -> xr.Dataset:
    """Differentiate the phase over the diameter at a fixed focus and gap, and say how surely.

    An action potential does not move the objective. At each diameter the focus is the law's, and
    is held while the diameter moves by ``calibration.step`` to each side; so are the gap and the
    estimator's settings. Spectra are of the scheme paths, whatever the run's own, at `ACCURACY`.

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
        Over the diameter: fixed_focus_phase_slope with its systematic standard error, its inverse
        diameter_per_phase and phase_curvature; the slope whose focus follows, the thesis's Fourier
        transform's and those of each side's light by itself, beside; sensitivities to each
        parameter and what its tolerance makes of it, budget(diameter, parameter), with the error of
        the finite differences.

    Raises
    ------
    OctsimError
        If the law is needed and could not be fitted, or a diameter has no fringe.
    """
    exact, line = converged(config), focus_line(config, law)
    diameters = config.calibration.diameters.values()
    foci = line.at(diameters)
    processing = calibrating(config), by_fft(config)
    bench = bench_of(exact, by_rays(exact, RAYS), processing, line.slope, points)
    places = zip(diameters.tolist(), foci.tolist(), strict=True)
    rows = list(each(lambda place: slopes_at(bench, *place), places, threads))
    return make(
        "calibration",
        config,
        "Change of the phase with the diameter, at a fixed focus and gap",
        _variables(config, diameters, rows) | {"focus": ("diameter", foci), "slope": line.slope},
        {"diameter": diameters, "parameter": list(PARAMETERS)},
    )


def interpolation_error(diameter: Array, slope: Array) -> Array:
    """Return how far a cubic spline through every second point misses the others, shape (D,).

    At a point of that half it is the larger of its neighbours'. The spline through all points is
    nearer than this, about 16 times.
    """
    missed = np.zeros_like(slope)
    half = CubicSpline(diameter[::2], slope[::2])
    inner = diameter[1::2] <= diameter[::2][-1]
    missed[1::2] = np.where(inner, np.abs(half(diameter[1::2]) - slope[1::2]), 0.0)
    around = np.pad(missed, 1)
    return np.maximum(missed, np.maximum(around[:-2], around[2:]))


def _variables(config: Config, diameters: Array, rows: Sequence[dict[str, Any]]) -> dict[str, Any]:
    """Return the variables of what is known at each diameter, with the budget of the errors."""
    column = {name: np.array([row[name] for row in rows]) for name in rows[0]}
    sensitivity, sensitivity_error = column.pop("sensitivity"), column.pop("sensitivity_error")
    status = flags(AccuracyStatus, column.pop("accuracy_status"))
    tolerances = config.calibration.tolerances
    tolerance = np.array([getattr(tolerances, name) for name in PARAMETERS])
    slope = column["fixed_focus_phase_slope"]
    missed = interpolation_error(diameters, slope)
    budget = np.abs(sensitivity) * tolerance
    error = np.sqrt((budget**2).sum(axis=1) + missed**2 + column["difference_error"] ** 2)
    k = config.spectrum.wavenumbers()
    return {
        **{name: ("diameter", values) for name, values in column.items()},
        "accuracy_status": ("diameter", *status),
        "fixed_focus_phase_slope_standard_error": ("diameter", error),
        "diameter_per_phase": ("diameter", 1 / slope),
        "diameter_per_phase_standard_error": ("diameter", error / slope**2),
        "interpolation_error": ("diameter", missed),
        **{
            # to a length they are per µm
            f"{name}_sensitivity": (
                "diameter",
                sensitivity[:, number] * (1.0 if name in INDICES else 1e-3),
            )
            for number, name in enumerate(PARAMETERS)
        },
        "budget": (("diameter", "parameter"), budget),
        "budget_error": (("diameter", "parameter"), sensitivity_error * tolerance),
        "predicted_phase_slope": predicted_phase_slope(config.scene.swept_index, k[0], k[-1]),
    }


def summary(table: xr.Dataset) -> str:
    """Return what a calibration found, in one line."""
    slope, error = table["fixed_focus_phase_slope"], table["fixed_focus_phase_slope_standard_error"]
    largest = str(table["parameter"].values[int(table["budget"].mean("diameter").values.argmax())])
    return (
        f"phase slope at a fixed focus {float(slope.min()):.3f} to {float(slope.max()):.3f} "
        f"mrad/nm, standard error {float((error / slope).max()):.2%} or less, most of it from "
        f"calibration.tolerances.{largest}"
    )
