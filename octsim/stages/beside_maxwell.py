"""What a run says of its phase slope, and how far rays are from Maxwell's equations."""

import numpy as np
import xarray as xr

from octsim.config.grid import combinations
from octsim.config.light import FibreMode, GaussianFill
from octsim.config.maxwell import beyond_maxwell, by_maxwell
from octsim.config.models import Config
from octsim.datasets.versions import recorded_config
from octsim.stages import phase_slope
from octsim.stages.by_maxwell import ExactStatus
from octsim.stages.cost_estimate import estimate

_ASK = "ask for snakemake validity"


def summary(slopes: xr.Dataset) -> str:
    """Return in one line what a run found, and how far it is from Maxwell's equations."""
    return "; ".join(filter(None, (phase_slope.summary(slopes), beside(slopes))))


def beside(slopes: xr.Dataset) -> str:
    """Say how far the slope by rays is from that by Maxwell's equations; empty of a run by them.

    Of a grid that is its first combination.
    """
    if "exact_status" not in slopes:
        return ""
    config = Config.model_validate(recorded_config(slopes.attrs))
    first = next(combinations(config)).config
    status = ExactStatus(int(slopes["exact_status"].values.flat[0]))
    if status == ExactStatus.BY_MAXWELL:
        return ""
    count = first.sweep.diameters.num
    exact = slopes["exact_phase_slope"].values.ravel()[:count]
    rays = slopes["phase_slope"].values.ravel()[:count]
    both = np.isfinite(exact) & np.isfinite(rays)
    if not both.any():
        return f"not compared with Maxwell's equations: {_reason(first, status)}"
    off = rays[both] / exact[both] - 1
    away, slope = (rays - exact)[both], exact[both].mean()
    mean, sure = away.mean() / slope, away.std() / np.sqrt(max(off.size - 1, 1)) / abs(slope)
    where = "at the grid's first combination" if config.grid.varied else "here"
    return (
        f"for a {pupil_name(first)} pupil and the estimator {first.processing.estimator}, rays are "
        f"{abs(mean):.1%} ± {sure:.1%} {'high' if mean > 0 else 'low'} {where} "
        f"({off.min():+.1%} to {off.max():+.1%} at {off.size} diameters, where the slope is "
        f"{slope:.3f} mrad/nm by Maxwell's equations); tracing: {{preset: exact}} "
        f"takes about {seconds_told(exact_seconds(first))} of processor time"
    )


def pupil_name(config: Config) -> str:
    """Name the pupil that a config by Maxwell's equations has."""
    pupil = by_maxwell(config).pupil
    if isinstance(pupil, GaussianFill):
        return f"Gaussian (fill {pupil.gaussian:g})"
    return "fibre" if isinstance(pupil, FibreMode) else pupil


def exact_seconds(config: Config) -> float:
    """Return the processor time (s) of a plain config's run by Maxwell's equations, typically."""
    whole = estimate(by_maxwell(config), lambda _, typical: typical)
    return whole.of(*whole.stages).cpu_seconds


def seconds_told(seconds: float) -> str:
    """Write a time to a digit or two."""
    return f"{seconds:.2g} s" if seconds < 100 else f"{seconds / 60:.2g} min"


def _reason(config: Config, status: ExactStatus) -> str:
    return {
        ExactStatus.BEYOND_SCHEME: beyond_maxwell(config),
        ExactStatus.NO_FOCUS: "there is no focus law; give sweep.focus",
        ExactStatus.TOO_LONG: f"it takes long at these diameters; {_ASK}",
        ExactStatus.OTHER_ESTIMATOR: (
            f"processing.estimator: {config.processing.estimator} compares with light paths; {_ASK}"
        ),
        ExactStatus.NOT_REACHED: "their accuracy was not reached; give smaller diameters",
    }.get(status, "no diameter has both slopes; give three diameters or more")
