"""The light that leaves the objective: where rays start on its disk, and where they head."""

import math
from collections.abc import Callable
from typing import Any, NamedTuple, TypeVar

import numpy as np
from numba.extending import overload, register_jitable
from numpy.typing import NDArray

# The golden ratio (√5 − 1) / 2 as a sum. A multiple of the first is exact, so that whole turns come
# off it without rounding: the ten millionth ray is as well placed as the first.
_COARSE, _FINE = 41475558 / 2**26, 1.3387117138243649e-08


Coordinate = TypeVar("Coordinate", float, NDArray[np.float64])


class Beam(NamedTuple):
    """Rays aimed at the focus, N of them; referred to the focus, where their path is zero."""

    vx: NDArray[np.float64]
    """Unit direction, x component, (N,)."""
    vy: NDArray[np.float64]
    """Unit direction, y component, (N,)."""
    vz: NDArray[np.float64]
    """Unit direction, z component, positive, (N,)."""
    amplitude: NDArray[np.float64]
    """Amplitude at launch, (N,); sums to one."""
    number: NDArray[np.int64]
    """Number of each ray, (N,), whatever the order in which they stand here."""


class DisplacedBeam(NamedTuple):
    """Rays that cross the focal plane beside the focus, N of them."""

    vx: NDArray[np.float64]
    """Unit direction, x component, (N,)."""
    vy: NDArray[np.float64]
    """Unit direction, y component, (N,)."""
    vz: NDArray[np.float64]
    """Unit direction, z component, positive, (N,)."""
    amplitude: NDArray[np.float64]
    """Amplitude at launch, (N,); sums to one."""
    number: NDArray[np.int64]
    """Number of each ray, (N,), whatever the order in which they stand here."""
    x: NDArray[np.float64]
    """Where it crosses the focal plane, from the focus, (N,), µm."""
    y: NDArray[np.float64]
    """The same, along y, (N,), µm."""
    optical_path_length: NDArray[np.float64]
    """Its path there, beyond that of a ray through the focus, (N,), µm."""


def crossing(beam: Any, place: int) -> tuple[float, float, float]:
    """Return where a ray of a beam crosses the focal plane, and its path there, µm."""
    if isinstance(beam, DisplacedBeam):
        return beam.x[place], beam.y[place], beam.optical_path_length[place]
    return 0.0, 0.0, 0.0


# by the type of the beam, when code is compiled: one in focus has nothing of it
@overload(crossing, strict=False)
def _compile_crossing(beam: Any, place: Any) -> Callable[..., Any] | None:  # noqa: ARG001
    if getattr(beam, "instance_class", None) is DisplacedBeam:
        return lambda beam, place: (
            beam.x[place], beam.y[place], beam.optical_path_length[place]
        )  # fmt: skip
    if getattr(beam, "instance_class", None) in (None, Beam):
        return lambda beam, place: (0.0, 0.0, 0.0)  # noqa: ARG005
    return None  # another kind of beam has its own


def aperture_radius(numerical_aperture: float, index: float, focus_distance: float) -> float:
    """Return the radius of the objective's disk, focus_distance · tan(asin(NA / n)), in µm.

    As NA / √((n − NA)(n + NA)) the tangent keeps its digits where NA is close to the index n of the
    medium that the objective lies in.
    """
    cosine = math.sqrt((index - numerical_aperture) * (index + numerical_aperture))
    return focus_distance * (numerical_aperture / cosine)


def vogel_spiral(
    num: int, radius: float, number: NDArray[np.int64] | None = None
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    r"""Return points placed evenly on a disk, as the seeds of a sunflower.

    .. math:: \theta_j = 2\pi j \varphi, \quad r_j = R \sqrt{j / (N - 1)}

    (thesis eq. (3), after Vogel 1978) with the golden ratio
    :math:`\varphi = (\sqrt 5 - 1) / 2`; a single point is at the centre.

    Parameters
    ----------
    num : int
        Number of points, N.
    radius : float
        Radius of the disk, R.
    number : ndarray, optional
        Numbers j of those that are asked for, (M,); all, if it is not given.

    Returns
    -------
    x, y : ndarray, shape (N,) or (M,)
        Positions, in the unit of `radius`.
    """
    j = np.arange(num) if number is None else number
    angle = 2 * np.pi * (j * _COARSE % 1 + j * _FINE)
    distance = radius * np.sqrt(j / max(num - 1, 1))
    return distance * np.cos(angle), distance * np.sin(angle)


@register_jitable
def aim(
    x: Coordinate, y: Coordinate, focus_distance: float
) -> tuple[Coordinate, Coordinate, Coordinate]:
    """Return unit vectors (vx, vy, vz) from points (x, y) of the objective to the focus above it.

    They do not depend on the height of the focus, as the objective moves with it.
    """
    length = np.sqrt(x * x + y * y + focus_distance * focus_distance)
    return -x / length, -y / length, focus_distance / length


def vogel_beam(
    rays: int, radius: float, focus_distance: float, only: NDArray[np.int64] | None = None
) -> Beam:
    """Return the beam of the thesis: a Vogel spiral on the objective, each ray of amplitude 1/N.

    Parameters
    ----------
    rays : int
        Number of rays, N.
    radius, focus_distance : float
        Of the objective's disk, and from it to the focus, µm.
    only : ndarray, optional
        Numbers of the rays that are asked for, in the order in which they shall stand.
    """
    x, y = vogel_spiral(rays, radius, only)
    if only is None:
        number = neighbourly_order(x, y)
        x, y = x[number], y[number]
    else:
        number = only
    vx, vy, vz = aim(x, y, focus_distance)
    return Beam(vx, vy, vz, np.full(number.size, 1 / rays), number)


def neighbourly_order(x: NDArray[np.float64], y: NDArray[np.float64]) -> NDArray[np.int64]:
    """Return an order of points of the aperture in which neighbours fare alike.

    The scene is symmetric in x and y, and a ray's ``|x|`` decides the most: strips of it, in them
    ``|y|``.
    The tree is traced faster that way; its result does not depend on the order.
    """
    strips = int(math.sqrt(x.size / 64)) + 1
    strip = np.floor(np.abs(x) * (strips / max(float(np.abs(x).max()), np.finfo(float).tiny)))
    return np.lexsort((np.abs(y), strip))
