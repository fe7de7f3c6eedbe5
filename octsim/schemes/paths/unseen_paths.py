"""Light paths between the rays of a survey: of slivers of the aperture, by edges of cylinders.

A spiral of rays goes through the whole tree, as in the scheme vogel. What it finds of paths that
are not known is taken as it comes, and counts as error.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from octsim.base.records import room
from octsim.optics.beam import vogel_beam
from octsim.optics.detector import Acceptance
from octsim.optics.turned_rays import Turning, path_by_lens, through_lens
from octsim.schemes.paths.check_rays import weight_of
from octsim.schemes.paths.workspace import Point
from octsim.tracing.faces import Faces
from octsim.tracing.follow import bundle_of, note_return
from octsim.tracing.kernel import FIRST_CARRIED, trace_amplitudes

SCOUTS = 16_000
"""Rays of the spiral."""
_FAINT = 0.1  # of the accuracy: amplitude from which they are followed


class Unseen(NamedTuple):
    """Rays of unknown paths, those of one path side by side, D of them."""

    path: NDArray[np.int64]
    amplitude: NDArray[np.float64]
    """With the weight of each."""
    optical_path_length: NDArray[np.float64]
    vx: NDArray[np.float64]
    """Unit direction at launch, x component."""
    vy: NDArray[np.float64]
    carried: NDArray[np.float64]
    """Amplitude without the weight."""


def unseen(
    faces: Faces,
    point: Point,
    known: NDArray[np.int64],
    max_intersections: int,
    accuracy: float,
    least: float,
) -> tuple[Unseen, int]:
    """Return the detected rays of a spiral whose light paths are not known.

    Parameters
    ----------
    faces : Faces
        Of the scene.
    point : Point
    known : ndarray
        Codes of the paths that are integrated.
    max_intersections : int
        Surfaces that one ray may meet.
    accuracy : float
        That is asked for.
    least : float
        Amplitude from which rays are followed at all.

    Returns
    -------
    Unseen
    int
        Segments traced.
    """
    detector = point.detector
    beam = vogel_beam(SCOUTS, detector.objective_radius, detector.focus_distance)
    # an aberration turns rays by more than the detector's radius
    within = np.inf if isinstance(point.lens, Turning) else detector.radius
    (ray, path), numbers, segments, _ = trace_amplitudes(
        faces, through_lens(beam, point.lens), detector, Acceptance(np.inf, within), point.focus,
        max_intersections, max(_FAINT * accuracy, least),
    )  # fmt: skip
    new = np.flatnonzero(~np.isin(path, known))
    new = new[np.argsort(path[new], kind="stable")]
    weight, more = np.zeros(new.size), np.zeros(new.size)
    returned = room(bundle_of(new.size))
    for place, arrival in enumerate(new.tolist()):
        x, y, vx, vy = numbers[1:FIRST_CARRIED, arrival].tolist()
        note_return(returned, place, detector, point.lens, x, y, vx, vy)
        weight[place] = weight_of(
            returned.x[place], returned.y[place], returned.cos[place], returned.inside[place],
            detector.radius, point.falloff,
        )  # fmt: skip
        more[place] = path_by_lens(point.lens, detector, x, y, vx, vy, x * x + y * y)
    carried, launched = numbers[FIRST_CARRIED, new], ray[new]
    arrays = (
        path[new], carried * weight / SCOUTS, numbers[0, new] + more, beam.vx[launched],
        beam.vy[launched], carried,
    )  # fmt: skip
    return Unseen(*(one[weight > 0] for one in arrays)), int(segments)
