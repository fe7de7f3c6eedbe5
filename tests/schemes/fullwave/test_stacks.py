"""Stacks of planes around a cylinder beside matrices of layers, dense rules, and one plane."""

from math import inf
from typing import Any

import numpy as np
import pytest
from dense_scenes import Layered, field_by, layer_matrices
from dense_waves import Beam, Rules
from numpy.typing import NDArray

from octsim.optics.layered import plates
from octsim.optics.materials import Constant
from octsim.optics.pupil import GaussianPupil, UniformPupil
from octsim.optics.scene import Cylinder, Plane, Region, Scene
from octsim.schemes.fullwave.cylinder_on_plane import CylinderOnPlane, Layer, cylinder_on_plane
from octsim.schemes.fullwave.detection import collected
from octsim.schemes.fullwave.illumination import illumination
from octsim.schemes.fullwave.operators import Operators, operator
from octsim.schemes.fullwave.orders import Orders, first_orders
from octsim.schemes.fullwave.plates import solve_plates, stack_of
from octsim.schemes.fullwave.scatter import incoming, scattered
from octsim.schemes.fullwave.slab import at, returned, returned_matrices
from octsim.schemes.fullwave.solve import Point, field_at, solve
from octsim.schemes.fullwave.stacks import through
from octsim.schemes.light import AccuracyStatus

PLAIN = CylinderOnPlane(1.52, 1.33, 1.39, 0.005, 1.2)
PUPIL = GaussianPupil(1.0)
K = np.array([8.0])
BAND = 2e3 * np.pi / 900, 2e3 * np.pi / 650
COVER = (Layer(1.52, inf),)


def field_of(scene: CylinderOnPlane, orders: Orders | None = None) -> NDArray[Any]:
    found = first_orders((scene,), 1.2, 0.75, 8.0, 1e-10)
    fine = Orders(found.waves + 4, *(3 * number for number in found[1:]))
    return field_at(Point(scene, PUPIL, 1.2, 0.75), K, orders or fine, 1e-14, Operators()).values


@pytest.mark.parametrize("contour", [False, True])
@pytest.mark.parametrize(
    ("indices", "thickness"),
    [
        ((1.52, 1.33), ()),
        ((1.33, 1.6, 1.2, 1.52), (0.3, 0.7)),
        ((1.52, 1.4 + 0.1j, 1.33, 1.0), (0.2, 5.0)),
    ],
)
def test_a_stack_is_what_matrices_of_layers_give(
    indices: Any, thickness: Any, contour: bool
) -> None:
    rho = np.linspace(0.01, 1.25, 40)
    squared = (rho * np.exp(-0.7j * rho)) ** 2 if contour else rho**2 + 0j
    found = through(indices, thickness, squared, np.array(8.0))
    expected = layer_matrices(list(indices), list(thickness), squared, 8.0)
    for one, other in zip((*found.reflected, *found.passed), expected, strict=True):
        np.testing.assert_allclose(one, other, rtol=1e-12, atol=1e-14)


def test_a_stack_keeps_energy() -> None:
    rho = np.linspace(0, 1.3, 30)
    found = through((1.52, 1.6, 1.2, 1.33), (0.3, 0.7), rho**2 + 0j, np.array(8.0))
    first, last = (np.sqrt(n**2 - rho**2) for n in (1.52, 1.33))
    for kind, flux in ((0, last / first), (1, (last / 1.33**2) / (first / 1.52**2))):
        whole = np.abs(found.reflected[kind]) ** 2 + flux * np.abs(found.passed[kind]) ** 2
        np.testing.assert_allclose(whole, 1, rtol=0, atol=1e-13)


