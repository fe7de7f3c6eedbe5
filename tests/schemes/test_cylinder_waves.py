"""Partial waves of a cylinder in oblique light: a literal reading beside another code's."""

from typing import NamedTuple

import numpy as np
import pytest
from line_beam import Polarisation, Slide, cylinder
from oblique_cylinder import wait
from peers.partial_waves_run import by_treams

from octsim.schemes.fullwave.cylinder import scattering
from octsim.schemes.fullwave.cylinder_on_plane import CylinderOnPlane

OUTSIDE = 1.33


class Case(NamedTuple):
    """A partial wave; lengths in µm."""

    k: float
    ky: float
    order: int
    radius: float
    inside: float


# by treams 0.4.7, which does not go with the scipy of the locks: `make bench-peers` has more
BY_TREAMS: list[tuple[Case, list[list[complex]]]] = [
    (
        Case(7.0, 0.0, 0, 0.6, 1.39),
        [[-0.05655208764482012+0.23098473765128383j, 0j],
         [0j, -0.06890471851478538+0.25329204148804846j]],
    ),
    (
        Case(8.0, 3.0, 1, 0.6, 1.39),
        [[-0.09630503791601516+0.29500622809836646j, 0.0008163760951311261+0.0005442967848920062j],
         [-0.0014440876746774182-0.000962806582795406j, -0.07243951104104815+0.25921096680117034j]],
    ),
    (
        Case(8.0, -3.0, 2, 0.6, 1.39),
        [[-0.07089566598862057+0.25653402738884146j, -0.004923078155589469-0.003090127533410307j],
         [0.008708432949422024+0.005466126593849375j, -0.08242914621451737+0.2749087462132687j]],
    ),
    (
        Case(8.0, 3.0, -2, 0.6, 1.39),
        [[-0.07089566598862057+0.25653402738884146j, -0.004923078155589469-0.003090127533410307j],
         [0.008708432949422024+0.005466126593849375j, -0.08242914621451737+0.2749087462132687j]],
    ),
    (
        Case(9.6, 11.04, 5, 2.0, 1.6),
        [[-0.932489402456345-0.19483429219850737j, -0.1156083318165269-0.027632578973513115j],
         [0.20449957815025424+0.0488792689462472j, -0.9738484452934695-0.021797604145922654j]],
    ),
    (
        Case(9.6, 2.9, 7, 4.0, 1.39),
        [[-0.5178206010564869-0.4996741741549063j, -6.835207061774837e-05-0.002144847550375272j],
         [0.00012090797771576936+0.003794020831859038j, -0.5140305133068491-0.4997949567930317j]],
    ),
    (
        Case(8.0, 9.2, 1, 0.6, 1.3),
        [[-0.061396778841652504-0.23774513983981324j, -0.022282012343229244+0.011308858513797834j],
         [0.03941465163393824-0.020004239825056943j, -0.04917690654013946-0.21366814346367244j]],
    ),
]  # fmt: skip


@pytest.mark.parametrize(("case", "matrix"), BY_TREAMS)
def test_a_cylinder_is_as_treams_has_it_with_the_signs_of_its_cross_terms(
    case: Case, matrix: list[list[complex]]
) -> None:
    found = wait(**case._asdict(), outside=OUTSIDE)
    np.testing.assert_allclose(found, matrix, rtol=0, atol=1e-12)


@pytest.mark.parametrize(
    ("case", "matrix"), [(case, matrix) for case, matrix in BY_TREAMS if case.order >= 0]
)
def test_scheme_fullwave_scatters_as_treams_does_with_the_signs_of_its_cross_terms(
    case: Case, matrix: list[list[complex]]
) -> None:
    scene = CylinderOnPlane(1.52, OUTSIDE, case.inside, 0.005, 2 * case.radius)
    along, k = np.array([case.ky / case.k]), np.array([case.k])
    whole = scattering(scene, along, k, case.order + 20).whole[..., 0, 0, case.order]
    np.testing.assert_allclose(whole, matrix, rtol=0, atol=1e-12)


@pytest.mark.parametrize("case", [case for case, _ in BY_TREAMS])
def test_a_cylinder_is_as_the_installed_treams_has_it(case: Case) -> None:
    pytest.importorskip("treams", exc_type=ImportError)
    found = np.array(by_treams({**case._asdict(), "outside": OUTSIDE}))
    matrix = found[..., 0] + 1j * found[..., 1]
    np.testing.assert_allclose(wait(**case._asdict(), outside=OUTSIDE), matrix, rtol=0, atol=1e-12)


def test_cross_terms_change_sign_with_the_direction_along_the_axis() -> None:
    there, back = (wait(8, ky, 2, 0.6, OUTSIDE, 1.39) for ky in (3.0, -3.0))
    assert abs(there[0, 1]) > 1e-3
    np.testing.assert_allclose(there * [[1, -1], [-1, 1]], back, rtol=0, atol=1e-14)


def test_light_at_right_angles_keeps_its_polarisation() -> None:
    slide, order = Slide(), np.arange(-5, 6)
    oblique = np.array([wait(8, 0, m, 0.6, slide.water, slide.neuron) for m in order.tolist()])
    np.testing.assert_array_equal(oblique[:, [0, 1], [1, 0]], 0)
    lights: tuple[Polarisation, ...] = ("along", "across")
    for i, light in enumerate(lights):
        straight = cylinder(slide, 8, order, light)
        np.testing.assert_allclose(oblique[:, i, i], straight, rtol=0, atol=1e-13)
