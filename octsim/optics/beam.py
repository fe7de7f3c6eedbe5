"""The light that leaves the objective: where rays start on its disk, and where they head."""

import math
from typing import NamedTuple, TypeVar

import numpy as np
from numba.extending import register_jitable
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


def aperture_radius(numerical_aperture: float, index: float, focus_distance: float) -> float:
    """Return the radius of the objective's disk, focus_distance · tan(asin(NA / n)), in µm.

    As NA / √((n − NA)(n + NA)) the tangent keeps its digits where NA is close to the index n of the
    medium that the objective lies in.
    """
    cosine = math.sqrt((index - numerical_aperture) * (index + numerical_aperture))
    return focus_distance * (numerical_aperture / cosine)


def vogel_spiral(num: int, radius: float) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
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

    Returns
    -------
    x, y : ndarray, shape (N,)
        Positions, in the unit of `radius`.
    """
    j = np.arange(num)
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


def vogel_beam(rays: int, radius: float, focus_distance: float) -> Beam:
    """Return the beam of the thesis: a Vogel spiral on the objective, each ray of amplitude 1/N.

    Parameters
    ----------
    rays : int
        Number of rays, N.
    radius, focus_distance : float
        Of the objective's disk, and from it to the focus, µm.
    """
    x, y = vogel_spiral(rays, radius)
    number = neighbourly_order(x, y)
    vx, vy, vz = aim(x[number], y[number], focus_distance)
    return Beam(vx, vy, vz, np.full(rays, 1 / rays), number)


def neighbourly_order(x: NDArray[np.float64], y: NDArray[np.float64]) -> NDArray[np.int64]:
    """Return an order of points of the aperture in which neighbours fare alike.

    The scene is symmetric in x and y, and a ray's |x| decides the most: strips of |x|, in them |y|.
    The tree is traced faster that way; its result does not depend on the order.
    """
    strips = int(math.sqrt(x.size / 64)) + 1
    strip = np.floor(np.abs(x) * (strips / max(float(np.abs(x).max()), np.finfo(float).tiny)))
    return np.lexsort((np.abs(y), strip))
