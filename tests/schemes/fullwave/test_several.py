"""Several cylinders beside treams, an image in a mirror, and each by itself."""

from math import inf
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.special import hankel1
from two_by_treams import OUTGOING

from octsim.base.errors import OctsimError
from octsim.optics.materials import Constant
from octsim.optics.pupil import GaussianPupil
from octsim.optics.scene import Cylinder, Plane, Region, Scene
from octsim.schemes.fullwave.cylinder_on_plane import CylinderOnPlane, Layer, cylinders_of
from octsim.schemes.fullwave.neighbours import (
    Between,
    Step,
    between,
    straight,
    through_planes,
    to_another,
    write,
)
from octsim.schemes.fullwave.operators import Operators
from octsim.schemes.fullwave.orders import Orders
from octsim.schemes.fullwave.several import _incoming, both_signs, in_blocks
from octsim.schemes.fullwave.shells import scattering_of
from octsim.schemes.fullwave.solve import Point, field_at, solve
from octsim.schemes.light import AccuracyStatus

ONE = CylinderOnPlane(1.52, 1.33, 1.39, 0.005, 0.8)
OTHER = CylinderOnPlane(1.52, 1.33, 1.45, 0.1, 0.5, 0.8)
K, PUPIL = np.array([8.0]), GaussianPupil(1.0)
ORDERS = Orders(14, 24, 36, 16)


def field_of(
    *scenes: CylinderOnPlane, orders: Orders = ORDERS, aperture: float = 1.0
) -> NDArray[Any]:
    """Return the field of planes, and of all with the cylinders, (3,)."""
    point = Point(scenes[0], PUPIL, aperture, 0.4, neighbours=scenes[1:])
    found = field_at(point, K, orders, 1e-14, Operators())
    return np.array([found.terms[0, 0, 0], *found.values[:, 0]])


def matrix_of(waves: Between, to: int, of: int) -> NDArray[Any]:
    """Return R of orders −M … M to, of orders −M′ … M′, (Y, 2 (2M + 1), 2 (2M′ + 1))."""
    found = np.empty((len(waves.by_sum), 2 * (2 * to + 1), 2 * (2 * of + 1)), complex)
    write(found, waves, to, of)
    return found


@pytest.mark.parametrize(("along", "light"), OUTGOING)
def test_cylinders_without_planes_are_those_of_treams(along: float, light: str) -> None:
    waves, at = 10, np.array([along])
    size = 2 * waves + 1
    each = (
        CylinderOnPlane(1.33, 1.33, 1.39, 0.0, 0.6),
        CylinderOnPlane(1.33, 1.33, 1.45, 0.25, 0.5, 0.8),
    )
    t = in_blocks([both_signs(scattering_of(one, at, K, waves).whole)[0] for one in each])[0]
    r = np.zeros((2, 2, size, 2, 2, size), complex)
    for to, of in ((0, 1), (1, 0)):
        sent = straight(Step(each[of], each[to]), at, 8.0, 2 * waves)
        none = np.zeros((1, 2, 2, 4 * waves + 1), complex)
        every = Between(none, none + np.eye(2)[..., np.newaxis] * sent)
        r[to, :, :, of] = matrix_of(every, waves, waves).reshape(2, size, 2, size)
    regular = np.zeros((2, 2, size), complex)
    regular[(0, 0, waves) if light == "first" else (1, 1, waves + 1)] = 1
    whole = np.eye(4 * size) - t @ r.reshape(4 * size, 4 * size)
    found = np.linalg.solve(whole, t @ regular.ravel()).reshape(2, 2, size)
    np.testing.assert_allclose(
        found[..., waves - 2 : waves + 3], OUTGOING[along, light], rtol=1e-8, atol=1e-12
    )


@pytest.mark.parametrize("across", [0.7, 3.0, -8.0])
def test_a_mirror_sends_what_an_image_would(across: float) -> None:
    # of a perfect conductor: E_y changes its sign, H_y does not
    mirror = ONE._replace(n_glass=1e9)
    step = Step(mirror, mirror._replace(offset=across, gap=0.2))
    along, waves = np.array([0.1, 0.8]), 6
    by = to_another(Step(step.of._replace(n_glass=1.52), step.to), along, 8.0, 2 * waves, 300)
    sent = matrix_of(through_planes(step, by, along, 8.0, 2 * waves), waves, waves)
    found = sent.reshape(2, 2, 2 * waves + 1, 2, 2 * waves + 1)
    kappa = 8.0 * np.sqrt(1.33**2 - along**2)
    up, order = step.of.height + step.to.height, np.arange(-waves, waves + 1)
    # H_m e^{imφ} of φ → −φ is (−1)^m times that of −m; then Graf's theorem from below the plane
    for row, one in enumerate(kappa):
        turn, distance = np.arctan2(up, across), np.hypot(up, across)
        apart = -order - order[:, np.newaxis]
        sent = hankel1(apart, one * distance) * np.exp(1j * apart * turn)
        sent = sent * np.where(order % 2, -1.0, 1.0)
        for part, sign in ((0, -1), (1, 1)):
            size = np.abs(sent).max()
            np.testing.assert_allclose(
                found[row, part, :, part] / size, sign * sent / size, rtol=0, atol=1e-7
            )


@pytest.mark.parametrize(
    "layers", [{}, {"films": (Layer(1.6, 0.2),), "room": 1.0, "above": (Layer(1.5, inf),)}]
)
def test_what_one_gets_is_what_the_other_would_by_the_mirrored_step(layers: Any) -> None:
    one, other = ONE._replace(**layers), OTHER._replace(**layers)
    along = np.array([0.1, 0.8])
    for of, to in ((one, other), (other, one)):
        step = Step(of, to)
        by = to_another(step, along, 8.0, 12, 200)
        there, back = between(step, by, along, 8.0, 12), between(Step(to, of), by, along, 8.0, 12)
        for a, b in zip(there.back(), back, strict=True):
            np.testing.assert_allclose(a, b, rtol=0, atol=1e-9 * np.abs(b).max())


