"""The ray tree against a slow literal one, closed forms, symmetry and what is conserved."""

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as st
from literal import literal, spiral, trace_spiral

from octsim.config.load import load_config
from octsim.config.models import Config
from octsim.instrument.build import detector_of, scene_of
from octsim.optics.beam import Beam
from octsim.optics.detector import Outcome
from octsim.optics.interface import fresnel
from octsim.optics.scene import NEURON_ON_GLASS
from octsim.tracing.light_paths import path_name
from octsim.tracing.tree import Detections, arrivals, trace


def by_ray_and_path(found: Detections) -> dict[tuple[int, str], tuple[float, float]]:
    names = (path_name(code, NEURON_ON_GLASS) for code in found.path.tolist())
    keys = zip(found.ray.tolist(), names, strict=True)
    values = zip(found.amplitude.tolist(), found.optical_path_length.tolist(), strict=True)
    return dict(zip(keys, values, strict=True))


def assert_same_rays(config: Config, diameter: float, focus: float) -> int:
    """Compare ray for ray; a ray at an edge of what is detected may be in one and not the other."""
    fast = by_ray_and_path(trace_spiral(config)(diameter, focus))
    slow = {
        (d.ray, d.path): (d.amplitude, d.optical_path_length)
        for d in literal(config, diameter, focus).detections
    }
    brightest = 1 / config.tracing.rays
    for key in fast.keys() ^ slow.keys():
        amplitude = (fast.get(key) or slow[key])[0]
        assert abs(amplitude) < 1e-9 * brightest, f"{key} is in one tree only"
    for key in fast.keys() & slow.keys():
        assert fast[key][0] == pytest.approx(slow[key][0], rel=1e-9, abs=1e-12 * brightest), key
        assert fast[key][1] == pytest.approx(slow[key][1], abs=1e-9), key
    return len(fast.keys() & slow.keys())


SCENES = {
    "thesis": ({}, 1.4, 0.882),
    "touching": ({"scene": {"gap": "0 nm"}}, 1.4, 0.882),
    "far": ({"scene": {"gap": "2 um"}}, 1.0, 2.4),
    "focus on the glass": ({}, 2.0, 0.01),
    "focus below the glass": ({}, 2.0, -0.3),
    "focus in the far side": ({}, 2.0, 2.9),
    "axon in air": ({"scene": {"refractive_index": {"water": 1.0}}}, 1.4, 0.9),
    "lighter than water": ({"scene": {"refractive_index": {"neuron": 1.2}}}, 1.4, 0.9),
    "totally reflecting": ({"objective": {"numerical_aperture": 1.5}}, 1.4, 0.9),
    "large detector": ({"detector": {"core_diameter": "40 um"}}, 1.2, 0.7),
    "few meetings": ({"tracing": {"max_intersections": 3}}, 1.4, 0.88),
    "no faint rays": ({"tracing": {"min_amplitude": 0.02}}, 1.4, 0.88),
}


@pytest.mark.parametrize(("overlay", "diameter", "focus"), SCENES.values(), ids=SCENES)
def test_the_tree_matches_the_literal_one_ray_for_ray(
    overlay: dict[str, Any], diameter: float, focus: float
) -> None:
    config = load_config({"tracing": {"rays": 400}}, overlay)
    assert assert_same_rays(config, diameter, focus) > 0


@settings(max_examples=60, suppress_health_check=[HealthCheck.too_slow])
@given(
    n_glass=st.floats(1.3, 2.0),
    n_water=st.floats(1.0, 1.7),
    n_neuron=st.floats(1.0, 1.7),
    gap=st.floats(0.0, 1.0),
    diameter=st.floats(0.2, 4.0),
    focus=st.floats(-0.5, 3.0),
    aperture=st.floats(0.1, 0.99),
    core=st.floats(2.0, 60.0),
)
def test_the_tree_matches_the_literal_one_in_any_scene(
    n_glass: float, n_water: float, n_neuron: float, gap: float,
    diameter: float, focus: float, aperture: float, core: float,
) -> None:  # fmt: skip
    # At a focus of exactly 0 the rim ray returns to the rim itself, and with NA = n_water it runs
    # along the plane: rounding decides there, in both tracers.
    assume(abs(focus) > 1e-3)
    assume(abs(aperture * n_glass - n_water) > 1e-3)
    config = load_config(
        {
            "scene": {
                "refractive_index": {"glass": n_glass, "water": n_water, "neuron": n_neuron},
                "gap": f"{gap} um",
            },
            "objective": {"numerical_aperture": aperture * n_glass},
            "detector": {"core_diameter": f"{core} um"},
            "tracing": {"rays": 60, "max_intersections": 9},
        }
    )
    assert_same_rays(config, diameter, focus)


