"""Figures 6 and 7: intensity over the focus, and the focus law."""

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from octsim.config.models import FocusLine
from octsim.figures.style import BLACK, BLUE, ORANGE, label, title


def figure_6(scan: xr.Dataset) -> Figure:
    """Draw the number of detected rays and the intensity over the focus (thesis fig. 6)."""
    figure = Figure(figsize=(6.4, 5.2))
    rays, light = figure.subplots(2, sharex=True)
    focus = scan["focus"]
    # off the first peak both fall by decades: linear axes would show one peak of three
    rays.plot(focus, scan["rays_detected"], color=ORANGE)
    rays.set_yscale("symlog", linthresh=1)
    rays.set_ylabel(label(scan["rays_detected"], "rays detected"))
    light.semilogy(focus, scan["intensity"], color=BLUE)
    light.set_ylabel(label(scan["intensity"], "mean intensity\n(1 = all light in phase)"))
    light.set_xlabel(label(focus))
    rays.set_title(title(scan, f"Focus scan, diameter {float(scan['diameter']):g} µm"))
    return figure


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
