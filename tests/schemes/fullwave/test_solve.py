"""The field of a point: anchors, the Born limit, reciprocity, dense rules, extremes."""

from functools import cache
from typing import Any

import numpy as np
import pytest
from born import born_return
from dense_waves import Beam, Slide, dense_waves
from numpy.typing import NDArray

from octsim.optics.pupil import FibrePupil, GaussianPupil, Pupil, UniformPupil
from octsim.schemes.fullwave import solve as solving
from octsim.schemes.fullwave.cylinder_on_plane import CylinderOnPlane
from octsim.schemes.fullwave.detection import collected
from octsim.schemes.fullwave.illumination import illumination
from octsim.schemes.fullwave.operators import Operators, operator
from octsim.schemes.fullwave.orders import Orders, first_orders
from octsim.schemes.fullwave.scatter import incoming, scattered
from octsim.schemes.fullwave.series import over_band
from octsim.schemes.fullwave.solve import Point, field_at, solve
from octsim.schemes.light import AccuracyStatus, Waves

SCENE = CylinderOnPlane(1.52, 1.33, 1.39, 0.005, 1.2)
PUPIL = GaussianPupil(1.0)
POINT = Point(SCENE, PUPIL, 1.2, 0.75)
K = np.array([8.0])
ORDERS = Orders(22, 30, 60, 40)
BAND = 2e3 * np.pi / 900, 2e3 * np.pi / 650


def field_of(point: Point, orders: Orders = ORDERS, k: NDArray[Any] = K) -> NDArray[Any]:
    """Return the field of the plane, and of the cylinder alone across and along, (3, K)."""
    found = field_at(point, k, orders, 1e-15, Operators())
    return np.stack([found.terms[0, 0], *(found.values - found.terms[0])])


def test_it_is_what_two_codes_found() -> None:
    plane, across, along = field_of(POINT)[:, 0]
    # all digits that are given, and no more
    assert complex(across) == pytest.approx(0.023981302 + 0.000016401j, abs=7e-10)
    assert complex(along) == pytest.approx(0.025506624 + 0.000770928j, abs=7e-10)
    assert complex(plane) == pytest.approx(-0.003911306 + 0.023199367j, abs=7e-10)


def test_off_the_axis_it_is_what_another_code_found() -> None:
    _, across, along = field_of(POINT._replace(scene=SCENE._replace(offset=0.25)))[:, 0]
    assert complex(across) == pytest.approx(0.000481787 - 0.000128975j, abs=7e-10)
    assert complex(along) == pytest.approx(0.001808303 + 0.000496714j, abs=7e-10)


@pytest.mark.parametrize("diameter", [1.2, 3.0])
def test_doubled_orders_change_nothing(diameter: float) -> None:
    point = POINT._replace(scene=SCENE._replace(diameter=diameter), focus=0.6 * diameter)
    waves = 22 if diameter == 1.2 else 36
    # waves beyond those that scatter are rounding; what is doubled is the nodes
    fine = field_of(point, Orders(waves, 40, 80, 60))
    finer = field_of(point, Orders(waves + 4, 80, 160, 120))
    np.testing.assert_allclose(finer, fine, rtol=0, atol=1e-13)


@pytest.mark.parametrize("offset", [0.0, 0.3])
def test_light_there_and_back_is_the_same(offset: float) -> None:
    scene = SCENE._replace(offset=offset)
    op = operator(scene, 1.2, K, ORDERS)
    lights = [
        illumination(scene, pupil, 1.2, focus, op.along, K, ORDERS.waves, ORDERS.across)
        for pupil, focus in ((PUPIL, 0.75), (UniformPupil(), -0.4))
    ]
    for one, other in zip(*lights, strict=True):
        there, back = (
            collected(
                to, *scattered(op.cylinder.whole, *incoming(op, of, 1e-16)[:2]), 1.33, op.along
            )
            for to, of in ((one, other), (other, one))
        )
        assert np.abs(there - back).max() <= 1e-12 * np.abs(there).max()


