"""What the detector's falloff and radius do (`snakemake detector`)."""

from collections.abc import Sequence
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from octsim.base.threads import each
from octsim.config.maxwell import beyond_maxwell, by_maxwell
from octsim.config.models import Config
from octsim.datasets.files import flags, flags_of_missing, make
from octsim.instrument.points import Points
from octsim.optics.two_beams import predicted_phase_slope
from octsim.phase.fringe_status import FringeStatus
from octsim.schemes.light import AccuracyStatus
from octsim.stages.by_maxwell import ExactStatus
from octsim.stages.focus_law import focus_line
from octsim.stages.phase_slope import SlopeStatus, slope_status
from octsim.studies.detector.cases import FALLOFFS, Case, JumpStatus, LimitStatus, cases, radii_of
from octsim.studies.detector.over_diameter import (
    jumps,
    mean_of_known,
    over_diameter,
    root_mean_square,
)
from octsim.studies.detector.recommended import recommendation
from octsim.studies.detector.seen import SCHEMES, Bench, Seen

Array = NDArray[np.float64]
MOST = 151
"""Diameters at most; of a sweep of more, as many over its range."""
_DETECTORS = ("falloff", "detector_radius")


def detector(
    config: Config,
    law: xr.Dataset | None = None,
    threads: int = 1,
    points: Points | None = None,
    number: int = MOST,
) -> xr.Dataset:
    """Compare detectors of each falloff and radius on the sweep of a run.

    Rays are the run's number, whatever its scheme; what they come to as they become more is by
    light paths, where those can do the falloff. The focus is the run's for all of them, and so it
    is by Maxwell's equations, whose detector is the mode of the pupil. Phases are by a
    least-squares sinusoid at the nominal depth.

    Parameters
    ----------
    config : Config
    law : Dataset, optional
        The fitted law; needed only where ``sweep.focus`` is ``law``.
    threads : int
        How many diameters are at work at a time.
    points : Points, optional
        Where light that was found before is kept.
    number : int
        How many diameters at most.

    Returns
    -------
    Dataset
        Over falloff and detector_radius: ray_noise, phase_jump, edge_phase_jump, edge_rays and
        more of counted rays; of each ray_scheme line_slope, slope_scatter, signal, and
        slope_difference, slope_bias and shape_difference from Maxwell's equations;
        ray_phase_slope and edge_jump at each diameter; and statuses, which say why one of them is
        missing. What it comes to is the attribute recommendation.

    Raises
    ------
    OctsimError
        If the law is needed and could not be fitted, or rays differ from wavelength to wavelength.
    """
    every, line = cases(config), focus_line(config, law)
    sweep, own = config.sweep.diameters, config.sweep.diameters.values()
    diameter = own if own.size <= number else np.linspace(sweep.start, sweep.stop, number)
    without = beyond_maxwell(every[0].counted)
    bench = Bench(every, None if without else by_maxwell(every[0].counted), line, points)
    found = list(each(bench.seen, diameter.tolist(), threads))
    k, radii = config.spectrum.wavenumbers(), radii_of(config)
    predicted = predicted_phase_slope(config.swept_material, k[0], k[-1])
    status = ExactStatus.BEYOND_SCHEME if without else ExactStatus.COMPARED
    table = make(
        "detector",
        config,
        "What the detector's falloff and radius do",
        {
            **_by_scheme(found, diameter, predicted),
            **_counted(found, diameter, predicted),
            **_statuses(found, every),
            **_of_slopes(found, diameter, predicted),
            "exact_status": ((), *flags(ExactStatus, np.array(status))),
        },
        {
            "falloff": list(FALLOFFS),
            "detector_radius": np.array(radii),
            "fibre_core_diameter": (
                "detector_radius", 2 * config.objective.magnification * np.array(radii)
            ),
            "ray_scheme": list(SCHEMES),
            "diameter": diameter,
            "focus": ("diameter", line.at(diameter)),
        },
    )  # fmt: skip
    return table.assign_attrs(recommendation=recommendation(table))


def _table(values: NDArray[Any]) -> NDArray[Any]:
    """Return values of all detectors, (..., N), by falloff and radius, (..., F, R)."""
    return values.reshape(*values.shape[:-1], len(FALLOFFS), -1)


def _last(values: Sequence[Any]) -> NDArray[Any]:
    """Return values of each diameter, of any shape, with the diameters last."""
    return np.moveaxis(np.stack(values), 0, -1)


