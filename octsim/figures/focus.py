"""Figures 6 and 7: intensity over the focus, and the focus law."""

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

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
    foci, rest = figure.subplots(2, sharex=True, height_ratios=(2, 1))
    diameter, centre = fits["diameter"], fits["centre"]
    errors = fits["centre_standard_error"]
    points = {"fmt": "o", "color": BLUE, "capsize": 3, "markersize": 4}
    foci.errorbar(diameter, centre, yerr=errors, label="centre ± standard error", **points)
    slope, intercept = float(law["slope"]), float(law["intercept"])
    if np.isfinite(slope):
        line = slope * diameter + intercept
        text = f"z = {slope:.3f} d {'+' if intercept >= 0 else '−'} {abs(intercept):.3f} µm"
        foci.plot(diameter, line, color=BLACK, linestyle="--", label=text)
        rest.axhline(0, color=BLACK, linestyle="--")
        # the errors are too small to see beside the line itself
        rest.errorbar(diameter, 1000 * (centre - line), yerr=1000 * errors, **points)
    foci.set_ylabel(label(centre, "best focus"))
    rest.set_ylabel("Off the line (nm)")
    rest.set_xlabel(label(diameter))
    foci.set_title(title(law, "Focus law"))
    foci.legend()
    return figure