def test_segments_are_counted_as_in_the_literal_tree() -> None:
    config = load_config({"tracing": {"rays": 300}})
    fast, slow = trace_spiral(config)(1.4, 0.882), literal(config, 1.4, 0.882)
    assert fast.segments == slow.segments


def test_every_segment_ends_in_one_way() -> None:
    config = load_config(
        {"tracing": {"rays": 500, "min_amplitude": 0.01}, "objective": {"numerical_aperture": 1.5}}
    )
    found = trace_spiral(config)(1.4, 0.882)
    not_traced = found.outcomes[[Outcome.FAINT, Outcome.TOTALLY_REFLECTED]].sum()
    ended = found.outcomes.sum() - not_traced
    assert found.outcomes[Outcome.FAINT] > 0
    assert found.outcomes[Outcome.TOTALLY_REFLECTED] > 0
    assert found.outcomes[Outcome.DETECTED] == found.amplitude.size
    split = found.segments - ended
    assert found.segments == 500 + 2 * split - not_traced


def axial(max_intersections: int = 11) -> dict[str, tuple[float, float]]:
    config = load_config({"tracing": {"rays": 1, "max_intersections": max_intersections}})
    return {path: v for (_, path), v in by_ray_and_path(trace_spiral(config)(1.4, 0.8)).items()}


def test_axial_paths_have_the_lengths_and_amplitudes_of_parallel_plates() -> None:
    found = axial()
    n_g, n_w, n_n = 1.52, 1.33, 1.39
    (r_g, t_g), (_, t_w) = fresnel(n_g, n_w, 1, 1), fresnel(n_w, n_g, 1, 1)
    (r_w, t_c), (r_n, t_n) = fresnel(n_w, n_n, 1, 1), fresnel(n_n, n_w, 1, 1)
    there_and_back = -2 * n_g * 0.8
    gap, neuron = 2 * n_w * 0.005, 2 * n_n * 1.4
    expected = {
        "PR": (r_g, there_and_back),
        "PT CR PT": (t_g * r_w * t_w, there_and_back + gap),
        "PT CT CR CT PT": (t_g * t_c * r_n * t_n * t_w, there_and_back + gap + neuron),
        "PT CR PR CR PT": (t_g * r_w * -r_g * r_w * t_w, there_and_back + 2 * gap),
    }
    for path, (amplitude, length) in expected.items():
        assert found[path] == pytest.approx((amplitude, length), rel=1e-14), path


def test_a_ray_that_met_just_the_allowed_surfaces_is_detected() -> None:
    assert "PT CT CR CT PT" in axial(max_intersections=5)
    assert "PT CT CR CT PT" not in axial(max_intersections=4)
    assert axial(max_intersections=1).keys() == {"PR"}


def test_axial_amplitudes_keep_the_energy_of_a_stack_of_plates() -> None:
    # On the axis the tree is a stack of thin films: with every path summed, its reflection is
    # Airy's, here from the recursion over the interfaces.
    k = 2 * np.pi / 0.8
    config = load_config({"tracing": {"rays": 1, "max_intersections": 30}})
    found = trace_spiral(config)(1.4, 0.0)
    field = np.sum(found.amplitude * np.exp(1j * k * found.optical_path_length))
    r_gw, r_wn = -(1.33 - 1.52) / (1.33 + 1.52), -(1.39 - 1.33) / (1.39 + 1.33)
    far = -r_wn * np.exp(2j * k * 1.39 * 1.4)
    near = (r_wn + far) / (1 + r_wn * far) * np.exp(2j * k * 1.33 * 0.005)
    # a ray on the axis leaves upwards for good at the cylinder's top, as from the last film
    assert field == pytest.approx((r_gw + near) / (1 + r_gw * near), abs=1e-10)


