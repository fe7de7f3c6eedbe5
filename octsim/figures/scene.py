"""The scene to scale, with rays of its strongest light paths."""

from collections.abc import Sequence
from typing import Any

import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from octsim.figures.paths import LINES
from octsim.figures.recorded import config_in, middle_of
from octsim.figures.style import title
from octsim.instrument.build import scene_of
from octsim.instrument.drawn_rays import DrawnPath, drawn_rays
from octsim.optics.outlines import outlines
from octsim.optics.scene import Cylinder, Scene

_BESIDE = 0.6
"""How far the picture reaches beyond what is in it, over its size."""
_NAME_EVERY = 14
"""Places of a line that the name of each is further on than that of the one before."""
_LONG = 45
"""Letters of a name that leave room for no other beside."""
_LEAST = 0.4
"""The least of that, µm."""


def scene_figure(spectra: xr.Dataset) -> Figure:
    """Draw the middle diameter of a sweep, cut by the plane y = 0, and rays on its light paths."""
    config, (diameter, focus) = config_in(spectra), middle_of(spectra)
    scene = scene_of(config, diameter)
    window = window_of(scene, focus)
    figure = Figure(figsize=(6.4, 6.4))
    axes = figure.subplots()
    drawn = drawn_rays(config, diameter, focus, window[2])
    draw_scene(axes, scene, focus, window, [(path, *LINES[at]) for at, path in enumerate(drawn)])
    # the strongest last, as it is drawn last
    for path, (colour, line) in reversed(list(zip(drawn, LINES, strict=False))):
        axes.plot([], [], color=colour, linestyle=line, label=f"{path.name}: {path.field:.1e}")
    axes.set_title(title(spectra, f"The scene at d = {diameter:.4g} µm, focus (+) {focus:.4g} µm"))
    handles, names = axes.get_legend_handles_labels()
    figure.legend(
        handles[::-1], names[::-1], loc="outside lower center", fontsize=7,
        ncols=1 if max(map(len, names), default=0) > _LONG else 2,
        title="light paths, and their fields", title_fontsize=8,
        handlelength=4,
    )  # fmt: skip
    return figure


def draw_scene(
    axes: Axes,
    scene: Scene,
    focus: float,
    window: tuple[float, float, float, float],
    paths: Sequence[tuple[DrawnPath, str, Any]],
) -> None:
    """Draw a scene cut by the plane y = 0, its focus, and rays of light paths, strongest first.

    Parameters
    ----------
    axes : Axes
    scene : Scene
    focus : float
        Its height, µm.
    window : tuple of float
        The ends of the picture in x and in height, µm.
    paths : sequence
        Light paths, each with its colour and its line.
    """
    left, right, bottom, top = window
    for number, (name, (x, z)) in enumerate(outlines(scene, left, right)):
        axes.plot(x, z, color="0.2", linewidth=0.8)
        # names of nested lines begin at other places of them
        at = (_NAME_EVERY * number) % x.size if x.size > 2 else 0
        axes.annotate(name, (x[at], z[at]), textcoords="offset points", xytext=(3, 3), fontsize=8)
    # the faintest first, so that those that matter are above them
    for path, colour, line in reversed(paths):
        for place in path.places:
            axes.plot(place[:, 0], place[:, 2], color=colour, linestyle=line, linewidth=0.7)
    axes.plot(0, focus, marker="+", color="0.2", markersize=9, linestyle="none")
    axes.set(xlim=(left, right), ylim=(bottom, top), aspect="equal")
    axes.set_xlabel("x (µm)")
    axes.set_ylabel("height (µm)")
    axes.grid(visible=False)


def window_of(scene: Scene, focus: float) -> tuple[float, float, float, float]:
    """Return the ends of a picture of all surfaces, in x and in height, µm."""
    cylinders = [one for one in scene.surfaces if isinstance(one, Cylinder)]
    heights = [one.height for one in scene.surfaces if not isinstance(one, Cylinder)]
    ends = [one.x + side * one.radius for one in cylinders for side in (-1, 1)]
    tops = [0.0, focus, *heights, *(one.z + one.radius for one in cylinders)]
    left, right, top = min(ends, default=-0.5), max(ends, default=0.5), max(tops)
    beside = max(_BESIDE * max(right - left, top) / 2, _LEAST)
    return left - beside, right + beside, -2 * beside, top + beside
