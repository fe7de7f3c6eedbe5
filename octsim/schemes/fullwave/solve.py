"""The field of one point to an accuracy: solved, compared with itself, and solved better."""

import math
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from octsim.optics.pupil import Pupil
from octsim.schemes.cost import MOST_WAVENUMBERS
from octsim.schemes.field_sum import relative_error
from octsim.schemes.fullwave.cylinder_on_plane import CylinderOnPlane
from octsim.schemes.fullwave.detection import collected, norm, plane_return
from octsim.schemes.fullwave.illumination import Wavefront, illumination
from octsim.schemes.fullwave.operators import Operators
from octsim.schemes.fullwave.orders import (
    MOST_MULTIPLICATIONS,
    Orders,
    first_nodes,
    first_orders,
    more_nodes,
    most_nodes,
    radial_nodes,
)
from octsim.schemes.fullwave.scatter import incoming, scattered
from octsim.schemes.fullwave.series import coefficients, nodes
from octsim.schemes.fullwave.several import Collected, Lights, several
from octsim.schemes.light import TERMS, AccuracyStatus, Waves

Array = NDArray[Any]
_CHECKED = 3
"""Wavenumbers at which a solution is compared with one of raised orders."""
_LAST, _BEFORE = slice(-3, None), slice(-6, -3)
"""Chebyshev coefficients that tell of those left out."""

_ROUNDING = 2e-14
"""Error over the field's size below which more orders bring nothing."""
_OF_TABLES = 0.2
"""Phase that tables may leave out, over the accuracy."""
_MORE_NODES = 1.5
"""Factor on the wavenumbers where a table of indices is no polynomial through them."""


class Place(NamedTuple):
    """A scene and the height of the focus (µm), at one wavenumber."""

    scene: CylinderOnPlane
    focus: float
    neighbours: tuple[CylinderOnPlane, ...] = ()
    """Other cylinders, among the same planes."""


class Point(NamedTuple):
    """What a field is asked for."""

    scene: CylinderOnPlane
    """At the middle of the band."""
    pupil: Pupil
    aperture: float
    """Numerical aperture."""
    focus: float
    """Height of the focus at the middle of the band, µm."""
    place_at: Callable[[float], Place] | None = None
    """Returns scene and focus at a wavenumber, 1/µm, where they depend on it."""
    wavefront: Wavefront | None = None
    """Aberration of the pupil, in the frame of the cylinder."""
    left_out: Callable[[int], float] = lambda _: 0.0
    """Returns how far phases are off by tables of indices, for a number of wavenumbers."""
    neighbours: tuple[CylinderOnPlane, ...] = ()
    """Other cylinders, among the same planes, at the middle of the band."""


class Solved(NamedTuple):
    """The field at K wavenumbers."""

    values: Array
    """(2, K)."""
    terms: Array
    """(3, 2, K)."""
    multiplications: float
    """Complex ones that it took, about."""


def field_at(
    point: Point, k: NDArray[np.float64], orders: Orders, tolerance: float, operators: Operators
) -> Solved:
    """Return the detected field at some wavenumbers, by sums of some orders.

    Parameters
    ----------
    point : Point
    k : ndarray, shape (K,)
        Wavenumbers, 1/µm.
    orders : Orders
    tolerance : float
        Of the multiple scattering between cylinder and plane.
    operators : Operators
        Those kept.
    """
    if point.place_at is None:
        return _field_in_place(point, k, orders, tolerance, operators)
    each = []
    for at in k:
        here = point._replace(**point.place_at(float(at))._asdict())
        each.append(_field_in_place(here, np.array([at]), orders, tolerance, operators))
    return Solved(
        np.concatenate([one.values for one in each], axis=-1),
        np.concatenate([one.terms for one in each], axis=-1),
        sum(one.multiplications for one in each),
    )


def _field_in_place(
    point: Point, k: NDArray[np.float64], orders: Orders, tolerance: float, operators: Operators
) -> Solved:
    """Return the field of a scene and a focus that are the same at all of some wavenumbers."""
    scene, pupil, aperture, focus = point[:4]
    if point.neighbours:
        lights = Lights(pupil, aperture, focus, point.wavefront)
        found = several((scene, *point.neighbours), lights, k, orders, tolerance, operators)
    else:
        found = _of_one(point, k, orders, tolerance, operators)
    radial = radial_nodes(aperture, scene.n_glass, abs(focus) + scene.depth, float(k.max()))
    cylinders = found.terms / (norm(pupil, aperture, k, radial) * 4 * np.pi * scene.n_glass)
    plane = plane_return(scene, pupil, aperture, focus, k, radial, point.wavefront)
    both = np.broadcast_to(plane, (2, k.size))
    terms = np.stack((both, cylinders[1], cylinders[2]))
    return Solved(plane + cylinders[0], terms, found.multiplications)


