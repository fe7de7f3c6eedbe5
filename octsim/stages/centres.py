"""Centres of the Gaussian fits: which the focus law goes through, and what is said of the rest."""

from enum import IntEnum

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from octsim.config.following import fitted_diameters
from octsim.config.models import Config
from octsim.config.scheme import scheme_of
from octsim.stages.gaussian_fits import FitStatus

FEWEST = 3
"""Centres that a law is fitted to, at least."""
_OFF = 5.0
"""Robust standard deviations from the line of the others, beyond which a centre is off it."""
_SEEN = 0.25
"""Of a width: a centre that is less off the line hardly changes the intensity."""
_POOR = 0.1
"""Of the range of the intensity: what no single peak leaves."""
_FARTHER = 0.5
_WIDER = 1.25
"""Diameters, or ranges of fractions if that is more, by which an edge is moved that peaks are
beyond. Of 341 ranges that lacked a peak, in scenes drawn at random, 222 had them all then, and 107
at the second time."""
_NAMED = 5
"""Diameters that a line names."""


class CentreUse(IntEnum):
    """Whether the focus law is fitted to a centre."""

    FITTED_THROUGH = 0
    NO_CENTRE = 1
    """The Gaussian's fit has failed, as its status says."""
    OFF_THE_LINE = 2
    """Far from the line of the others, and left out."""


def use_of(
    diameter: NDArray[np.float64], centre: NDArray[np.float64], width: NDArray[np.float64]
) -> NDArray[np.int64]:
    """Tell which centres a law is fitted to.

    Of four or more, one is left out that is farther from their repeated-median line (Siegel 1982,
    doi:10.1093/biomet/69.1.242) than a quarter of the median width and than five standard
    deviations, 1.4826 times the median distance.

    Parameters
    ----------
    diameter, centre, width : ndarray, shape (D,)
        Of each fit, µm; NaN where it failed.

    Returns
    -------
    ndarray, shape (D,)
        Values of `CentreUse`.
    """
    found = np.isfinite(centre)
    use = np.where(found, CentreUse.FITTED_THROUGH, CentreUse.NO_CENTRE)
    if found.sum() > FEWEST:
        from scipy.stats import siegelslopes  # here, as it takes half a second to import

        slope, intercept = siegelslopes(centre[found], diameter[found])
        off = np.abs(centre - (slope * diameter + intercept))
        scatter = 1.4826 * np.median(off[found])
        use[off > max(_OFF * scatter, _SEEN * np.median(width[found]))] = CentreUse.OFF_THE_LINE
    return use


def doubts_of_fits(fits: xr.Dataset) -> list[str]:
    """Say where a single peak is not what the intensity shows."""
    poor = fits["relative_residual"] > _POOR
    if not poor.any():
        return []
    return [
        f"gaussian_fits: a Gaussian leaves more than {_POOR} of the intensity's range "
        f"(relative_residual) at {_at(poor, fits)}: there are several peaks or much noise; narrow "
        "focus_law.fraction around one peak, or raise tracing.rays"
    ]


def doubts(law: xr.Dataset) -> list[str]:
    """Say, a line each, which centres a focus law is not fitted to, and why."""
    failed = law["centre_use"] == CentreUse.NO_CENTRE
    off = law["centre_use"] == CentreUse.OFF_THE_LINE
    said = []
    if failed.any():
        said.append(
            f"focus_law: no Gaussian fits at {_at(failed, law)}; the law is fitted to the rest, "
            f"if that is {FEWEST} or more"
        )
    if off.any():
        said.append(
            f"focus_law: left out as far off the line of the others, by more than {_OFF:g} robust "
            f"standard deviations and {_SEEN} of a width: {_at(off, law)}"
        )
    return said


def failures(law: xr.Dataset) -> str:
    """Name the diameters of a law without a centre, and why each has none."""
    return _at(law["centre_use"] != CentreUse.FITTED_THROUGH, law, 2)  # of a long line


def _at(which: xr.DataArray, dataset: xr.Dataset, most: int = _NAMED) -> str:
    """Name the diameters of some fits, what became of each, and where it was brightest."""
    chosen = which.values
    along = {
        name: dataset[name].broadcast_like(which).transpose(*which.dims).values[chosen]
        for name in ("diameter", "status", "brightest_focus")
    }
    named = [
        f"{diameter:.4g} um ({FitStatus(status).name.lower()}"
        + ("" if np.isnan(brightest) else f", brightest at {brightest:.4g} um")
        + ")"
        for diameter, status, brightest in list(zip(*along.values(), strict=True))[:most]
    ]
    more = [f"and {chosen.sum() - most} more"] if chosen.sum() > most else []
    return f"{chosen.sum()} of {chosen.size} diameters: {', '.join([*named, *more])}"


def remedy(config: Config, law: xr.Dataset) -> str:
    """Return what gives a law where there is none, by where the intensity is largest.

    Parameters
    ----------
    config : Config
        Of one combination.
    law : Dataset
        Its law, which lacks centres.
    """
    if fitted_diameters(config).num < FEWEST:
        return f"raise focus_law.diameters.num to {FEWEST} or more"
    failed = law["centre_use"].values != CentreUse.FITTED_THROUGH
    if (law["status"].values[failed] == FitStatus.NO_LIGHT).all():
        rays = " or tracing.rays" if scheme_of(config).counts_rays else ""
        return (
            "nothing is detected there; give media whose indices differ, or raise "
            f"detector.core_diameter{rays}"
        )
    tried = config.focus_law.fraction
    brightest = (law["brightest_focus"] / law["diameter"]).values[failed]
    middle, reach = (tried.start + tried.stop) / 2, tried.stop - tried.start
    if np.isnan(brightest).all():
        return (
            "the intensity is the same at all foci; bring focus_law.fraction to the neuron (0 to "
            "1), change detector.core_diameter"
        )
    by = max(_FARTHER, _WIDER * reach)
    start = tried.start - by * bool((brightest < middle).any())
    stop = tried.stop + by * bool((brightest >= middle).any())
    num = 1 + round((stop - start) / reach * (tried.num - 1))
    return f"give focus_law.fraction: {{start: {start:.6g}, stop: {stop:.6g}, num: {num}}}"
