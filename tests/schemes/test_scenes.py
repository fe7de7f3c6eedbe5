"""Counted rays in any scene: against a literal tracer, and by what must hold."""

from typing import Any

import numpy as np
import pytest
from literal_effects_setup import Setup
from literal_scene import intensity
from scene_cases import CASES, FEW, MEMBRANE, MYELIN, NEURON

import octsim.schemes.ray_trees
from octsim.base.errors import ConfigError
from octsim.config.load import load_config
from octsim.instrument.build import detector_of, scene_of
from octsim.instrument.instrument import Instrument
from octsim.optics.beam import vogel_beam
from octsim.optics.detector import Outcome
from octsim.optics.scene import Symmetry
from octsim.schemes.light import Sampled
from octsim.tracing.carry import AMPLITUDE
from octsim.tracing.faces import faces_at, most_meetings
from octsim.tracing.kernel import FIRST_CARRIED, LENGTH
from octsim.tracing.light_paths import LONGEST, names_of_paths, steps_of
from octsim.tracing.path_codes import steps_of_code
from octsim.tracing.path_rays import make_path_tracer
from octsim.tracing.tree import arrivals, trace

pytestmark = pytest.mark.filterwarnings("ignore::octsim.base.errors.OctsimWarning")
DIAMETER, FOCUS = 1.4, 0.877
# one wavenumber is traced like the next: a few show what depends on it
FEW_RAYS = {"tracing": {"rays": 300}, "spectrum": {"samples": 4}}


def instrument(*overlays: dict[str, Any]) -> Instrument:
    return Instrument(load_config(FEW_RAYS, *overlays))


def spectrum(*overlays: dict[str, Any]) -> np.ndarray[Any, Any]:
    return instrument(*overlays).spectrum(DIAMETER, FOCUS).intensity


def of(*cylinders: dict[str, Any], most: int = 11, **scene: Any) -> dict[str, Any]:
    """Return what lays a scene over a config."""
    given = {"cylinders": list(cylinders), **scene}
    return {**FEW, "scene": given, "tracing": {"max_intersections": most}}


def off(found: Any, expected: Any) -> float:
    """Return how far intensities are from others, over the largest of these."""
    return float(np.abs(found - expected).max() / expected.max())


@pytest.mark.parametrize("name", CASES)
def test_counted_rays_are_those_of_a_literal_tracer(name: str) -> None:
    case = CASES[name]
    found = instrument(case.overlay)
    setup = Setup(rays=300, diameter=DIAMETER, focus=FOCUS, **case.literal)
    expected = intensity(case.scene, setup, found.wavenumber)
    # amplitudes that cancel to nothing are as exact as those that don't
    size = max(expected.max(), 1e-8)
    assert np.abs(found.spectrum(DIAMETER, FOCUS).intensity - expected).max() <= 1e-8 * size


def test_a_shell_of_the_cylinders_medium_is_none() -> None:
    shell = {"medium": "neuron", "thickness": "100 nm"}
    assert (spectrum(of({**NEURON, "shells": [shell, shell]})) == spectrum(of(NEURON))).all()


def test_shells_of_equal_index_meet_light_and_do_nothing_to_it() -> None:
    media: dict[str, Any] = {"refractive_index": {"one": 1.39, "other": 1.39}}
    shells = [{"medium": name, "thickness": "100 nm"} for name in ("one", "other")]
    plain = spectrum(of(NEURON, most=30))
    twice = spectrum(of({**NEURON, "shells": shells}, most=42, **media))
    assert off(twice, plain) <= 1e-9
    # the shortest path by the far side has 4 s + 5 meetings
    few = spectrum(of({**NEURON, "shells": shells}, most=12, **media))
    assert off(few, plain) > 0.1


def test_no_elevation_and_no_azimuth_are_none() -> None:
    level = {**NEURON, "elevation": "0 deg", "azimuth": "0 deg", "x": "0 um"}
    assert (spectrum(of(level)) == spectrum(of(NEURON))).all()


@pytest.mark.parametrize(("medium", "most"), [("glass", 11), ("film", 13)])
def test_layers_of_equal_index_are_none(medium: str, most: int) -> None:
    # the plane below the cylinder is 200 nm higher, and so is the focus; in and out light meets one
    # surface more, if it is one
    film = {"medium": medium, "thickness": "200 nm"}
    media: dict[str, Any] = {"refractive_index": {"film": 1.52}} if medium == "film" else {}
    found = instrument(of(NEURON, most=most, layers=["glass", film, "water"], **media))
    moved = found.spectrum(DIAMETER, FOCUS + 0.2).intensity
    assert off(moved, spectrum(of(NEURON))) <= 1e-11


