"""Light paths through layers, shells, several cylinders and turned ones, beside counted rays."""

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from octsim.config.derive import merge
from octsim.config.load import load_config
from octsim.instrument.build import scene_of
from octsim.instrument.instrument import Instrument, PointSpectrum
from octsim.schemes.light import AccuracyStatus
from octsim.tracing.faces import AnyFaces, faces_at
from octsim.tracing.light_paths import LONGEST, steps_of
from octsim.tracing.path_codes import steps_of_code

pytestmark = pytest.mark.filterwarnings("ignore::octsim.base.errors.OctsimWarning")
DIAMETER, FOCUS = 1.4, 0.877
NEURON: dict[str, Any] = {"medium": "neuron"}
NARROW: dict[str, Any] = {
    "sweep": {"diameters": {"start": "1.3 um", "stop": "1.42 um", "num": 4}},
    "focus_law": {"diameters": {"start": "1.3 um", "stop": "1.42 um", "num": 3}},
    "focus_scan": {"diameter": "1.4 um"},
}


def neurons(*given: dict[str, Any], **scene: Any) -> dict[str, Any]:
    return {"scene": {"cylinders": [{**NEURON, **one} for one in given], **scene}}


def shelled(medium: str, index: float, thickness: str, **more: Any) -> dict[str, Any]:
    shells = [{"medium": medium, "thickness": thickness}]
    return neurons({"shells": shells, **more}, refractive_index={medium: index})


def spectrum(scheme: str, overlay: dict[str, Any], **tracing: Any) -> PointSpectrum:
    settings = {"tracing": {"scheme": scheme, **tracing}, "spectrum": {"samples": 25}}
    return Instrument(load_config(settings, overlay)).spectrum(DIAMETER, FOCUS)


def off(found: NDArray[np.float64], expected: NDArray[np.float64]) -> float:
    return float(np.abs(found - expected).max() / expected.max())


COVER = ["glass", {"medium": "water", "thickness": "5 um"}, "glass"]
FILM = ["glass", {"medium": "film", "thickness": "300 nm"}, "water"]
SMOOTH: dict[str, dict[str, Any]] = {
    "membrane": shelled("membrane", 1.46, "5 nm"),
    "myelin": shelled("myelin", 1.44, "100 nm"),
    "cover glass": {"scene": {"layers": COVER}},
    "film": {"scene": {"layers": FILM, "refractive_index": {"film": 1.45}}},
    "beside the axis": neurons({"x": "200 nm"}),
    "turned": neurons({"azimuth": "45 deg", "x": "100 nm"}),
    "lifted far above": neurons({"elevation": "2 deg", "gap": "300 nm"}),
}
AT_EDGES: dict[str, dict[str, Any]] = {
    "neighbour": {**neurons({}, {"diameter": "1.4 um", "x": "1.47 um"}), **NARROW},
    "two neighbours": {
        **neurons({}, *({"diameter": "1.4 um", "x": f"{x} um"} for x in (-1.47, 1.47))), **NARROW
    },
    "lifted": neurons({"elevation": "0.5 deg"}),
}  # fmt: skip
LIGHT: dict[str, Any] = {
    "polarisation": {"input": "30 deg"},
    "interferometer": {"reference": {"amplitude": 0.001, "length": "3 um"}},
    "objective": {"zernike": {"spherical": "2 nm"}},
}


@pytest.mark.parametrize("name", [*SMOOTH, *AT_EDGES])
def test_the_error_is_within_what_is_said(name: str) -> None:
    overlay = {**SMOOTH, **AT_EDGES}[name]
    exact = spectrum("paths", overlay, accuracy=1e-6)
    for accuracy in (1e-3, 1e-4):
        found = spectrum("paths", overlay, accuracy=accuracy)
        expected = AccuracyStatus.REACHED if name in SMOOTH else AccuracyStatus.AT_AN_EDGE
        assert found.status == expected
        assert off(found.intensity, exact.intensity) <= found.error <= accuracy


@pytest.mark.parametrize("name", [*SMOOTH, *AT_EDGES])
def test_many_counted_rays_come_to_the_same(name: str) -> None:
    overlay = {**SMOOTH, **AT_EDGES}[name]
    found = spectrum("paths", overlay, accuracy=1e-5)
    rays = spectrum("vogel", overlay, rays=100_000, min_amplitude=1e-6)
    assert off(found.intensity, rays.intensity) <= rays.error + found.error <= 0.01