def test_optical_path_follows_from_the_geometry_of_the_near_reflection() -> None:
    # A ray in the plane x = 0 sees flat plates: its path is trigonometry.
    config = load_config({"detector": {"core_diameter": "400 um"}, "scene": {"gap": "1 um"}})
    tilt, focus = 0.01, 0.5
    beam = Beam(
        np.zeros(1),
        np.array([math.sin(tilt)]),
        np.array([math.cos(tilt)]),
        np.ones(1),
        np.arange(1),
    )
    found = trace(scene_of(config, 1.4), beam, detector_of(config), focus)
    path = by_ray_and_path(found)[0, "PT CR PT"][1]
    in_water = math.asin(1.52 * math.sin(tilt) / 1.33)
    # y on the way: from the focus back to the glass, to the cylinder and back, back to the focus
    y = -2 * focus * math.tan(tilt) + 2 * 1.0 * math.tan(in_water)
    magnification, f = 20, 300 * 20 / 21
    lens = magnification * (math.sqrt(f**2 + y**2) - f)
    expected = -2 * 1.52 * focus / math.cos(tilt) + 2 * 1.33 * 1.0 / math.cos(in_water) + lens
    assert path == pytest.approx(expected, abs=1e-10)


@pytest.mark.parametrize(("mirror_x", "mirror_y"), [(-1, 1), (1, -1), (-1, -1)])
def test_a_mirrored_beam_gives_the_same_light(mirror_x: int, mirror_y: int) -> None:
    config = load_config({"tracing": {"rays": 500}})
    beam = spiral(config)
    mirrored = beam._replace(vx=mirror_x * beam.vx, vy=mirror_y * beam.vy)
    scene, detector = scene_of(config, 1.4), detector_of(config)
    one, other = arrivals(scene, beam, detector, 0.88), arrivals(scene, mirrored, detector, 0.88)
    sign = {"x": mirror_x, "vx": mirror_x, "y": mirror_y, "vy": mirror_y}
    for name in one._fields:
        assert np.array_equal(getattr(one, name), sign.get(name, 1) * getattr(other, name)), name


def test_a_neuron_of_water_is_not_there() -> None:
    config = load_config(
        {"scene": {"refractive_index": {"neuron": 1.33}}, "tracing": {"rays": 300}}
    )
    found = trace_spiral(config)(1.4, 0.01)
    seen = found.path[np.abs(found.amplitude) > 1e-20].tolist()
    assert {path_name(code, NEURON_ON_GLASS) for code in seen} == {"PR"}


def test_the_order_of_the_surfaces_does_not_matter() -> None:
    config = load_config({"tracing": {"rays": 300}})
    beam, detector = spiral(config), detector_of(config)
    scene = scene_of(config, 1.4)
    swapped = replace(scene, surfaces=scene.surfaces[::-1])
    one, other = trace(scene, beam, detector, 0.88), trace(swapped, beam, detector, 0.88)
    for name in ("ray", "amplitude", "optical_path_length", "segments", "outcomes"):
        assert np.array_equal(getattr(one, name), getattr(other, name)), name


def test_more_meetings_than_paths_can_be_numbered_for_are_refused() -> None:
    config = load_config({"tracing": {"rays": 3}})
    beam, detector = spiral(config), detector_of(config)
    with pytest.raises(ValueError, match="max_intersections: 31 given"):
        trace(scene_of(config, 1.4), beam, detector, 0.88, max_intersections=31)


def test_a_focus_beyond_the_objective_is_refused() -> None:
    config = load_config({"tracing": {"rays": 3}})
    with pytest.raises(ValueError, match="must be below the focus distance"):
        trace_spiral(config)(1.0, 300.0)


def test_a_ray_returned_to_the_rim_itself_is_within_it() -> None:
    # with the focus on the glass every reflected ray retraces the aperture, the rim ray its rim
    for rays in (10, 300, 3000):
        config = load_config({"tracing": {"rays": rays, "max_intersections": 1}})
        assert trace_spiral(config)(2.0, 0.0).ray.size == rays