@pytest.mark.parametrize(
    "layers",
    [
        {"films": (Layer(1.52, 0.3),)},
        {"films": (Layer(1.52, 0.3), Layer(1.52, 0.2))},
        {"films": (Layer(1.33, 0.2),)},
        {"room": 2.0, "above": (Layer(1.33, inf),)},
        {"room": 1.3, "above": (Layer(1.33, 0.4), Layer(1.33, inf))},
        {"films": (Layer(1.52, 0.1),), "room": 2.0, "above": (Layer(1.33, inf),)},
    ],
)
def test_planes_between_equal_media_are_none(layers: Any) -> None:
    scene = PLAIN._replace(**layers)
    # a film is between the plane z = 0 and the water
    below = sum(film.thickness for film in scene.films)
    water = below if below and scene.films[0].n == 1.33 else 0.0
    alone = PLAIN._replace(gap=PLAIN.gap + water)
    orders = Orders(22, 40, 80, 60)
    point = Point(alone, PUPIL, 1.2, 0.75 - (below - water))
    expected = field_at(point, K, orders, 1e-15, Operators()).values
    if below and not water:
        # the plane is higher by it, and light takes as much longer
        fields = field_of(scene, orders), expected
        assert np.abs(np.abs(fields[0]) - np.abs(fields[1])).max() <= 1e-12
    np.testing.assert_allclose(field_of(scene, orders), expected, rtol=0, atol=1e-12)


@pytest.mark.parametrize(
    "layered",
    [
        Layered(1.52, 1.33, 1.39, 0.005, 0.6, 0.2, ((1.44, 0.1), (1.4, 0.05))),
        Layered(1.52, 1.33, 1.39, 0.005, 0.6, 0.0, (), ((1.6, 0.2), (1.45 + 0.1j, 0.3))),
        Layered(1.52, 1.33, 1.39, 0.005, 0.6, 0.1, (), (), 0.7, ((1.52, inf),)),
        Layered(
            1.5, 1.34, 1.45, 0.1, 0.5, 0.1, ((1.44, 0.1),), ((1.58, 0.1),), 0.6,
            ((1.5, 0.2), (1.0, inf)),
        ),
    ],
)  # fmt: skip
def test_it_is_that_of_dense_rules(layered: Layered) -> None:
    beam = Beam(PUPIL, 0.9, 0.4)
    scene = scene_in_numbers(layered)
    orders = first_orders((scene,), 0.9, 0.4, 8.0, 1e-10)
    orders = Orders(orders.waves + 4, *(3 * number for number in orders[1:]))
    found = field_at(Point(scene, PUPIL, 0.9, 0.4), K, orders, 1e-13, Operators()).values
    expected = field_by(layered, beam, K, Rules(5, 40, 16, 110, 60))
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-9)


def scene_in_numbers(layered: Layered) -> CylinderOnPlane:
    shells, films, above = (
        tuple(Layer(*one) for one in layers)
        for layers in (layered.shells, layered.films, layered.above)
    )
    return CylinderOnPlane(
        layered.n_glass, layered.n_water, layered.n_neuron.real, layered.gap, layered.diameter,
        layered.offset, 0.0, shells, films, layered.room, above,
    )  # fmt: skip


LAYERED = PLAIN._replace(
    offset=0.1, shells=(Layer(1.44, 0.1),), films=(Layer(1.58, 0.1),), room=1.5,
    above=(Layer(1.5, 0.2), Layer(1.0, inf)),
)  # fmt: skip


def test_light_there_and_back_is_the_same() -> None:
    op = operator(LAYERED, 1.2, K, Orders(22, 60, 80, 40))
    lights = [
        illumination(LAYERED, pupil, 1.2, focus, op.along, K, 22, 60)
        for pupil, focus in ((PUPIL, 0.75), (UniformPupil(), -0.4))
    ]
    for one, other in zip(*lights, strict=True):
        there, back = (
            collected(
                to, *scattered(op.cylinder.whole, *incoming(op, of, 1e-16)[:2]), 1.33, op.along
            )
            for to, of in ((one, other), (other, one))
        )
        assert np.abs(there - back).max() <= 1e-10 * np.abs(there).max()


@pytest.mark.parametrize("mirror", [0, 1])
def test_its_matrices_are_what_it_does(mirror: int) -> None:
    op = operator(LAYERED, 1.2, K, Orders(12, 20, 60, 5))
    waves_of = op.mirrors[mirror]
    generator = np.random.default_rng(3)
    size = 4.0 ** -np.arange(13)
    e, h = (size * (generator.normal(size=(1, 5, 13)) + 1j) for _ in range(2))
    (ee, eh), (he, hh) = returned_matrices(at(op.plane, 0), waves_of, mirror)
    found = returned(op.plane, e, h, waves_of, mirror)
    for one, of_e, of_h in zip(found, (ee, he), (eh, hh), strict=True):
        expected = of_e @ e[0][..., np.newaxis] + of_h @ h[0][..., np.newaxis]
        np.testing.assert_allclose(one[0], expected[..., 0], rtol=1e-12, atol=1e-15)