@pytest.mark.parametrize(
    "layers",
    [{}, {"films": (Layer(1.6, 0.2),)}, {"room": 1.0, "above": (Layer(1.5, inf),)}],
)
def test_a_neighbour_without_contrast_is_none(layers: Any) -> None:
    one, other = ONE._replace(**layers), OTHER._replace(n_neuron=1.33, **layers)
    alone = field_of(one)
    np.testing.assert_allclose(field_of(one, other), alone, rtol=0, atol=1e-13)
    np.testing.assert_allclose(field_of(other, one), alone, rtol=0, atol=1e-13)


def test_a_scene_and_its_mirror_image_are_the_same() -> None:
    here = field_of(ONE, OTHER)
    there = field_of(ONE, OTHER._replace(offset=-0.8))
    np.testing.assert_allclose(there, here, rtol=0, atol=1e-13)
    assert np.abs(here - field_of(ONE)).max() > 1e-4


def test_weak_cylinders_add_up_but_for_what_they_send_to_each_other() -> None:
    fields = []
    for contrast in (2e-4, 2e-5):
        weak = ONE._replace(n_neuron=1.33 + contrast, gap=0.1)
        near, far = weak, weak._replace(offset=1.0)
        alone = field_of(near)[1:] + field_of(far)[1:] - 2 * field_of(near)[0]
        both = field_of(near, far)
        fields.append(np.abs(both[1:] - both[0] - alone).max() / np.abs(alone).max())
    assert fields[1] < 1e-4
    # what one sends to the other is of the second order
    assert fields[0] / fields[1] == pytest.approx(10, rel=0.02)


def test_two_that_are_far_apart_add_up() -> None:
    far = OTHER._replace(offset=25.0)
    orders = Orders(14, 90, 60, 30)
    alone = [field_of(one, orders=orders, aperture=0.5) for one in (ONE, far)]
    both = field_of(ONE, far, orders=orders, aperture=0.5)
    assert np.abs(both - (alone[0] + alone[1] - alone[0][0]))[1:].max() <= 1e-6


def test_doubled_orders_change_nothing() -> None:
    fine = field_of(ONE, OTHER, orders=Orders(16, 40, 60, 30))
    np.testing.assert_allclose(
        field_of(ONE, OTHER, orders=Orders(20, 60, 90, 45)), fine, rtol=0, atol=1e-11
    )


def test_its_error_is_within_what_it_says() -> None:
    point = Point(ONE, PUPIL, 1.0, 0.4, neighbours=(OTHER,))
    light = solve(point, (7.5, 8.5), 1e-3, Operators())
    assert light.status == AccuracyStatus.REACHED
    k = light.wavenumber[[1]]
    exact = field_at(point, k, Orders(18, 40, 60, 30), 1e-13, Operators()).values
    phase = np.exp(1j * k * light.optical_path_length)
    assert np.abs(light.values[:, [1]] * phase - exact).max() <= light.error


def test_cylinders_that_are_not_parallel_are_refused() -> None:
    glass, water, axon = (
        Region(name, Constant(n)) for name, n in (("glass", 1.52), ("water", 1.33), ("axon", 1.39))
    )
    plane, one = Plane("P", 0.0, glass, water), Cylinder("C", 0.0, 0.4, 0.4, axon, water)
    other = Cylinder("D", 1.0, 0.4, 0.4, Region("other", Constant(1.4)), water)
    found = cylinders_of(Scene(glass, (plane, one, other)))
    assert [round(cylinder.offset, 3) for cylinder in found] == [1.0, 0.0]
    turned = Cylinder("D", 1.0, 0.4, 0.4, axon, water, azimuth=0.1)
    with pytest.raises(OctsimError, match=r"cylinders\.1\.azimuth: not that of the first"):
        cylinders_of(Scene(glass, (plane, one, turned)))


def test_a_neighbour_that_is_far_away_is_solved_too() -> None:
    point = Point(ONE, PUPIL, 0.6, 0.4, neighbours=(OTHER._replace(offset=22.0),))
    light = solve(point, (7.5, 8.5), 1e-2, Operators())
    assert light.status == AccuracyStatus.REACHED
    assert np.isfinite(light.values).all()


@pytest.mark.parametrize("strength", [0.3, 0.9, 3.0])
def test_waves_are_those_of_a_dense_system_however_much_goes_to_and_fro(strength: float) -> None:
    drawn = np.random.default_rng(5)

    def random(*shape: int) -> NDArray[Any]:
        return drawn.normal(size=shape) + 1j * drawn.normal(size=shape)

    number, sizes = 2, (3, 5)
    whole, every = [random(number, 2, 2, size) for size in sizes], 2 * sum(sizes)
    t, begin = np.zeros((number, every, every), complex), 0
    for of, size in zip(whole, sizes, strict=True):
        for to, of_field, order in np.ndindex(2, 2, size):
            t[:, begin + to * size + order, begin + of_field * size + order] = of[
                :, to, of_field, order
            ]
        begin += 2 * size
    between, regular = random(number, every, every), random(2, number, every)
    between *= strength / np.abs(np.linalg.eigvals(t @ between)).max(axis=-1)[:, None, None]
    found, _ = _incoming(between, whole, regular, 1e-13)
    for place in range(number):
        system = np.eye(every) - between[place] @ t[place]
        expected = np.linalg.solve(system, regular[:, place].T).T
        np.testing.assert_allclose(
            found[:, place], expected, rtol=0, atol=1e-10 * np.abs(expected).max()
        )