@pytest.mark.parametrize("azimuth", [17.0, 90.0, -140.0])
def test_rays_that_are_turned_along_see_no_azimuth(azimuth: float) -> None:
    turn = np.radians(azimuth)
    shell = {**NEURON, "shells": [MYELIN]}
    media: dict[str, Any] = {"refractive_index": {"myelin": 1.44}}
    config = load_config(FEW_RAYS, of({**shell, "azimuth": f"{azimuth!r} deg"}, **media))
    level = load_config(FEW_RAYS, of(shell, **media))
    detector = detector_of(config)
    beam = vogel_beam(300, detector.objective_radius, detector.focus_distance)
    turned = beam._replace(
        vx=np.cos(turn) * beam.vx - np.sin(turn) * beam.vy,
        vy=np.sin(turn) * beam.vx + np.cos(turn) * beam.vy,
    )
    found = trace(scene_of(config, DIAMETER), turned, detector, FOCUS)
    expected = trace(scene_of(level, DIAMETER), beam, detector, FOCUS)
    for k in (7.0, 8.3, 9.6):
        one, other = (
            (light.amplitude * np.exp(1j * k * light.optical_path_length)).sum()
            for light in (found, expected)
        )
        assert abs(one - other) <= 1e-12


def test_elevations_up_and_down_agree_for_rays_that_are_mirrored() -> None:
    up, down = (
        load_config(FEW_RAYS, of({**NEURON, "elevation": f"{angle} deg"})) for angle in (3, -3)
    )
    detector = detector_of(up)
    beam = vogel_beam(300, detector.objective_radius, detector.focus_distance)
    found = trace(scene_of(up, DIAMETER), beam, detector, FOCUS)
    mirrored = trace(scene_of(down, DIAMETER), beam._replace(vy=-beam.vy), detector, FOCUS)
    assert found.segments == mirrored.segments
    np.testing.assert_allclose(found.amplitude, mirrored.amplitude, rtol=1e-12)


def test_a_lifted_cylinder_ends_at_its_layers_planes() -> None:
    config = load_config(FEW_RAYS, of({**NEURON, "elevation": "5 deg"}))
    scene = scene_of(config, DIAMETER)
    assert scene.surface_names == ("P", "foot", "C")
    found = Instrument(config).rays(DIAMETER, FOCUS)
    names = names_of_paths(scene, 8.0, np.unique(found.path).tolist())
    assert any("foot T" in name for name in names)
    # light that goes in by the foot meets no water
    assert all(name.startswith(("P", "foot")) for name in names)


def test_a_far_neighbour_does_nothing_to_light_that_does_not_reach_it() -> None:
    beside = {**NEURON, "diameter": "1.4 um", "x": "40 um"}
    assert off(spectrum(of(NEURON, beside)), spectrum(of(NEURON))) <= 1e-6


def test_a_near_neighbour_hardly_matters() -> None:
    beside = {**NEURON, "diameter": "1.4 um", "x": "1.45 um"}
    many = {"tracing": {"rays": 3000}}
    found, alone = (spectrum(scene, many) for scene in (of(NEURON, beside), of(NEURON)))
    assert off(found, alone) <= 1e-5


def test_light_paths_are_named_by_what_they_meet() -> None:
    media: dict[str, Any] = {"refractive_index": {"myelin": 1.44}}
    beside = {**NEURON, "diameter": "1 um", "x": "3 um"}
    found = instrument(of({**NEURON, "shells": [MYELIN]}, beside, **media))
    scene = scene_of(found.config, DIAMETER)
    assert scene.surface_names == ("glass", "myelin", "neuron", "neuron 2")
    codes = np.unique(found.rays(DIAMETER, FOCUS).path).tolist()
    names = names_of_paths(scene, 8.0, codes)
    assert {"glass R", "glass T myelin R glass T"} <= set(names)
    assert "glass T myelin T neuron T neuron R neuron T myelin T glass T" in names
    assert len(set(names)) == len(codes)


