"""What is uncertain of an instrument: moved one by one, or drawn within its limits."""

import math
from typing import Any

import numpy as np
import pytest

from octsim.config.light import FibreMode, GaussianFill
from octsim.config.load import load_config
from octsim.config.models import Config
from octsim.config.scene_keys import scene_values
from octsim.instrument.build import polarisation_of
from octsim.optics.polarisation import jones_rows
from octsim.studies.calibration.parameters import PARAMETERS, parameters_of
from octsim.studies.calibration.scheme import converged
from octsim.studies.calibration.tolerances import changes_by, drawn, moved, nodes_of

LAW = 0.58


def value_of(config: Config, name: str) -> float:
    """Return what a parameter is in a config, of the pupil its width."""
    if name != "fill":
        return PARAMETERS[name].believed(config)
    match config.pupil:
        case GaussianFill(gaussian=width):
            return width
        case FibreMode(fibre=diameter):
            return 1 / diameter  # a wider mode fills less
    raise AssertionError(config.pupil)


OVERLAYS: tuple[dict[str, Any], ...] = (
    {"calibration": {"scheme": "paths"}},
    {},
    {"objective": {"pupil": {"gaussian": 0.5}}, "polarisation": {"input": "30 deg"},
     "tracing": {"scheme": "fullwave"}},
    {"polarisation": {"input": "left", "analyser": "10 deg"}, "tracing": {"scheme": "fullwave"},
     "scene": {"cylinders": [{"medium": "neuron", "x": "0.1 um", "azimuth": "350 deg"}]}},
)  # fmt: skip


@pytest.mark.parametrize("overlay", OVERLAYS)
def test_parameters_move_alone_and_only_where_they_can(overlay: dict[str, Any]) -> None:
    config = converged(load_config({"scene": {"gap": "0 nm"}}, overlay))
    seen = parameters_of(config)
    by_rays = config.tracing.scheme == "paths"
    assert set(PARAMETERS) - set(seen) == (
        {"fill", "polarisation"} if by_rays else {"detector_radius"}
    )
    for name in seen:
        for by in nodes_of(config, name).offset.tolist():
            place = moved(config, {name: by}, LAW)
            if name in ("diameter", "focus"):
                assert place.config == config
                assert (place.diameter, place.focus) == (
                    (by, LAW * by) if name == "diameter" else (0.0, by)
                )
                continue
            rest = value_of(config, name)
            expected = rest * (1 + by) if name == "fill" else rest + by
            turn = np.pi if name == "polarisation" else np.inf  # the same after half a turn
            assert abs(math.remainder(value_of(place.config, name) - expected, turn)) < 1e-9
            for other in set(seen) - {name}:
                assert value_of(place.config, other) == value_of(config, other)
    assert nodes_of(config, "gap").offset[0] == 0
    assert nodes_of(config, "gap").weight[0] == pytest.approx(0.5 + 8 / 30)  # of all below


def test_a_tolerance_of_zero_moves_nothing_and_still_has_a_sensitivity() -> None:
    config = converged(load_config({"calibration": {"tolerances": {"neuron": 0}}}))
    nodes = nodes_of(config, "neuron")
    assert np.ptp(nodes.offset) > 0
    assert changes_by(nodes, 3 * nodes.offset) == (0.0, 0.0, 0.0)


def test_the_changes_by_a_tolerance_are_those_of_many_draws() -> None:
    config = converged(load_config({"calibration": {"tolerances": {"offset": "0.3 um"}}}))
    nodes = nodes_of(config, "offset")
    off = np.random.default_rng(1).normal(0.0, 0.3, 1_000_000)
    for polynomial in ((0, 2.0), (0, 0, 2.5), (1, -1.0, 2.0), (0, 0, 1, 0.5, -0.3)):
        shape = np.polynomial.Polynomial(polynomial)
        change = shape(off) - shape(0)
        found = changes_by(nodes, shape(nodes.offset))
        assert found.spread == pytest.approx(change.std(), rel=0.02)
        assert found.shift == pytest.approx(change.mean(), rel=0.02, abs=2e-3)
        assert found.error < 0.1 * found.spread


