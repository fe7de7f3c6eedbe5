"""Fields to a stated accuracy, against dense grids of rays through the whole tree."""

import math
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy import integrate as quadrature

from octsim.config.load import load_config
from octsim.config.models import Config
from octsim.instrument.build import detector_of, scene_of
from octsim.instrument.instrument import Instrument
from octsim.optics.beam import Beam, aim
from octsim.optics.detector import Detector
from octsim.optics.interface import cos_transmitted_squared, fresnel
from octsim.optics.materials import Constant
from octsim.optics.scene import Cylinder, Plane, Region, Scene, Symmetry
from octsim.schemes.field_sum import intensity, spectrum_of
from octsim.schemes.light import AccuracyStatus, Light
from octsim.schemes.paths.integrate import integrate
from octsim.schemes.paths.path_sum import field_of_paths
from octsim.tracing.light_paths import path_name
from octsim.tracing.tree import trace

CONFIG = Config()
K = CONFIG.spectrum.wavenumbers()
BAND = float(K[0]), float(K[-1])
GLASS, WATER = Region("glass", Constant(1.52)), Region("water", Constant(1.33))
NEURON = Region("neuron", Constant(1.39))


def field(light: Light, wavenumber: NDArray[np.float64]) -> NDArray[np.complex128]:
    waves: NDArray[np.complex128] = np.exp(1j * np.outer(wavenumber, light.optical_path_length))
    return waves @ light.amplitude


def dense_field(
    scene: Scene, detector: Detector, focus: float, wavenumber: NDArray[np.float64],
    x: tuple[float, float, int], y: tuple[float, float, int],
) -> NDArray[np.complex128]:  # fmt: skip
    """Sum a fine even grid of rays through the whole tree: the converged, slow reference."""
    along, up = (np.linspace(*span, endpoint=False) for span in (x, y))
    xi, v = np.meshgrid(
        along + (x[1] - x[0]) / x[2] / 2, up + (y[1] - y[0]) / y[2] / 2, indexing="ij"
    )
    half = np.sqrt(1 - v * v).ravel()
    radius = detector.objective_radius
    place = (xi.ravel() * half * radius, v.ravel() * radius)
    # x and y are the parts of the aperture that mirror images repeat
    images = 4 if x[0] == 0 else 2
    cell = (x[1] - x[0]) / x[2] * (y[1] - y[0]) / y[2]
    beam = Beam(
        *aim(*place, detector.focus_distance),
        images / np.pi * cell * half,
        np.arange(half.size),
    )
    found = trace(scene, beam, detector, focus, 11)
    total = np.zeros(wavenumber.size, complex)
    for some in np.array_split(np.arange(found.amplitude.size), 50):
        waves = np.exp(1j * np.outer(wavenumber, found.optical_path_length[some]))
        total += waves @ found.amplitude[some]
    return total


def error(light: Light, reference: NDArray[np.complex128], k: NDArray[np.float64]) -> float:
    truth = np.abs(reference) ** 2
    return float(np.abs(np.abs(field(light, k)) ** 2 - truth).max() / truth.max())


@pytest.mark.parametrize(
    ("overlay", "diameter", "focus", "height"),
    [
        ({}, 1.4, 0.8824, 0.12),
        ({}, 1.0, 0.65, 0.15),
        ({"scene": {"gap": "0 nm"}}, 1.4, 0.8824, 0.12),
        ({"scene": {"refractive_index": {"neuron": 1.2}}}, 1.4, 0.8824, 0.2),
        ({"objective": {"numerical_aperture": 1.1}}, 1.4, 0.88, 0.2),
        ({"detector": {"core_diameter": "30 um"}}, 1.4, 0.88, 1.0),
        ({}, 2.0, 2.5, 1.0),  # rings and crescents by a caustic
        ({}, 2.0, 2.8, 1.0),
    ],
)
def test_the_true_error_is_within_the_accuracy(
    overlay: dict[str, Any], diameter: float, focus: float, height: float
) -> None:
    config = load_config(overlay)
    scene, detector, k = scene_of(config, diameter), detector_of(config), K[::111]
    reference = dense_field(scene, detector, focus, k, (0, 1, 700), (0, height, 700))
    for accuracy in (1e-2, 1e-3, 2e-4):
        light = integrate(scene, detector, focus, BAND, accuracy)
        at_an_edge = light.status == AccuracyStatus.AT_AN_EDGE
        assert light.status == AccuracyStatus.REACHED or (at_an_edge and focus > diameter)
        assert error(light, reference, k) < accuracy


def test_a_scene_without_symmetry_is_integrated_over_all_of_the_aperture() -> None:
    scene = Scene(
        GLASS, (Plane("P", 0.0, GLASS, WATER), Cylinder("C", 0.06, 0.7, 0.6, NEURON, WATER))
    )
    detector, k = detector_of(CONFIG), K[::111]
    reference = dense_field(scene, detector, 0.8, k, (-1, 1, 1400), (0, 1, 700))
    for accuracy in (1e-2, 1e-3):
        light = integrate(scene, detector, 0.8, BAND, accuracy)
        assert error(light, reference, k) < accuracy


