"""The intensity and the number of detected rays over the focus (figure 6)."""

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from octsim.figures.marks import mark_points
from octsim.figures.recorded import config_in
from octsim.figures.style import BLUE, ORANGE, SKY, label, tell, title, unit_of_intensity
from octsim.instrument.build import scene_of
from octsim.optics.scene import Cylinder
from octsim.phase.fringe_status import FringeStatus


def figure_6(scan: xr.Dataset) -> Figure:
    """Draw the number of detected rays and the intensity over the focus (thesis fig. 6)."""
    figure = Figure(figsize=(6.4, 5.6))
    rays, light = figure.subplots(2, sharex=True)
    focus = scan["focus"]
    # off the first peak both fall by decades: linear axes would show one peak of three
    rays.plot(focus, scan["rays_detected"], color=ORANGE)
    rays.set_yscale("symlog", linthresh=1)
    rays.set_ylabel(label(scan["rays_detected"], "rays detected"))
    _intensity(light, scan)
    for axes in (rays, light):
        _neuron(axes, scan)
    light.set_ylabel(label(scan["intensity"], f"mean intensity\n(1 = {unit_of_intensity(scan)})"))
    light.set_xlabel(label(focus))
    rays.set_title(title(scan, f"Focus scan, diameter {float(scan['diameter']):g} µm"))
    figure.legend(
        *light.get_legend_handles_labels(), loc="outside lower center", ncols=2, fontsize=9
    )
    if not (scan["intensity"] > 0).any():
        tell(figure, [f"no light at any focus: {FringeStatus.NO_LIGHT.remedy}"])
    return figure


def _intensity(axes: Axes, scan: xr.Dataset) -> None:
    """Draw the intensity with its error, as if that were a share of the mean over the band."""
    focus, mean = scan["focus"].values, scan["intensity"].values
    seen = np.where(mean > 0, mean, np.nan)
    axes.semilogy(focus, seen, color=BLUE, label="intensity")
    low, high = axes.get_ylim()
    error = scan["intensity_error"].values * seen
    axes.fill_between(
        # 0, which no such axis reaches, is its lower edge
        focus, np.maximum(seen - error, low), seen + error, color=SKY, alpha=0.4, linewidth=0,
        label="± its estimated error, to 0 where it is larger",
    )  # fmt: skip
    axes.set_ylim(low, max(high, 1.5 * np.nanmax(seen + error, initial=0.0)))
    mark_points(axes, focus, seen, scan["accuracy_status"])


def _neuron(axes: Axes, scan: xr.Dataset) -> None:
    """Shade the heights between the lower and the upper side of each cylinder."""
    config = config_in(scan)
    surfaces = scene_of(config, float(scan["diameter"])).surfaces
    cylinders = [one for one in surfaces if isinstance(one, Cylinder)]
    for number, one in enumerate(cylinders):
        axes.axvspan(
            one.z - one.radius, one.z + one.radius, facecolor="0.92", edgecolor="0.6",
            linewidth=0.8, zorder=0, label="" if number else "the neuron, side to side",
        )  # fmt: skip
