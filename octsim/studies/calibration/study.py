"""The calibration: how far the phase moves when the neuron alone does (`snakemake calibration`)."""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
import xarray as xr
from scipy.interpolate import CubicSpline

from octsim.base.threads import each
from octsim.config.derive import by_accuracy, by_rays
from octsim.config.models import Config
from octsim.config.processing import Processing
from octsim.datasets.files import flags, make
from octsim.instrument.instrument import Instrument
from octsim.optics.two_beams import predicted_phase_slope
from octsim.phase.derivatives import FRACTIONS, Array, derivative, stencil, wrapped
from octsim.phase.estimators.series import series_phases
from octsim.schemes.light import AccuracyStatus, Light
from octsim.stages.focus_law import focus_line
from octsim.studies.calibration.tolerances import PARAMETERS, moved, offsets_of
from octsim.studies.sides import side_slopes

ACCURACY = 1e-8
"""Of the spectra: 1e-6 moves slopes over 0.1 nm by up to 2e-4 mrad/nm, this by less than 1e-5."""
RAYS = 3000
"""The thesis's rays, whose slope over such steps is stored beside, to compare."""
_CURVATURE_STEP = 4e-3


class Look(NamedTuple):
    """A spectrum to be made: an instrument, a diameter and a focus, µm."""

    instrument: Instrument
    diameter: float
    focus: float


def converged(config: Config) -> Config:
    """Give the config of the same instrument, traced as accurately as small steps need."""
    return by_accuracy(config, ACCURACY)


def calibrating(config: Config) -> Processing:
    """Give the run's processing with the calibration's estimator."""
    return config.processing.model_copy(update={"estimator": config.calibration.estimator})


def by_fft(config: Config) -> Processing:
    """Give the run's processing with the thesis's estimator."""
    return config.processing.model_copy(update={"estimator": "fft"})


