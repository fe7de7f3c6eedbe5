"""The focus scan as an animation: the scene with its rays, and the intensity, focus after focus."""

from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.animation import PillowWriter
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from octsim.base.errors import DatasetError
from octsim.base.files import whole
from octsim.figures.paths import LINES
from octsim.figures.recorded import config_in
from octsim.figures.scene import draw_scene, window_of
from octsim.figures.style import BLUE, label, title, unit_of_intensity
from octsim.figures.style import look as house_look
from octsim.instrument.build import scene_of
from octsim.instrument.drawn_rays import DrawnPath, drawn_rays
from octsim.optics.scene import Scene

_FRAMES = 24
_DOTS = 80
"""An inch: with 24 frames about half a megabyte."""
_A_SECOND = 4
_PATHS = 4
"""Drawn in each frame, at most."""
_FAINT = ("0.6", ":")
"""Of paths that are among the strongest in few frames."""


def animate(scan: xr.Dataset, path: Path) -> None:
    """Write the animation of a focus scan as a GIF, the same bytes each time.

    Parameters
    ----------
    scan : Dataset
        focus_scan, of a plain config.
    path : Path
        Of the GIF; it is replaced whole.

    Raises
    ------
    DatasetError
        If the scan is one over a grid.
    FileError
        If the file can't be written.
    """
    if scan["intensity"].ndim != 1:
        over = ", ".join(str(name) for name in scan["intensity"].dims if name != "focus")
        raise DatasetError(
            f"animation: focus_scan is over a grid of {over}; it is of one config: leave grid out"
        )
    config = config_in(scan)
    diameter = float(scan["diameter"])
    scene = scene_of(config, diameter)
    chosen = np.linspace(0, scan.sizes["focus"] - 1, _FRAMES).round().astype(int)
    frames = scan.isel(focus=np.unique(chosen))
    foci = frames["focus"].values.tolist()
    # one window, and one look of each path, for all frames
    ends = np.array([window_of(scene, focus) for focus in (min(foci), max(foci))])
    window = (ends[:, 0].min(), ends[:, 1].max(), ends[:, 2].min(), ends[:, 3].max())
    drawn = [drawn_rays(config, diameter, focus, window[2], paths=_PATHS) for focus in foci]
    lines = _lines(drawn)
    with house_look(), whole(path) as temporary:
        figure = Figure(figsize=(8.0, 4.4))
        FigureCanvasAgg(figure)
        writer = PillowWriter(fps=_A_SECOND)
        writer.setup(figure, str(temporary), dpi=_DOTS)
        for number, focus in enumerate(foci):
            figure.clear()
            seen, light = figure.subplots(1, 2)
            _draw_rays(seen, scene, focus, window, drawn[number], lines)
            _draw_light(light, scan, number, frames)
            figure.suptitle(title(scan, f"Focus at {focus:+.2f} µm, diameter {diameter:g} µm"))
            writer.grab_frame()
        writer.finish()


def _lines(drawn: list[list[DrawnPath]]) -> dict[str, tuple[str, Any]]:
    """Return the look of each path: own ones of those with most field over all frames."""
    field: dict[str, float] = {}
    for path in (path for frame in drawn for path in frame):
        field[path.name] = field.get(path.name, 0.0) + path.field
    ordered = sorted(field, key=lambda name: (-field[name], name))
    return {name: LINES[at] if at < len(LINES) else _FAINT for at, name in enumerate(ordered)}


def _draw_rays(
    axes: Axes,
    scene: Scene,
    focus: float,
    window: tuple[float, float, float, float],
    drawn: list[DrawnPath],
    lines: dict[str, tuple[str, Any]],
) -> None:
    draw_scene(axes, scene, focus, window, [(path, *lines[path.name]) for path in drawn])
    # the same in all frames, whatever is drawn in this one
    named = {name: look for name, look in lines.items() if look != _FAINT}
    for name, (colour, line) in named.items():
        axes.plot([], [], color=colour, linestyle=line, label=name)
    if named:
        axes.legend(loc="upper left", fontsize=5, handlelength=1.5)


def _draw_light(axes: Axes, scan: xr.Dataset, number: int, frames: xr.Dataset) -> None:
    lit = scan["intensity"].where(scan["intensity"] > 0)
    axes.plot(scan["focus"], lit, color=BLUE, linewidth=1.0)
    now = frames["intensity"].where(frames["intensity"] > 0).isel(focus=number)
    axes.plot(now["focus"], now, marker="o", color="0.1", linestyle="none")
    if (scan["intensity"] > 0).any():
        axes.set_yscale("log")
    axes.set_xlabel(label(scan["focus"]))
    axes.set_ylabel(label(scan["intensity"], f"mean intensity (1 = {unit_of_intensity(scan)})"))