def test_light_that_is_half_across_and_half_along_is_as_light_between_them() -> None:
    """What the tolerance of unpolarised and circular light begins from is that light itself."""
    generator = np.random.default_rng(2)
    fields = generator.normal(size=(2, 4)) + 1j * generator.normal(size=(2, 4))
    for given in ("unpolarised", "left", "right"):
        config = converged(load_config(
            {"polarisation": {"input": given}, "tracing": {"scheme": "fullwave"},
             "scene": {"cylinders": [{"medium": "neuron", "azimuth": "20 deg"}]}}
        ))  # fmt: skip
        same = moved(config, {"polarisation": 0.0}, LAW).config
        assert same.polarisation.input == pytest.approx(np.radians(20 + 45))
        intensity = [
            (np.abs(jones_rows(polarisation_of(one), np.radians(20)) @ fields) ** 2).mean(axis=0)
            for one in (config, same)
        ]
        assert intensity[1] == pytest.approx(intensity[0], rel=1e-12)


def test_what_is_drawn_scatters_by_the_tolerances() -> None:
    generator = np.random.default_rng(3)
    places = [drawn(Config(), generator, LAW) for _ in range(300)]
    tolerances = Config().calibration.tolerances
    for name in ("gap", "neuron", "wavelength_min", "detector_radius"):
        spread = np.std([value_of(place.config, name) for place in places])
        assert spread == pytest.approx(getattr(tolerances, name), rel=0.15), name
    following = [place.focus - LAW * place.diameter for place in places]
    assert np.std(following) == pytest.approx(tolerances.focus, rel=0.15)


@pytest.mark.parametrize("aperture", [1.5, 1.51])
def test_an_instrument_near_its_limits_is_drawn_within_them(aperture: float) -> None:
    config = load_config({"objective": {"numerical_aperture": aperture}})
    generator = np.random.default_rng(1)
    for _ in range(300):
        place = drawn(config, generator, 0.58)
        glass = place.config.scene.refractive_index.glass
        assert place.config.objective.numerical_aperture < glass


AXON: dict[str, Any] = {
    "scene": {
        "cylinders": [
            {"medium": "neuron", "shells": [{"medium": "myelin", "thickness": "5 nm"}]},
            {"medium": "neuron", "diameter": "1 um", "x": "1.8 um"},
        ],
        "refractive_index": {"myelin": 1.44},
        "attenuation": {"neuron": "10 /cm"},
    },
    "tracing": {"max_intersections": 15},
}
NUMBERS = {
    "scene.cylinders.1.x": "0.5 um",
    "scene.cylinders.1.azimuth": "0 deg",
    "scene.cylinders.0.shells.0.thickness": "2 nm",
    "scene.refractive_index.myelin": 0.005,
    "scene.attenuation.neuron": "1 /cm",
}


def test_a_tolerance_of_any_number_of_the_scene_is_one_in_any_unit_of_its_kind() -> None:
    config = load_config(AXON, {"calibration": {"tolerances": NUMBERS}})
    written = NUMBERS | {"scene.cylinders.1.x": "500 nm", "scene.attenuation.neuron": "0.1 /mm"}
    assert load_config(AXON, {"calibration": {"tolerances": written}}) == config
    assert load_config(config.to_dict()) == config
    of = config.calibration.tolerances.of
    assert [of[key] for key in NUMBERS] == pytest.approx([0.5, 0.0, 2e-3, 0.005, 1e-4])


def test_numbers_of_the_scene_move_alone_as_far_as_a_scene_is_possible() -> None:
    config = load_config(AXON, {"calibration": {"tolerances": NUMBERS}})
    assert set(NUMBERS) <= set(parameters_of(config))  # rays see all of them
    believed = scene_values(config)
    for name in NUMBERS:
        for by in nodes_of(config, name).offset.tolist():
            there = scene_values(moved(config, {name: by}, LAW).config)
            for other, value in believed.items():
                expected = value + by * (other == name)
                assert there[other] == pytest.approx(expected, abs=1e-12), name
    # the axes of neighbours that touch are 1.612 µm apart in x (2.4 and 1 µm, on one plane)
    nearest = nodes_of(config, "scene.cylinders.1.x").offset[0]
    assert -(1.8 - np.sqrt(2.4)) < nearest < -0.01
    assert nodes_of(config, "scene.cylinders.1.x").offset[-1] > 1
    assert nodes_of(config, "scene.cylinders.0.shells.0.thickness").offset[0] > -5e-3
    generator = np.random.default_rng(4)
    for _ in range(20):
        drawn(config, generator, LAW)


def test_numbers_of_the_scene_count_where_the_scheme_sees_them() -> None:
    tolerances = {"scene.cylinders.0.azimuth": "1 deg", "scene.cylinders.0.elevation": "1 deg"}
    config = load_config({"calibration": {"tolerances": tolerances}})
    by_waves = parameters_of(converged(config))
    assert "scene.cylinders.0.azimuth" in by_waves
    assert "scene.cylinders.0.elevation" not in by_waves
