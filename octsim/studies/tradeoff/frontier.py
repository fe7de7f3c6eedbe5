"""Comparing settings: which are efficient, and what an error costs by either scheme."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from octsim.datasets.files import flags
from octsim.studies.tradeoff.missing import TargetStatus, target_status

TARGETS = (1e-3, 1e-4)
"""Errors at which the schemes are compared, beside that of `COUNTED` rays."""
COUNTED = 3000
_LAWFUL = 0.1  # an error near one, that of a sum with too few rays, follows no law
Array = NDArray[np.float64]


def efficient(cost: Array, error: Array) -> NDArray[np.bool_]:
    """Return which points (N,) no other one beats: none is as cheap and as good, and better in one.

    A point that lacks its cost or its error is beaten.
    """
    better = (cost[:, np.newaxis] <= cost) & (error[:, np.newaxis] <= error)
    strictly = (cost[:, np.newaxis] < cost) | (error[:, np.newaxis] < error)
    beaten = np.any(better & strictly, axis=0)
    unbeaten: NDArray[np.bool_] = np.isfinite(cost) & np.isfinite(error) & ~beaten
    return unbeaten


def power_law(cost: Array, error: Array) -> tuple[float, float]:
    """Return factor and exponent of error = factor · cost^exponent, fitted to logarithms, (N,)."""
    used = np.isfinite(error) & (error > 0) & (error < _LAWFUL)
    if used.sum() < 2:
        return np.nan, np.nan
    exponent, constant = np.polyfit(np.log(cost[used]), np.log(error[used]), 1)
    return float(np.exp(constant)), float(exponent)


def cost_of_rays(segments: Array, error: Array, target: float) -> tuple[float, bool]:
    """Return the segments that counted rays need for an error, and whether that is measured.

    Measured is what lies between two points (N,), of increasing segments, the second and all after
    it within the target; beyond the last one it is the power law's.
    """
    above = np.flatnonzero(error > target)
    last = int(above[-1]) if above.size else -1
    if 0 <= last < error.size - 1:
        ends = slice(last, last + 2)
        # increasing errors, as interpolation wants them
        x, y = np.log(error[ends])[::-1], np.log(segments[ends])[::-1]
        return float(np.exp(np.interp(np.log(target), x, y))), True
    factor, exponent = power_law(segments, error)
    return float((target / factor) ** (1 / exponent)), False


def comparison(
    factor: NDArray[np.str_], value: Array, segments: Array, error: Array
) -> dict[str, Any]:
    """Return how the schemes compare at each target, as variables of the trade's dataset.

    Parameters
    ----------
    factor, value : ndarray, shape (N,)
        What each setting varies, and to what.
    segments, error : ndarray, shape (N,)
        Its segments a diameter and its largest error of the intensity.
    """
    by_rays = factor == "tracing.rays"
    rays = np.flatnonzero(by_rays)[np.argsort(segments[by_rays])]
    paths = np.flatnonzero(factor == "tracing.accuracy")
    constant, exponent = power_law(segments[rays], error[rays])
    of_rays = error[by_rays & (value == COUNTED)]
    targets = np.array([of_rays[0] if of_rays.size else np.nan, *TARGETS])
    counted = [cost_of_rays(segments[rays], error[rays], target) for target in targets]
    cheapest = [segments[paths][error[paths] <= t].min(initial=np.inf) for t in targets]
    needed = np.where(np.isfinite(cheapest), cheapest, np.nan)
    between = np.array([_between(segments[paths], error[paths], t) for t in targets])
    rays_needed = np.array([cost for cost, _ in counted])
    return {
        "rays_law_factor": constant,
        "rays_law_exponent": exponent,
        "rays_law_error": ("setting", np.where(by_rays, constant * segments**exponent, np.nan)),
        "target_error": ("target", targets),
        "target_status": ("target", *flags(TargetStatus, target_status(rays_needed, needed))),
        "rays_segments": ("target", rays_needed),
        "rays_measured": ("target", np.array([int(measured) for _, measured in counted])),
        "paths_segments": ("target", needed),
        "segments_ratio": ("target", rays_needed / needed),
        "paths_segments_between": ("target", between),
        "segments_ratio_between": ("target", rays_needed / between),
    }


def _between(segments: Array, error: Array, target: float) -> float:
    """Return the segments for an error, between efficient points (N,) or of the cheapest one."""
    best = efficient(segments, error)
    order = np.argsort(error[best])
    x, y = np.log(error[best][order]), np.log(segments[best][order])
    return float(np.exp(np.interp(np.log(target), x, y, left=np.nan))) if best.any() else np.nan