@pytest.mark.trial
@pytest.mark.parametrize("name", ["myelin", "turned", "cover glass"])
def test_effects_on_light_are_those_of_counted_rays(name: str) -> None:
    overlay = merge(SMOOTH[name], LIGHT)
    found = spectrum("paths", overlay, accuracy=1e-5)
    rays = spectrum("vogel", overlay, rays=100_000, min_amplitude=1e-6)
    assert off(found.intensity, rays.intensity) <= rays.error + found.error <= 0.01


def test_astigmatism_is_turned_along_with_the_light() -> None:
    aberration = {"objective": {"zernike": {"astigmatism": "3 nm"}}}
    light = {"polarisation": {"input": "0 deg", "analyser": "20 deg"}}
    across = {"polarisation": {"input": "90 deg", "analyser": "110 deg"}}
    opposite = {"objective": {"zernike": {"astigmatism": "-3 nm"}}}
    for first, second in ((aberration, opposite), (light, across)):
        plain = spectrum("paths", first, accuracy=1e-6)
        turned = spectrum("paths", merge(neurons({"azimuth": "90 deg"}), second), accuracy=1e-6)
        assert off(turned.intensity, plain.intensity) <= 1e-9


@pytest.mark.parametrize("azimuth", [10, 45, 90, -30])
def test_unpolarised_light_does_not_see_an_azimuth(azimuth: float) -> None:
    plain = spectrum("paths", {}, accuracy=1e-4)
    turned = spectrum("paths", neurons({"azimuth": f"{azimuth} deg"}), accuracy=1e-4)
    assert off(turned.intensity, plain.intensity) <= 1e-12


def test_opposite_elevations_agree() -> None:
    lifted = [neurons({"elevation": f"{angle} deg", "azimuth": "20 deg"}) for angle in (2, -2)]
    up, down = (spectrum("paths", one, accuracy=1e-3) for one in lifted)
    assert off(up.intensity, down.intensity) <= 1e-12


def test_shells_and_layers_without_contrast_are_nothing() -> None:
    plain = spectrum("paths", {}, accuracy=1e-9)
    same = spectrum(
        "paths", neurons({"shells": [{"medium": "neuron", "thickness": "0.1 um"}]}), accuracy=1e-9
    )
    assert np.array_equal(same.intensity, plain.intensity)
    alike = {
        "layers": ["glass", {"medium": "water", "thickness": "5 um"}, "serum"],
        "refractive_index": {"serum": 1.33},
    }
    layer = spectrum("paths", {"scene": alike}, accuracy=1e-9)
    assert off(layer.intensity, plain.intensity) <= 1e-9


def test_a_shell_of_the_same_index_is_nothing_with_enough_meetings() -> None:
    plain = spectrum("paths", {}, accuracy=1e-8, max_intersections=9)
    other = spectrum("paths", shelled("other", 1.39, "100 nm"), accuracy=1e-8, max_intersections=25)
    whole = spectrum("paths", {}, accuracy=1e-8, max_intersections=25)
    assert off(other.intensity, whole.intensity) <= 1e-8
    assert plain.status == other.status == AccuracyStatus.REACHED


def test_light_that_slips_between_the_rays_of_a_survey_is_in_the_error() -> None:
    overlay = neurons({"elevation": "5 deg"})
    found = spectrum("paths", overlay, accuracy=1e-4)
    rays = spectrum("vogel", overlay, rays=300_000, min_amplitude=1e-6)
    assert found.status != AccuracyStatus.REACHED
    assert off(found.intensity, rays.intensity) <= found.error


def test_a_tree_without_end_is_followed_as_far_as_the_budget_goes() -> None:
    shells = [{"medium": "water", "thickness": "100 nm"}, {"medium": "glass", "thickness": "90 nm"}]
    found = Instrument(
        load_config(
            {"tracing": {"scheme": "paths", "accuracy": 1e-7, "max_intersections": 35}},
            neurons({"shells": [*shells[1:], *shells[:1]]}),
        )
    ).light(DIAMETER, FOCUS)
    assert found.segments < 3_000_000
    assert found.status in (AccuracyStatus.REACHED, AccuracyStatus.BUDGET_SPENT)


@pytest.mark.parametrize("name", ["myelin", "two neighbours", "cover glass"])
def test_compiled_code_reads_the_paths_that_were_counted(name: str) -> None:
    overlay = {**SMOOTH, **AT_EDGES}[name]
    faces = faces_at(scene_of(load_config(overlay), DIAMETER), 8.0)
    assert isinstance(faces, AnyFaces)
    face, through = np.empty(LONGEST, np.int64), np.empty(LONGEST, np.bool_)
    for code in (0, 1, 7, 100, 54_321, 2**40):
        num = steps_of(faces, code, face, through)
        steps = (2 * face[:num] + through[:num]).tolist()
        assert steps == steps_of_code(faces, code)
