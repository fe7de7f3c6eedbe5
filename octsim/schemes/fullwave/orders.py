"""How many partial waves and nodes a point takes: where to begin, how to go on, where to stop."""

import itertools
import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from octsim.schemes.cost import MOST_WAVENUMBERS, MOST_WAVES, partial_waves, wavenumbers
from octsim.schemes.fullwave.cylinder_on_plane import CylinderOnPlane

MOST_NODES = 400
"""Of each integral."""
MOST_MULTIPLICATIONS = 1e11
"""Complex ones of a point, between cylinder and plane: about a minute."""
_RESONANT = 1.1
"""Index over the water's above which resonances decide how many wavenumbers it takes."""


class Orders(NamedTuple):
    """Of the sums and integrals of one solution."""

    waves: int
    """Largest order M of the partial waves."""
    across: int
    """Nodes over k_x > 0."""
    contour: int
    """Nodes on half the contour of the coupling to the plane."""
    along: int
    """Nodes over k_y > 0."""

    def raised(self) -> "Orders":
        """Return the next orders to try, or to compare with."""
        waves = self.waves + 2 + math.ceil(0.6 * math.cbrt(self.waves))
        across, contour = (number + max(2, math.ceil(0.2 * number)) for number in self[1:3])
        # resonances along the cylinder make this integral the slowest to converge
        return Orders(waves, across, contour, self.along + max(3, math.ceil(0.35 * self.along)))

    @property
    def within_budget(self) -> bool:
        """Whether it is not more than is ever solved for."""
        return self.waves <= MOST_WAVES and max(self[1:]) <= MOST_NODES

    @property
    def size(self) -> int:
        """What the multiplications of a wavenumber go with."""
        return self.waves * self.contour * self.along


def first_orders(
    cylinders: Sequence[CylinderOnPlane], aperture: float, focus: float, largest_k: float,
    accuracy: float,
) -> Orders:  # fmt: skip
    """Return orders that are usually enough."""
    each = (_orders_of(one, aperture, focus, largest_k, accuracy) for one in cylinders)
    largest = Orders(*map(max, zip(*each, strict=True)))
    # the phase of what they send to each other turns the faster with k_y the farther they are apart
    turns = largest_k * apart(cylinders) * _behind(cylinders[0].n_water, aperture)
    return largest._replace(along=largest.along + math.ceil(0.55 * turns))


def _orders_of(
    scene: CylinderOnPlane, aperture: float, focus: float, largest_k: float, accuracy: float
) -> Orders:
    digits = -math.log10(accuracy)
    size = largest_k * scene.radius * scene.largest_index
    spread = abs(_defocus(scene, aperture, focus)) * largest_k
    sideways = largest_k * abs(scene.offset) * aperture
    # light from above is out of focus, most of all that of the rim
    from_above = max(largest_k * abs(_defocus_from_above(scene, aperture, focus)) - spread, 0.0)
    return Orders(
        math.ceil(partial_waves(size, digits)),
        math.ceil(3 + digits + 0.25 * (size + spread) + 0.5 * sideways + 1.1 * from_above),
        math.ceil(14 + size + 0.6 * math.sqrt(from_above)),
        math.ceil(2 + 0.75 * digits + 0.85 * size + 0.5 * spread + 0.9 * from_above),
    )  # fmt: skip


def apart(cylinders: Sequence[CylinderOnPlane]) -> float:
    """Return the largest distance between axes, µm; 0 of one cylinder."""
    return max(
        (
            math.hypot(one.offset - other.offset, one.height - other.height)
            for one, other in itertools.combinations(cylinders, 2)
        ),
        default=0.0,
    )


def waves_along(
    scene: CylinderOnPlane, along: NDArray[np.float64], k: NDArray[np.float64], waves: int
) -> NDArray[np.float64]:
    """Return the largest orders of light with components k_y / k (Y,) at wavenumbers (K,): (K, Y).

    As many beyond k a κ, in cube roots of it, as M is beyond the largest.
    """
    index = scene.largest_index
    size = scene.radius * k[:, np.newaxis] * np.sqrt(index**2 - along**2)
    largest = size.max()
    found: NDArray[np.float64] = size + (waves - largest) * np.cbrt(size / largest)
    return found