def test_without_contrast_only_planes_return_light_as_plates_have_it() -> None:
    glass, film, water, cover = (
        Region(name, Constant(n))
        for name, n in (("glass", 1.52), ("film", 1.6), ("water", 1.33), ("cover", 1.5))
    )
    stack = plates((glass, film, water, cover), (0.0, 0.2, 2.2))
    expected = solve_plates(lambda k: (stack_of(stack, k), 0.75), PUPIL, 1.2, BAND, 1e-6)
    scene = PLAIN._replace(
        n_neuron=1.33, films=(Layer(1.6, 0.2),), room=2.0, above=(Layer(1.5, inf),)
    )
    k = expected.wavenumber[[0, 5]]
    orders = Orders(12, 20, 20, 20)
    found = field_at(Point(scene, PUPIL, 1.2, 0.75), k, orders, 1e-9, Operators()).values
    phase = np.exp(1j * k * expected.optical_path_length)
    np.testing.assert_allclose(found, (expected.values[:, [0, 5]] * phase), rtol=0, atol=1e-7)


def test_a_scene_is_read_from_below_and_from_outside() -> None:
    glass, film, water, cover, axon, myelin = (
        Region(name, Constant(n))
        for name, n in (
            ("glass", 1.52), ("film", 1.6), ("water", 1.33), ("cover", 1.5), ("axon", 1.39),
            ("myelin", 1.44),
        )
    )  # fmt: skip
    scene = Scene(glass, (
        Plane("P", 0.0, glass, film), Plane("Q", 0.2, film, water), Plane("S", 2.2, water, cover),
        Plane("U", 2.5, cover, glass),
        Cylinder("C", 0.1, 0.805, 0.6, myelin, water), Cylinder("D", 0.1, 0.805, 0.5, axon, myelin),
    ))  # fmt: skip
    found = cylinder_on_plane(scene)
    assert found.gap == pytest.approx(0.005)
    assert (found.diameter, found.offset, found.n_neuron) == (1.2, 0.1, 1.39)
    assert found.films == (Layer(1.6, 0.2),)
    assert found.room == 2.0
    np.testing.assert_allclose(found.shells, [(1.44, 0.1)])
    np.testing.assert_allclose(found.above, [(1.5, 0.3), (1.52, inf)])


@pytest.mark.parametrize("accuracy", [1e-2, 1e-5])
@pytest.mark.parametrize(
    "scene",
    [
        PLAIN._replace(shells=(Layer(1.44, 0.1),)),
        PLAIN._replace(films=(Layer(1.6, 0.3),)),
        PLAIN._replace(room=1.6, above=COVER),
    ],
)
def test_its_error_is_within_what_it_says(scene: CylinderOnPlane, accuracy: float) -> None:
    point = Point(scene, PUPIL, 1.2, 0.75)
    light = solve(point, BAND, accuracy, Operators())
    assert light.status == AccuracyStatus.REACHED
    k = light.wavenumber[[0, 3, -1]]
    exact = field_at(point, k, Orders(24, 90, 80, 70), 1e-14, Operators()).values
    phase = np.exp(1j * k * light.optical_path_length)
    assert np.abs(light.values[:, [0, 3, -1]] * phase - exact).max() <= light.error


def test_a_cylinder_that_touches_a_plane_is_above_it() -> None:
    glass, film, water, axon = (
        Region(name, Constant(n))
        for name, n in (("glass", 1.52), ("film", 1.6), ("water", 1.33), ("axon", 1.39))
    )
    for height in np.linspace(0.1, 0.9, 50).tolist():
        planes = Plane("P", 0.0, glass, film), Plane("Q", height, film, water)
        cylinder = Cylinder("C", 0.0, height + 0.37, 0.37, axon, water)
        found = cylinder_on_plane(Scene(glass, (*planes, cylinder)))
        assert (len(found.films), found.above) == (1, ())
        assert abs(found.gap) < 1e-15