def calibration(config: Config, law: xr.Dataset | None = None, threads: int = 1) -> xr.Dataset:
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
        If the law is needed and could not be fitted.
    """
    settings, exact = config.calibration, converged(config)
    diameters = settings.diameters.values()
    line = focus_line(config, law)
    foci, bench = line.at(diameters), _bench(exact, line.slope)
    points = zip(diameters.tolist(), foci.tolist(), strict=True)
    rows = list(each(lambda at: _measure(config, bench, *at, line.slope), points, threads))
    column = {name: np.array([row[name] for row in rows]) for name in rows[0]}
    return _dataset(config, diameters, column | {"focus": foci, "slope": line.slope})


class _Bench(NamedTuple):
    """The instrument as it is, and as it is when each parameter is moved."""

    trace_at: Callable[[float, float], Light]
    own: Instrument
    rays: Instrument
    offsets: dict[str, Array]
    moved: dict[str, list[tuple[Instrument, float, float]]]


def _bench(exact: Config, law_slope: float) -> _Bench:
    offsets = {name: offsets_of(exact, name) for name in PARAMETERS}
    places = {
        name: [moved(exact, {name: by}, law_slope) for by in changes.tolist()]
        for name, changes in offsets.items()
    }
    return _Bench(
        Instrument(exact).light,
        Instrument(exact),
        Instrument(by_rays(exact, RAYS)),
        offsets,
        {
            name: [(Instrument(place.config), place.diameter, place.focus) for place in listed]
            for name, listed in places.items()
        },
    )


def _measure(
    config: Config, bench: _Bench, diameter: float, focus: float, law_slope: float
) -> dict[str, Any]:
    """Measure what the calibration holds at one diameter."""
    k, step = config.spectrum.wavenumbers(), config.calibration.step
    depth = config.scene.refractive_index.neuron * diameter
    offsets = stencil(diameter, step)
    bends = _CURVATURE_STEP * FRACTIONS
    # two spectra of each pair, a step to each side, give the slope of one instrument
    places = [
        *((bench.own, bend, 0.0) for bend in bends),
        *(place for name in PARAMETERS for place in bench.moved[name]),
    ]
    looks = [
        *(Look(bench.own, diameter + by, focus) for by in offsets),
        *(Look(bench.own, diameter + by, focus + law_slope * by) for by in offsets),
        *(Look(bench.own, diameter, focus + by) for by in offsets),
        *(
            Look(at, diameter + to + by, focus + up)
            for at, to, up in places
            for by in (-step, step)
        ),
        *(Look(bench.rays, diameter + by, focus) for by in (-step, step)),
    ]
    spectra, errors, status = zip(
        *(look.instrument.spectrum(*look[1:]) for look in looks), strict=True
    )
    stack, num = np.stack(spectra), offsets.size

    def phases_of(spectra: Array, processing: Processing, *sizes: int) -> Array:
        # what an estimator takes from the whole of a series is that of one instrument's
        series = np.split(spectra, np.cumsum(sizes)[:-1])
        return np.concatenate([series_phases(one, k, depth, processing) for one in series])

    sizes = num, num, num, *(2 for _ in range((len(stack) - 3 * num) // 2))
    phases = phases_of(stack, calibrating(config), *sizes)
    of_fft = phases_of(stack[: 2 * num], by_fft(config), num, num)
    fixed, following, focused = (
        derivative(offsets, wrapped(part - part[num // 2]))
        for part in np.split(phases[: 3 * num], 3)
    )
    fft_fixed, fft_following = (
        derivative(offsets, wrapped(part - part[num // 2])).value for part in np.split(of_fft, 2)
    )
    pairs = phases[3 * num :].reshape(-1, 2)
    slopes = wrapped(pairs[:, 1] - pairs[:, 0]) / (2 * step)
    moved_slopes = slopes[num:-1].reshape(len(PARAMETERS), num)
    found = {
        name: derivative(bench.offsets[name], of_one)
        for name, of_one in zip(PARAMETERS, moved_slopes, strict=True)
    }
    sides = side_slopes(bench.trace_at, diameter, focus, float((k[0] + k[-1]) / 2), step)
    return {
        **{f"{side}_side_phase_slope": slope for side, slope in sides.items()},
        "fixed_focus_phase_slope": fixed.value,
        "difference_error": fixed.error,
        "following_phase_slope": following.value,
        "focus_phase_slope": focused.value,
        "fft_fixed_focus_phase_slope": fft_fixed,
        "fft_following_phase_slope": fft_following,
        "rays_phase_slope": slopes[-1],
        "phase_curvature": derivative(bends, slopes[:num]).value / 1e3,  # per nm
        "sensitivity": np.array([one.value for one in found.values()]),
        "sensitivity_error": np.array([one.error for one in found.values()]),
        "intensity_error": max(errors[:-2]),
        "accuracy_status": max(status[:-2]),
    }


def interpolation_error(diameter: Array, slope: Array) -> Array:
    """Give how far a cubic spline through every second point misses the others, shape (D,).

    At a point of that half it is the larger of its neighbours'. The spline through all points is
    nearer than this, about 16 times.
    """
    missed = np.zeros_like(slope)
    half = CubicSpline(diameter[::2], slope[::2])
    inner = diameter[1::2] <= diameter[::2][-1]
    missed[1::2] = np.where(inner, np.abs(half(diameter[1::2]) - slope[1::2]), 0.0)
    around = np.pad(missed, 1)
    return np.maximum(missed, np.maximum(around[:-2], around[2:]))


def _dataset(config: Config, diameters: Array, column: dict[str, Any]) -> xr.Dataset:
    tolerances = config.calibration.tolerances
    tolerance = np.array([getattr(tolerances, name) for name in PARAMETERS])
    slope = column["fixed_focus_phase_slope"]
    sensitivity, off = column.pop("sensitivity"), column.pop("sensitivity_error")
    missed = interpolation_error(diameters, slope)
    budget = np.abs(sensitivity) * tolerance
    error = np.sqrt((budget**2).sum(axis=1) + missed**2 + column["difference_error"] ** 2)
    k = config.spectrum.wavenumbers()
    status = ("diameter", *flags(AccuracyStatus, column.pop("accuracy_status")))
    law_slope = column.pop("slope")
    variables: dict[str, Any] = {
        **{name: ("diameter", values) for name, values in column.items()},
        "accuracy_status": status,
        "slope": law_slope,
        "fixed_focus_phase_slope_standard_error": ("diameter", error),
        "diameter_per_phase": ("diameter", 1 / slope),
        "diameter_per_phase_standard_error": ("diameter", error / slope**2),
        "interpolation_error": ("diameter", missed),
        **{
            f"{name}_sensitivity": ("diameter", sensitivity[:, number] * _per(name))
            for number, name in enumerate(PARAMETERS)
        },
        "budget": (("diameter", "parameter"), budget),
        "budget_error": (("diameter", "parameter"), off * tolerance),
        "predicted_phase_slope": predicted_phase_slope(
            config.scene.refractive_index.neuron, k[0], k[-1]
        ),
    }
    return make(
        "calibration",
        config,
        "Change of the phase with the diameter, at a fixed focus and gap",
        variables,
        {"diameter": diameters, "parameter": list(PARAMETERS)},
    )


INDICES = ("glass", "water", "neuron", "numerical_aperture")
"""Parameters without a unit; the others are lengths."""


def _per(name: str) -> float:
    """Give what turns a sensitivity to a length from per µm into per nm."""
    return 1.0 if name in INDICES else 1e-3


def summary(table: xr.Dataset) -> str:
    """Say in one line what a calibration found."""
    slope, error = table["fixed_focus_phase_slope"], table["fixed_focus_phase_slope_standard_error"]
    largest = str(table["parameter"].values[int(table["budget"].mean("diameter").values.argmax())])
    return (
        f"phase slope at a fixed focus {float(slope.min()):.3f} to {float(slope.max()):.3f} "
        f"mrad/nm, standard error {float((error / slope).max()):.2%} or less, most of it from "
        f"calibration.tolerances.{largest}"
    )
