"""The focus law: a straight line through the foci of greatest intensity (figure 7)."""

import warnings
from enum import IntEnum
from typing import NamedTuple

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from octsim.base.errors import OctsimError, OctsimWarning
from octsim.config.grid import Combination
from octsim.config.models import Config, FocusLine
from octsim.config.scheme import scheme_of
from octsim.datasets.files import flags
from octsim.datasets.layout import Layout
from octsim.datasets.reader import Stored
from octsim.datasets.streams import Part, Stream, Streamed
from octsim.schemes.table import LIGHT_PATHS, SCHEMES
from octsim.stages.centres import FEWEST, CentreUse, doubts, failures, remedy, use_of
from octsim.stages.fit_errors import StandardErrorStatus
from octsim.stages.gaussian_fits import FitStatus, fitted, law_diameters

LawScheme = IntEnum("LawScheme", list(SCHEMES), start=0)  # type: ignore[misc]
"""The scheme whose intensities a law is fitted to."""


class LawStatus(IntEnum):
    """Whether there is a focus law."""

    FITTED = 0
    TOO_FEW = 1
    """Fewer than three centres to fit; centre_use says why."""


class Line(NamedTuple):
    """A straight line, with standard errors; NaN where no degree of freedom is left."""

    slope: float
    intercept: float
    slope_standard_error: float
    intercept_standard_error: float


def fit_line(x: NDArray[np.float64], y: NDArray[np.float64]) -> Line:
    """Fit a straight line by unweighted least squares; NaN if any value is."""
    if not np.isfinite(y).all():
        return Line(np.nan, np.nan, np.nan, np.nan)
    if x.size == 2:
        slope, intercept = np.polyfit(x, y, 1)
        return Line(slope, intercept, np.nan, np.nan)
    (slope, intercept), covariance = np.polyfit(x, y, 1, cov=True)
    return Line(slope, intercept, *np.sqrt(np.diag(covariance)))


@Streamed
def focus_law(
    config: Config, fits: xr.Dataset, ray_focus_sweep: xr.Dataset | None = None
) -> Stream:
    """Fit a straight line through the fitted centres (figure 7).

    By Maxwell's equations the intensity mostly has no peak over the fractions. The law of a scheme
    without rays is therefore that of the light paths, as law_scheme says.

    Parameters
    ----------
    config : Config
        The run.
    fits : Dataset
        Of the stage gaussian_fits.
    ray_focus_sweep : Dataset, optional
        Of the stage ray_focus_sweep, where a run has it.

    Returns
    -------
    Dataset
        slope, intercept and their standard errors, NaN if there are fewer than three centres to
        fit, as law_status says; status and brightest focus of the fits, and centre_use, whether
        the line is fitted to each and why not (diameter); law_scheme, the scheme of the
        intensities.

    Warns
    -----
    OctsimWarning
        If the line is not fitted to all diameters; it names them.

    Examples
    --------
    >>> import octsim
    >>> config = octsim.load_config(
    ...     {
    ...         "tracing": {"rays": 200},
    ...         "focus_law": {"diameters": {"num": 3}, "fraction": {"num": 9}},
    ...     }
    ... )
    >>> law = octsim.focus_law(config, octsim.gaussian_fits(config, octsim.focus_sweep(config)))
    >>> round(float(law["slope"]), 1)
    0.7
    """
    title = "Focus of greatest intensity as a linear function of the diameter"
    layout = Layout("focus_law", config, title, law_diameters)
    stored = Stored(fits, "gaussian_fits", config, layout)
    by_rays = (
        None
        if ray_focus_sweep is None
        else Stored(ray_focus_sweep, "ray_focus_sweep", config, layout)
    )

    def fits_at(at: Combination) -> tuple[str, xr.Dataset]:
        scheme = scheme_of(at.config)
        if scheme.light == "rays":
            return scheme.name, stored.part(at)
        if by_rays is None:
            raise OctsimError(
                f"ray_focus_sweep: not given, but tracing.scheme: {scheme.name} follows the focus "
                "law of light paths; pass octsim.ray_focus_sweep(config)"
            )
        sweep = by_rays.part(at)
        return LIGHT_PATHS.name, xr.Dataset(fitted(sweep), {"diameter": sweep["diameter"]})

    def line(at: Combination) -> dict[str, object]:
        scheme, part = fits_at(at)
        diameter, centre = part["diameter"].values, part["centre"].values
        use = use_of(diameter, centre, part["width"].values)
        used = use == CentreUse.FITTED_THROUGH
        enough = used.sum() >= FEWEST
        status = LawStatus.FITTED if enough else LawStatus.TOO_FEW
        fitted = fit_line(diameter[used], centre[used]) if enough else Line(*[np.nan] * 4)
        own: dict[str, object] = {name: ((), value) for name, value in fitted._asdict().items()}
        own |= {
            "status": ("diameter", *flags(FitStatus, part["status"].values)),
            "centre_use": ("diameter", *flags(CentreUse, use)),
            "law_status": ((), *flags(LawStatus, np.array(status))),
            "brightest_focus": ("diameter", part["brightest_focus"].values),
            "law_scheme": ((), *flags(LawScheme, np.array(LawScheme[scheme]))),
        }
        if scheme != at.config.tracing.scheme:
            for name in ("centre", "centre_standard_error"):
                own[f"law_{name}"] = ("diameter", part[name].values)
            error = flags(StandardErrorStatus, part["standard_error_status"].values)
            own["standard_error_status"] = ("diameter", *error)
        for doubt in doubts(xr.Dataset(own, {"diameter": diameter})):
            warnings.warn(doubt, OctsimWarning, stacklevel=2)
        return own

    return Stream(layout, (Part(at, 0, 1, line(at)) for at in layout.combinations))


