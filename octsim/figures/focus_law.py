"""The focus law through the fitted foci (figure 7)."""

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from octsim.config.models import FocusLine
from octsim.figures.marks import mark_doubtful
from octsim.figures.style import BLACK, BLUE, VERMILION, label, tell, title
from octsim.stages.centres import CentreUse, doubts
from octsim.stages.focus_law import LawScheme


def figure_7(fits: xr.Dataset, law: xr.Dataset) -> Figure:
    """Draw the fitted foci with their standard errors and the line through them (thesis fig. 7)."""
    figure = Figure(figsize=(6.4, 5.2))
    line = FocusLine.fitted(law)
    has_law = bool(np.isfinite(line.slope))
    foci, *rests = np.atleast_1d(
        figure.subplots(1 + has_law, sharex=True, height_ratios=(2, 1)[: 1 + has_law])
    )
    # the law of a scheme whose intensity has no peak goes through centres of another's
    own = law if "law_centre" in law else fits
    of = "law_" if own is law else ""
    diameter, centre = fits["diameter"], own[f"{of}centre"]
    errors = own[f"{of}centre_standard_error"]
    points = {"fmt": "o", "color": BLUE, "capsize": 3, "markersize": 4}
    foci.errorbar(diameter, centre, yerr=errors, label="centre ± standard error", **points)
    use = law["centre_use"].values
    at = use == CentreUse.NO_CENTRE
    if at.any():
        brightest = law["brightest_focus"].values[at]
        foci.plot(
            diameter.values[at], brightest, "x", color=VERMILION, zorder=3,
            label="no peak: the brightest focus",
        )  # fmt: skip
    at = use == CentreUse.OFF_THE_LINE
    mark_doubtful(foci, diameter.values[at], centre.values[at], "off the line, left out of the law")
    for rest in rests:
        fitted = line.at(diameter.values)
        sign = "+" if line.intercept >= 0 else "−"
        text = f"z = {line.slope:.3f} d {sign} {abs(line.intercept):.3f} µm"
        foci.plot(diameter, fitted, color=BLACK, linestyle="--", label=text)
        rest.axhline(0, color=BLACK, linestyle="--")
        # the errors are too small to see beside the line itself
        rest.errorbar(diameter, 1000 * (centre - fitted), yerr=1000 * errors, **points)
        rest.set_ylabel("Off the line (nm)")
    foci.set_ylabel(label(centre, "best focus"))
    (rests or [foci])[-1].set_xlabel(label(diameter))
    used = int((use == CentreUse.FITTED_THROUGH).sum())
    lack = "" if has_law else f", none: a peak for {used} of {use.size} diameters only"
    by = f" by scheme {LawScheme(int(law['law_scheme'])).name}" if own is law else ""
    foci.set_title(title(law, f"Focus law{by}{lack}"))
    foci.legend()
    if not (np.isfinite(centre) | np.isfinite(law["brightest_focus"])).any():
        foci.set_xlim(diameter.values[0], diameter.values[-1])  # nothing is there that sets it
    tell(figure, doubts(law))
    return figure