def _over(values: NDArray[Any]) -> NDArray[Any]:
    """Return values (..., N, D) by falloff and radius, (..., F, R, D)."""
    return values.reshape(*values.shape[:-2], len(FALLOFFS), -1, values.shape[-1])


def _by_scheme(found: Sequence[Seen], diameter: Array, predicted: float) -> dict[str, Any]:
    """Return what both schemes of rays see, and how far that is from Maxwell's equations."""
    rays = over_diameter(diameter, _last([one.phase for one in found]), predicted)
    exact = over_diameter(diameter, np.array([one.exact_phase for one in found]), predicted)
    away = rays.slope - exact.slope
    shape = mean_of_known(_last([one.shape_error for one in found]))
    of_detectors = {
        "line_slope": rays.line,
        "slope_scatter": rays.scatter,
        "signal": mean_of_known(_last([one.intensity for one in found])),
        "slope_difference": root_mean_square(away),
        "slope_bias": mean_of_known(away),
        "shape_difference": np.sqrt(shape),
    }
    return {
        **{name: (("ray_scheme", *_DETECTORS), _table(one)) for name, one in of_detectors.items()},
        "ray_phase_slope": (("ray_scheme", *_DETECTORS, "diameter"), _over(rays.slope)),
        "sweep_maxwell_phase_slope": ("diameter", exact.slope),
        "maxwell_line_slope": float(exact.line),
        "maxwell_slope_scatter": float(exact.scatter),
    }


def _counted(found: Sequence[Seen], diameter: Array, predicted: float) -> dict[str, Any]:
    """Return what the number of rays does, and those at the detector's edge."""
    counted, limit = _last([one.phase for one in found])
    slope, limit_slope = (over_diameter(diameter, one, predicted).slope for one in (counted, limit))
    steps = _last([one.edge_step for one in found])
    names = {
        "mean_rays_detected": "rays", "effective_rays": "effective_rays",
        "outermost_amplitude": "outermost", "edge_rays": "edge_rays",
        "edge_amplitude": "edge_amplitude",
    }  # fmt: skip
    of_detectors = {
        "ray_noise": root_mean_square(slope - limit_slope),
        "phase_jump": jumps(counted, limit),
        "edge_phase_jump": 1e3 * root_mean_square(steps),
        **{
            name: mean_of_known(
                _last([np.array([getattr(at, of) for at in one.collected]) for one in found])
            )
            for name, of in names.items()
        },
    }
    return {
        **{name: (_DETECTORS, _table(one)) for name, one in of_detectors.items()},
        "edge_jump": ((*_DETECTORS, "diameter"), _over(steps)),
    }


def _of_slopes(found: Sequence[Seen], diameter: Array, predicted: float) -> dict[str, Any]:
    """Return why slopes and jumps are missing."""

    def told(phase: Array) -> NDArray[np.int64]:
        slope = over_diameter(diameter, phase, predicted).slope
        first = np.moveaxis(slope, -1, 0), np.moveaxis(np.isfinite(phase), -1, 0)
        found = slope_status(*first, SlopeStatus.NO_ESTIMATE)
        status: NDArray[np.int64] = np.moveaxis(found, 0, -1)
        return status

    rays = _over(told(_last([one.phase for one in found])))
    exact = told(np.array([one.exact_phase for one in found]))
    jumps = _over(_last([one.edge_step for one in found]))
    over = (*_DETECTORS, "diameter")
    return {
        "ray_slope_status": (("ray_scheme", *over), *flags(SlopeStatus, rays)),
        "maxwell_slope_status": ("diameter", *flags(SlopeStatus, exact)),
        "edge_jump_status": (over, *flags_of_missing(jumps, JumpStatus.NO_FRINGE)),
    }


def _statuses(found: Sequence[Seen], every: Sequence[Case]) -> dict[str, Any]:
    fringe = _over(_last([one.fringe for one in found]))
    limit = _table(np.array([case.status for case in every]))
    exact = np.array([one.exact_accuracy for one in found])
    accuracy = _over(_last([one.accuracy for one in found]))
    error = _over(_last([one.error for one in found]))
    over = (*_DETECTORS, "diameter")
    return {
        "fringe_status": (("ray_scheme", *over), *flags(FringeStatus, fringe)),
        "limit_status": (_DETECTORS, *flags(LimitStatus, limit)),
        "accuracy_status": (over, *flags(AccuracyStatus, accuracy)),
        "intensity_error": (over, error),
        "maxwell_accuracy_status": ("diameter", *flags(AccuracyStatus, exact)),
    }