def test_a_layered_scene_needs_no_cylinder() -> None:
    scene = Scene(GLASS, (Plane("P", 0.0, GLASS, WATER), Plane("D", 0.4, WATER, NEURON)))
    detector, k = detector_of(CONFIG), K[::111]
    reference = dense_field(scene, detector, 0.2, k, (0, 1, 600), (0, 1, 600))
    light = integrate(scene, detector, 0.2, BAND, 1e-3)
    assert error(light, reference, k) < 1e-3
    assert "PT DR PT" in {path_name(code, scene.surface_names) for code in light.path.tolist()}


def test_a_focus_on_the_glass_gives_the_mean_fresnel_coefficient() -> None:
    config = load_config({"scene": {"refractive_index": {"neuron": 1.33}}})
    light = integrate(scene_of(config, 1.0), detector_of(config), 0.0, BAND, 1e-7)

    def r(squared_radius: float) -> float:
        cos = 1 / math.sqrt(1 + squared_radius * math.tan(math.asin(1.2 / 1.52)) ** 2)
        return fresnel(1.52, 1.33, cos, math.sqrt(cos_transmitted_squared(1.52, 1.33, cos)))[0]

    expected, _ = quadrature.quad(r, 0, 1)  # of the squared radius, uniform on the disk
    assert np.abs(field(light, K[::100])) == pytest.approx(np.full(10, expected), rel=1e-7)


def test_the_error_falls_with_the_accuracy_and_is_not_underestimated() -> None:
    config, focus = CONFIG, 0.8824
    scene, detector = scene_of(config, 1.4), detector_of(config)
    truth = field(integrate(scene, detector, focus, BAND, 1e-9), K)
    for accuracy in (1e-2, 1e-3, 1e-4, 1e-5, 1e-6):
        light = integrate(scene, detector, focus, BAND, accuracy)
        _, estimate = spectrum_of(field_of_paths(*light[:5], K, accuracy))
        assert error(light, truth, K) < estimate < accuracy


def test_a_point_needs_far_fewer_segments_than_the_tree() -> None:
    light = integrate(scene_of(CONFIG, 1.4), detector_of(CONFIG), 0.8824, BAND, 1e-4)
    assert light.segments < 11000  # 3000 rays: 215 302, with an error of 0.8 %


def test_light_that_misses_the_cylinder_is_named() -> None:
    scene, detector = scene_of(CONFIG, 2.0), detector_of(CONFIG)
    light = integrate(scene, detector, 3.5, BAND, 1e-4)
    assert light.status == AccuracyStatus.AT_AN_EDGE


def test_a_budget_that_does_not_suffice_is_named() -> None:
    scene, detector = scene_of(CONFIG, 1.4), detector_of(CONFIG)
    light = integrate(scene, detector, 0.8824, BAND, 1e-8, budget=2000)
    assert light.status == AccuracyStatus.BUDGET_SPENT
    assert np.isfinite(light.amplitude).all()
    assert light.missing > 0


def test_a_focus_beyond_the_objective_is_refused() -> None:
    with pytest.raises(ValueError, match="focus"):
        integrate(scene_of(CONFIG, 1.4), detector_of(CONFIG), 301.0, BAND, 1e-3)


def test_a_scene_that_is_not_symmetric_in_y_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Scene, "symmetry", Symmetry(x=True, y=False))
    with pytest.raises(ValueError, match="symmetric in y"):
        integrate(scene_of(CONFIG, 1.4), detector_of(CONFIG), 0.88, BAND, 1e-3)


def test_interpolating_paths_over_k_is_summing_their_rays() -> None:
    light = integrate(scene_of(CONFIG, 1.4), detector_of(CONFIG), 0.8824, BAND, 1e-4)
    for accuracy in (1e-3, 1e-6, 1e-10):
        spectrum, _ = spectrum_of(field_of_paths(*light[:5], K, accuracy))
        summed = intensity(light.amplitude, light.optical_path_length, K)
        assert np.abs(spectrum - summed).max() < 0.05 * accuracy * summed.max() + 1e-14


def test_rays_of_one_path_may_lie_far_apart() -> None:
    amplitude, lengths = np.array([1e-3, 2e-3, -1e-3]), np.array([0.5, 40.0, 190.0])
    spectrum, estimate = spectrum_of(
        field_of_paths(np.array([4, 4, 4]), amplitude, 0.99 * amplitude, lengths, 0.0, K, 1e-6)
    )
    assert np.allclose(spectrum, intensity(amplitude, lengths, K), atol=1e-14)
    assert estimate == pytest.approx(0.02, rel=0.02)


def test_the_error_of_a_spiral_of_rays_is_estimated_too() -> None:
    ratios = []
    for diameter in np.linspace(1, 2, 5):
        focus = 0.581 * diameter + 0.069
        light = Instrument(CONFIG).light(diameter, focus)
        assert light.status == AccuracyStatus.NOT_CONTROLLED
        spectrum, estimate, _ = Instrument(CONFIG).sum(light)
        scene = scene_of(CONFIG, diameter)
        truth = np.abs(field(integrate(scene, detector_of(CONFIG), focus, BAND, 1e-6), K)) ** 2
        ratios.append(estimate / (np.abs(spectrum - truth).max() / truth.max()))
    assert 1 < np.median(ratios) < 10
