"""The intensity and the number of detected rays over the focus (figure 6)."""

import xarray as xr
from matplotlib.figure import Figure

from octsim.figures.style import BLUE, ORANGE, label, tell, title, unit_of_intensity
from octsim.phase.fringe_status import FringeStatus


def figure_6(scan: xr.Dataset) -> Figure:
    """Draw the number of detected rays and the intensity over the focus (thesis fig. 6)."""
    figure = Figure(figsize=(6.4, 5.2))
    rays, light = figure.subplots(2, sharex=True)
    focus = scan["focus"]
    # off the first peak both fall by decades: linear axes would show one peak of three
    rays.plot(focus, scan["rays_detected"], color=ORANGE)
    rays.set_yscale("symlog", linthresh=1)
    rays.set_ylabel(label(scan["rays_detected"], "rays detected"))
    light.semilogy(focus, scan["intensity"].where(scan["intensity"] > 0), color=BLUE)
    light.set_ylabel(label(scan["intensity"], f"mean intensity\n(1 = {unit_of_intensity(scan)})"))
    light.set_xlabel(label(focus))
    rays.set_title(title(scan, f"Focus scan, diameter {float(scan['diameter']):g} µm"))
    if not (scan["intensity"] > 0).any():
        tell(figure, [f"no light at any focus: {FringeStatus.NO_LIGHT.remedy}"])
    return figure
