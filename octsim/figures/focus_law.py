"""The focus law through the fitted foci (figure 7)."""

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from octsim.config.models import FocusLine
from octsim.figures.style import BLACK, BLUE, label, title


def figure_7(fits: xr.Dataset, law: xr.Dataset) -> Figure:
    """Draw the fitted foci with their standard errors and the line through them (thesis fig. 7)."""
    figure = Figure(figsize=(6.4, 5.2))
    line = FocusLine.fitted(law)
    has_law = bool(np.isfinite(line.slope))
    foci, *rests = np.atleast_1d(
        figure.subplots(1 + has_law, sharex=True, height_ratios=(2, 1)[: 1 + has_law])
    )
    diameter, centre = fits["diameter"], fits["centre"]
    errors = fits["centre_standard_error"]
    points = {"fmt": "o", "color": BLUE, "capsize": 3, "markersize": 4}
    foci.errorbar(diameter, centre, yerr=errors, label="centre ± standard error", **points)
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
    found = int(np.isfinite(centre).sum())
    lack = "" if has_law else f", none: a peak for {found} of {centre.size} diameters only"
    foci.set_title(title(law, f"Focus law{lack}"))
    foci.legend()
    return figure