def test_codes_of_paths_are_those_of_no_other() -> None:
    media: dict[str, Any] = {"refractive_index": {"myelin": 1.44}}
    config = load_config(of({**NEURON, "shells": [MYELIN], "elevation": "3 deg"}, **media))
    scene = scene_of(config, DIAMETER)
    faces = faces_at(scene, 8.0)
    steps = [tuple(steps_of_code(faces, code)) for code in range(3000)]  # type: ignore[arg-type]
    assert len(set(steps)) == 3000
    face, through = np.empty(LONGEST, np.int64), np.empty(LONGEST, np.bool_)
    for code in range(0, 3000, 7):
        meetings = steps_of(faces, code, face, through)
        assert tuple((2 * face + through)[:meetings].tolist()) == steps[code]
    assert [*map(len, steps)] == sorted(map(len, steps))
    assert most_meetings(scene) >= 30


def test_rays_in_shares_are_all_rays(monkeypatch: pytest.MonkeyPatch) -> None:
    case = CASES["everything at once"]
    whole = instrument(case.overlay)
    light = whole.light(DIAMETER, FOCUS)
    monkeypatch.setattr(octsim.schemes.ray_trees, "_AT_ONCE", 1e5)
    shares = whole.light(DIAMETER, FOCUS)
    found, expected = whole.sum(shares), whole.sum(light)
    assert off(found.intensity, expected.intensity) <= 1e-9
    assert found.error == pytest.approx(expected.error, rel=1e-6)
    assert isinstance(light, Sampled)
    assert isinstance(shares, Sampled)
    ends = shares.rays.outcomes
    assert ends is not None
    assert ends[Outcome.DETECTED] == light.rays.path.size


def test_what_is_dropped_is_in_the_error() -> None:
    media: dict[str, Any] = {"refractive_index": {"myelin": 1.44, "membrane": 1.46}}
    scene = of({**NEURON, "shells": [MEMBRANE, MYELIN]}, most=13, **media)
    exact = spectrum(scene)
    plain = instrument(scene).spectrum(DIAMETER, FOCUS)
    for faint in (1e-6, 1e-4, 1e-3):
        found = instrument(scene, {"tracing": {"min_amplitude": faint}}).spectrum(DIAMETER, FOCUS)
        assert off(found.intensity, exact) <= found.error - plain.error


def test_a_tree_beyond_what_can_be_kept_is_refused() -> None:
    media: dict[str, Any] = {"refractive_index": {"myelin": 1.44, "membrane": 1.46}}
    scene = of({**NEURON, "shells": [MEMBRANE, MYELIN]}, most=35, **media)
    with pytest.raises(ConfigError, match=r"^tracing\.max_intersections: 35 given.*min_amplitude"):
        load_config(scene)
    load_config(scene, {"tracing": {"min_amplitude": 1e-6}})


BESIDE = {"diameter": "1 um", "x": "2 um"}


@pytest.mark.parametrize(
    ("swept", "others", "expected"),
    [
        ({}, [], Symmetry(x=True, y=True)),
        ({"x": "0.1 um"}, [], Symmetry(x=False, y=True)),
        ({"azimuth": "10 deg"}, [], Symmetry(x=False, y=False)),
        ({"elevation": "1 deg"}, [], Symmetry(x=True, y=False)),
        ({}, [BESIDE], Symmetry(x=False, y=True)),
        ({}, [BESIDE, {**BESIDE, "x": "-2 um"}], Symmetry(x=True, y=True)),
        ({}, [BESIDE, {**BESIDE, "x": "-2 um", "diameter": "1.1 um"}], Symmetry(x=False, y=True)),
    ],
)
def test_a_scene_has_the_symmetry_of_its_cylinders(
    swept: dict[str, Any], others: list[dict[str, Any]], expected: Symmetry
) -> None:
    config = load_config(of(*({**NEURON, **one} for one in (swept, *others))))
    assert scene_of(config, DIAMETER).symmetry == expected


def test_rays_of_one_light_path_are_those_of_the_tree() -> None:
    shell = {**NEURON, "elevation": "4 deg", "shells": [MYELIN]}
    config = load_config(of(shell, refractive_index={"myelin": 1.44}))
    scene, detector = scene_of(config, DIAMETER), detector_of(config)
    beam = vogel_beam(300, detector.objective_radius, detector.focus_distance)
    found = arrivals(scene, beam, detector, FOCUS, 9)
    trace_path, faces = make_path_tracer(AMPLITUDE), faces_at(scene, 8.0)
    for code in np.unique(found.path).tolist():
        rays = found.path == code
        every = np.full(beam.vx.size, code)
        numbers = trace_path(faces, every, beam, detector, FOCUS)[:, found.ray[rays]]
        assert (numbers[LENGTH] == found.optical_path_length[rays]).all()
        assert (numbers[FIRST_CARRIED] == found.carried[0, rays]).all()