@cache
def born_of_a_weak_one(offset: float) -> NDArray[Any]:
    slide = Slide(*SCENE._replace(n_neuron=1.34, offset=offset)[:6])
    return born_return(slide, Beam(PUPIL, 1.2, 0.75), 8.0)


@pytest.mark.parametrize("offset", [0.0, 0.25])
def test_weak_contrast_scatters_as_born_has_it(offset: float) -> None:
    off = []
    on_axis = born_of_a_weak_one(0.0)
    for contrast in (2e-4, 2e-5):
        scene = SCENE._replace(n_neuron=SCENE.n_water + contrast, offset=offset)
        found = field_of(POINT._replace(scene=scene))[1:, 0]
        # Born's light goes with the difference of the squares of the indices
        squares = scene.n_neuron**2 - SCENE.n_water**2
        born = born_of_a_weak_one(offset) * squares / (1.34**2 - SCENE.n_water**2)
        # off the axis much of it cancels
        size = np.abs(on_axis) * (contrast / 0.01)
        assert (np.abs(found - born) <= 25 * contrast * size).all()
        off.append(np.abs(found / born - 1))
    # what Born leaves out is linear in the contrast
    np.testing.assert_allclose(off[0] / off[1], 10, rtol=0.01)


def test_without_contrast_the_cylinder_returns_exactly_nothing() -> None:
    scene = SCENE._replace(n_neuron=SCENE.n_water, offset=0.1)
    assert (field_of(POINT._replace(scene=scene))[1:] == 0).all()


def test_without_a_plane_the_cylinder_is_alone() -> None:
    scene = SCENE._replace(n_glass=SCENE.n_water)
    plane, *_ = field_of(POINT._replace(scene=scene))[:, 0]
    assert plane == 0
    op = operator(scene, 1.2, K, ORDERS)
    assert max(float(np.abs(part).max()) for part in op.plane) <= 1e-13


@pytest.mark.parametrize(
    ("slide", "aperture", "focus", "pupil"),
    [
        (Slide(1.52, 1.33, 1.39, 0.2, 4.0, 0.5), 1.28, -2.0, FibrePupil(5.0, 20.0)),
        (Slide(1.52, 1.33, 2.0, 0.0, 1.0), 1.2, 0.5, UniformPupil()),
        (Slide(1.45, 1.36, 1.2, 0.05, 1.5, 0.2), 1.3, 0.5, UniformPupil()),
        (Slide(1.3, 1.36, 1.5, 0.0, 1.5, 0.2), 1.1, 2.0, GaussianPupil(0.5)),
    ],
)  # fmt: skip
def test_it_is_that_of_dense_rules(
    slide: Slide, aperture: float, focus: float, pupil: Pupil
) -> None:
    scene = CylinderOnPlane(*slide)
    orders = first_orders((scene,), aperture, focus, 8.0, 1e-10)
    orders = Orders(orders.waves + 4, *(5 * number for number in orders[1:]))
    found = field_at(Point(scene, pupil, aperture, focus), K, orders, 1e-13, Operators()).values
    dense = dense_waves(slide, Beam(pupil, aperture, focus), K)
    assert dense.error <= 1e-9
    np.testing.assert_allclose(found, dense.field, rtol=0, atol=2e-9)


def solved(scene: CylinderOnPlane, accuracy: float = 1e-4, **other: Any) -> Waves:
    """Return the field of a point over the band."""
    asked = {"aperture": 1.2, "focus": 0.58 * scene.diameter, **other}
    point = Point(scene, PUPIL, asked["aperture"], asked["focus"])
    return solve(point, BAND, accuracy, Operators())


@pytest.mark.parametrize("accuracy", [1e-2, 1e-6, 1e-10])
def test_its_error_is_within_what_it_says(accuracy: float) -> None:
    light, k = solved(SCENE, accuracy), np.linspace(*BAND, 5)
    exact = field_at(POINT._replace(focus=0.58 * 1.2), k, ORDERS, 1e-15, Operators()).values
    assert light.status == AccuracyStatus.REACHED
    assert np.abs(over_band(light, light.values, k) - exact).max() <= light.error