def _of_one(
    point: Point, k: NDArray[np.float64], orders: Orders, tolerance: float, operators: Operators
) -> Collected:
    """Return what the detector collects of a cylinder by itself."""
    scene, pupil, aperture, focus = point[:4]
    operator = operators.of(scene, aperture, k, orders)
    lights = illumination(
        scene, pupil, aperture, focus, operator.along, k, orders.waves, orders.across,
        point.wavefront,
    )  # fmt: skip
    cylinder = np.zeros((len(operator.cylinder), 2, k.size), np.complex128)
    multiplications = 0.0
    for lit in lights:
        e, h, taken = incoming(operator, lit, tolerance)
        multiplications += taken
        for term, matrix in enumerate(operator.cylinder):
            density = collected(lit, *scattered(matrix, e, h), scene.n_water, operator.along)
            cylinder[term, lit.polarisation] += (density * operator.along_weight).sum(axis=1)
    return Collected(cylinder, multiplications)


def solve(point: Point, band: tuple[float, float], accuracy: float, operators: Operators) -> Waves:
    """Return the detected field of a point over a band, to an accuracy.

    The error is estimated from a solution of raised orders at three wavenumbers, and from the last
    Chebyshev coefficients over the wavenumber. Orders and wavenumbers are raised until it is within
    the accuracy, or beyond what a point may take, in which case the last one is returned.

    Parameters
    ----------
    point : Point
    band : (float, float)
        Smallest and largest wavenumber, 1/µm.
    accuracy : float
        Largest error of the intensity over the largest intensity.
    operators : Operators
        Where those are kept that several points share.
    """
    scene, _, aperture, focus = point[:4]
    cylinders = scene, *point.neighbours
    orders = first_orders(cylinders, aperture, focus, band[1], accuracy)
    number = first_nodes(cylinders, aperture, focus, band, accuracy)
    most = most_nodes(cylinders, band, accuracy)
    if point.left_out(number) > 0:
        # a table turns at its rows, maybe between wavenumbers that are too far apart to see it;
        # beyond the most, nothing is solved, and the status says so
        most = MOST_WAVENUMBERS
        while number <= most and point.left_out(number) > _OF_TABLES * accuracy:
            number = math.ceil(_MORE_NODES * number)
    removed = removed_path(scene, focus)
    best, checked, by_orders, spent, next_one = None, None, np.inf, 0.0, 0.0
    while orders.within_budget and number <= most and spent + next_one <= MOST_MULTIPLICATIONS:
        k = nodes(band, number)
        found = field_at(point, k, orders, 1e-3 * accuracy, operators)
        if orders != checked:
            check = np.unique(np.linspace(0, number - 1, _CHECKED).round().astype(int))
            finer = field_at(point, k[check], orders.raised(), 1e-4 * accuracy, operators)
            by_orders = 2 * float(np.abs(finer.values - found.values[:, check]).max())
            checked = orders
        slow = np.exp(-1j * k * removed)
        by_nodes, fall = left_out(np.abs(coefficients(found.values * slow)))
        largest = float(np.sqrt((np.abs(found.values) ** 2).mean(axis=0).max()))
        error = by_orders + by_nodes + point.left_out(number) * largest
        reached = relative_error(largest, error) <= accuracy
        status = AccuracyStatus.REACHED if reached else AccuracyStatus.BUDGET_SPENT
        best = Waves(
            k, found.values * slow, found.terms * slow, removed, 0.0, error, orders.waves, status
        )
        if reached or error < _ROUNDING * largest:
            return best
        spent += found.multiplications
        per_size = found.multiplications / (number * orders.size)
        if by_orders > by_nodes / 2:
            orders = orders.raised()
        if by_nodes > by_orders / 2:
            allowed = accuracy * largest / 2
            more = number + more_nodes(number, by_nodes / allowed, fall)
            number = most if number < most < more else more
        next_one = per_size * number * orders.size
    if best is not None:
        return best
    k = nodes(band, 1)
    nothing = np.full((2, 1), np.nan + 0j)
    return Waves(
        k, nothing, np.stack([nothing] * len(TERMS)), removed, 0.0, np.inf, orders.waves,
        AccuracyStatus.BUDGET_SPENT,
    )  # fmt: skip


def left_out(series: NDArray[np.float64]) -> tuple[float, float]:
    """Return what Chebyshev coefficients (N, 2) say of those after them, in size, and their fall.

    The last three, and as many times more as they fall slowly: by resonances of a large cylinder.
    The fall is what three coefficients more make of it.
    """
    last, before = (series[part].sum(axis=0) for part in (_LAST, _BEFORE))
    fall = np.clip(last / np.maximum(before, last), 1 / 3, 0.95)
    left = 2 * last * fall / (1 - fall)
    worst = int(left.argmax())
    return float(left[worst]), float(fall[worst])


def removed_path(scene: CylinderOnPlane, focus: float) -> float:
    """Return the optical path whose phase is taken out of the field, µm.

    It is midway between the plane's and the far side's, so that the rest is as smooth as can be.
    """
    return -2 * scene.n_glass * focus + scene.far_side
