"""Where the surfaces of a scene are cut by the plane y = 0: lines to draw."""

import numpy as np
from numpy.typing import NDArray

from octsim.optics.scene import Cylinder, Scene

_PLACES = 181
"""Of a closed line."""
_ALONG = 1e-3
"""Sine of the angle to the plane below which a cylinder is taken to be along it."""


def outlines(scene: Scene, left: float, right: float) -> list[tuple[str, NDArray[np.float64]]]:
    """Return each surface's name and its line in the plane y = 0: x and z, (2, V), µm.

    A lifted cylinder is cut where it ends, at the planes of its layer.

    Parameters
    ----------
    scene : Scene
    left, right : float
        Between which planes are drawn, µm.
    """
    # a part of a plane, where a cylinder ends, is in the line of the rest
    planes = {one.height: one for one in scene.surfaces[::-1] if not isinstance(one, Cylinder)}
    cylinders = [one for one in scene.surfaces if isinstance(one, Cylinder)]
    return [
        *(
            (plane.name, np.array([[left, right], [height, height]]))
            for height, plane in sorted(planes.items())
        ),
        *((one.name, _cut(one, sorted(planes))) for one in cylinders),
    ]


def _cut(cylinder: Cylinder, heights: list[float]) -> NDArray[np.float64]:
    """Return the ellipse in which a cylinder is cut."""
    across, _, up = cylinder.axis
    # |p|² − (p·u)² = r² with p in the plane: a quadratic form, diagonal along (across, up)
    towards = np.array([across, up])
    level = np.hypot(across, up)
    long = towards / level if level > 0 else np.array([1.0, 0.0])
    short = np.array([-long[1], long[0]])
    turn = np.linspace(0, 2 * np.pi, _PLACES)
    # along the plane, or nearly, both of its sides are lines
    far = cylinder.radius / np.sqrt(max(1 - level**2, _ALONG**2))
    line = np.outer(long, far * np.cos(turn)) + np.outer(short, cylinder.radius * np.sin(turn))
    line += np.array([[cylinder.x], [cylinder.z]])
    below = max((h for h in heights if h <= cylinder.z), default=-np.inf)
    above = min((h for h in heights if h > cylinder.z), default=np.inf)
    line[:, (line[1] < below) | (line[1] > above)] = np.nan
    return line