def test_a_table_of_indices_is_met_by_as_many_wavenumbers_as_see_it() -> None:
    plain = solve(POINT, BAND, 1e-2, Operators())
    table = POINT._replace(left_out=lambda number: 1.0 if number < 100 else 0.0)
    light = solve(table, BAND, 1e-2, Operators())
    assert light.status == plain.status == AccuracyStatus.REACHED
    assert plain.wavenumber.size < 50
    assert 100 <= light.wavenumber.size <= 150
    k = np.linspace(*BAND, 9)
    off = over_band(light, light.values, k) - over_band(plain, plain.values, k)
    assert np.abs(off).max() <= plain.error + light.error


def test_thin_cylinders_return_light_by_their_area() -> None:
    # Rayleigh: from the same place, twice the diameter scatters four times the field
    fields = []
    for diameter in (2e-3, 1e-3):
        scene = SCENE._replace(diameter=diameter, gap=0.1 - diameter / 2)
        fields.append(field_of(Point(scene, PUPIL, 1.2, 0.1), ORDERS._replace(waves=3))[1:])
    np.testing.assert_allclose(fields[0] / fields[1], 4, rtol=2e-4)


EXTREMES: dict[str, tuple[dict[str, Any], dict[str, Any]]] = {
    "10 nm": ({"diameter": 0.01}, {}),
    "1 nm": ({"diameter": 1e-3}, {}),
    "weak": ({"n_neuron": 1.33 + 1e-12}, {}),
    "low index": ({"n_neuron": 1.2}, {"aperture": 1.25}),
    "high index": ({"n_neuron": 2.2}, {"accuracy": 1e-2}),
    "no gap": ({"gap": 0.0}, {}),
    "gap 1 mm": ({"gap": 1e3}, {}),
    "small aperture": ({}, {"aperture": 1e-3}),
    "aperture 1.3": ({}, {"aperture": 1.3}),
    "aperture of water": ({}, {"aperture": 1.3299, "accuracy": 1e-2}),
    "far focus": ({}, {"focus": 1e3}),
    "far focus below": ({}, {"focus": -1e3}),
    "far off": ({"offset": 100.0}, {}),
    "large": ({"diameter": 100.0}, {}),
    "1e-8": ({}, {"accuracy": 1e-8}),
    "1e-12": ({}, {"accuracy": 1e-12}),
    "1e-12 of 1 nm": ({"diameter": 1e-3}, {"accuracy": 1e-12}),
}


@pytest.mark.parametrize("name", EXTREMES)
@pytest.mark.filterwarnings("error")
def test_extremes_are_reached_or_say_so(name: str) -> None:
    of_scene, other = EXTREMES[name]
    light = solved(SCENE._replace(**of_scene), **other)
    if light.status == AccuracyStatus.REACHED:
        assert np.isfinite(light.values).all()
        assert np.isfinite(light.error)
    else:
        assert light.status == AccuracyStatus.BUDGET_SPENT


def test_a_point_stops_before_it_takes_more_than_its_budget(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    taken: list[float] = []

    def counted(*given: Any) -> Any:
        found = field_at(*given)
        taken.append(found.multiplications)
        return found

    monkeypatch.setattr(solving, "field_at", counted)
    resonant, most = SCENE._replace(n_neuron=2.2, diameter=1.0), 3e8
    reached = solved(resonant, accuracy=1e-3)
    assert reached.status == AccuracyStatus.REACHED
    assert sum(taken) > most
    taken.clear()
    monkeypatch.setattr(solving, "MOST_MULTIPLICATIONS", most)
    stopped = solved(resonant, accuracy=1e-3)
    assert stopped.status == AccuracyStatus.BUDGET_SPENT
    assert np.isfinite(stopped.values).all()
    assert sum(taken) < 1.2 * most