def sweep_foci(config: Config, law: xr.Dataset | None) -> NDArray[np.float64]:
    """Return the focus of each diameter of the sweep, from the given line or the fitted law.

    Parameters
    ----------
    config : Config
        Its ``sweep.focus`` decides.
    law : Dataset or None
        The fitted law; needed only where ``sweep.focus`` is ``law``.

    Returns
    -------
    ndarray, shape (D,)
        Heights of the focus, µm.

    Raises
    ------
    OctsimError
        If the law is needed and could not be fitted, or asks for a focus out of the objective's
        reach.
    """
    diameters = config.sweep.diameters.values()
    if isinstance(config.sweep.focus, FocusLine):
        return config.sweep.focus.at(diameters)
    given = "or give one as sweep.focus: {slope: 0.581, intercept: 69 nm}"
    if law is None:
        raise OctsimError(f"sweep.focus: 'law' given, so fit and pass the focus law, {given}")
    if not np.isfinite(law["slope"]):
        raise OctsimError(
            "sweep.focus: 'law' given, but there is no law: no centre at "
            f"{failures(law)}; {remedy(config, law)}, or give a line"
        )
    foci = FocusLine.fitted(law).at(diameters)
    if not foci.max() < config.objective.focus_distance:
        raise OctsimError(
            f"objective.focus_distance: {config.objective.focus_distance} um given, but the fitted "
            f"law asks for a focus at {foci.max():.6g} um; raise the distance, {given}"
        )
    return foci


def focus_line(config: Config, law: xr.Dataset | None) -> FocusLine:
    """Return the line that the focus follows: the config's, or the fitted law.

    Raises
    ------
    OctsimError
        If the law is needed and could not be fitted, or there are several.
    """
    if isinstance(config.sweep.focus, FocusLine):
        return config.sweep.focus
    if law is not None and law["slope"].dims:
        raise OctsimError(
            "grid: given, and so several focus laws; do this without a grid, or give one focus as "
            "sweep.focus: {slope: 0.581, intercept: 69 nm}"
        )
    sweep_foci(config, law)  # says what is wrong with a law that does not serve
    return FocusLine.fitted(law)