def radial_nodes(point_aperture: float, n_glass: float, focus: float, largest_k: float) -> int:
    """Return nodes over the pupil's radius that are always enough for the plane's own light."""
    depth = n_glass - math.sqrt(n_glass**2 - point_aperture**2)
    return math.ceil(30 + 1.2 * largest_k * abs(focus) * depth)


def _defocus(scene: CylinderOnPlane, aperture: float, focus: float) -> float:
    """Return by how much the optical path to the axis differs between the rim and the axis, µm."""
    in_glass = _behind(scene.n_glass, aperture)
    return (
        scene.height * _behind(scene.n_water, aperture) - focus * in_glass
        + sum(film.thickness * _behind(film.n.real, aperture) for film in scene.films)
    )  # fmt: skip


def _defocus_from_above(scene: CylinderOnPlane, aperture: float, focus: float) -> float:
    """Return the same of light that comes to the axis from the highest plane, µm; else 0."""
    if not scene.above:
        return 0.0
    further = 2 * (scene.room - scene.height) * _behind(scene.n_water, aperture)
    layers = (layer.thickness * _behind(layer.n.real, aperture) for layer in scene.above[:-1])
    return _defocus(scene, aperture, focus) + further + 2 * sum(layers)


def _behind(index: float, aperture: float) -> float:
    """Return by how much a layer's optical path is less for the rim, over its thickness."""
    return index - math.sqrt(max(index**2 - aperture**2, 0.0))


def first_nodes(
    cylinders: Sequence[CylinderOnPlane], aperture: float, focus: float,
    band: tuple[float, float], accuracy: float,
) -> int:  # fmt: skip
    """Return the wavenumbers in a band that are usually enough, for the first cylinder's middle."""
    scene = cylinders[0]
    # the plane's light of the pupil's rim is apart from that of the axis by the focus's distance
    rim = 2 * focus * (scene.n_glass - math.sqrt(scene.n_glass**2 - aperture**2))
    reach = max(scene.far_side, abs(rim - scene.far_side))
    if scene.above:
        # what goes to and fro below them is the farther the more digits are asked for
        reach *= 1 - 0.25 * math.log10(accuracy)
    reach += _later(cylinders)
    return _nodes(reach, band, accuracy) + 2 * bool(scene.shells)


def most_nodes(
    cylinders: Sequence[CylinderOnPlane], band: tuple[float, float], accuracy: float
) -> int:
    """Return the wavenumbers in a band that are not exceeded, whatever the focus."""
    scene = cylinders[0]
    if scene.largest_index > _RESONANT * scene.n_water:
        return MOST_WAVENUMBERS
    return min(
        MOST_WAVENUMBERS, 2 * _nodes(scene.far_side + _later(cylinders), band, accuracy) + 24
    )


def _later(cylinders: Sequence[CylinderOnPlane]) -> float:
    """Return the optical path by which what neighbours send to each other comes later, µm."""
    return 0.75 * cylinders[0].n_water * apart(cylinders)


def more_nodes(number: int, excess: float, fall: float) -> int:
    """Return by how many to raise a number of wavenumbers.

    Parameters
    ----------
    number : int
        So far.
    excess : float
        Error of what is left out, over the largest that is allowed.
    fall : float
        What three Chebyshev coefficients more make of it.
    """
    needed = 3 * math.log(max(3 * excess, 1.0)) / -math.log(fall)
    return math.ceil(min(max(needed, 3, number / 8), number / 2))


def _nodes(reach: float, band: tuple[float, float], accuracy: float) -> int:
    return math.ceil(wavenumbers(reach, band[1] - band[0], -math.log10(accuracy)))
