"""Points at which scheme paths once stated less than its error, beside dense grids of rays."""

import numpy as np
import pytest
from dense_grids import dense_field

from octsim.optics.detector import fibre_detector
from octsim.optics.materials import Constant
from octsim.optics.scene import neuron_on_glass
from octsim.schemes.light import AccuracyStatus
from octsim.schemes.paths.integrate import integrate
from octsim.schemes.paths.path_sum import field_of_paths

K = np.linspace(2e3 * np.pi / 900, 2e3 * np.pi / 650, 49)
THESIS = 1.52, 1.33, 1.39

# indices, gap, numerical aperture, core, diameter, focus, accuracy; lengths in µm
POINTS = {
    "two parts of a patch in a tile, thesis": (THESIS, 0.005, 1.2, 4.4, 1.0, 1.3, 1e-3),
    "two parts of a patch in a tile": (THESIS, 0.005, 0.9, 4.4, 2.0, 2.3, 1e-3),
    "a narrow part beside the main one": (
        (1.5118453, 1.3583031, 1.446), 0.0783451, 0.6921046, 3.18613, 1.399812, 1.558642, 5.9e-4,
    ),
    "a path that turns back beside its end": (
        THESIS, 0.1356908, 1.0998170, 3.8386362, 1.3225692, 1.5928188, 1.26e-5,
    ),
    "to and fro in steep light, known along one axis": (
        (1.5341829, 1.3572013, 1.3607079), 0.4572835, 1.2816481, 2.2102254, 2.2496124, 1.5702430,
        1.38e-3,
    ),
    "to and fro in steep light": (
        (1.4871783, 1.3351761, 1.4322906), 0.2839331, 1.3074378, 5.8790350, 1.1613098, 1.0757834,
        6.8e-3,
    ),
    "steep light of a thin gap": (
        (1.4986013, 1.3328956, 1.4221246), 0.3412785, 1.2471843, 8.1865665, 1.1243523, 1.1477852,
        2.1e-4,
    ),
    "a polynomial of few nodes that agrees with a coarser one": (
        (1.53938, 1.351511, 1.404443), 0.263334, 1.034933, 5.447757, 6.606796, 4.541418, 2.6e-5,
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", POINTS)
def test_an_accuracy_that_is_said_to_be_reached_is(name: str) -> None:
    (glass, water, neuron), gap, aperture, core, diameter, focus, accuracy = POINTS[name]
    scene = neuron_on_glass(Constant(glass), Constant(water), Constant(neuron), gap, diameter)
    detector = fibre_detector(aperture, glass, 300.0, 20.0, core)
    light = integrate(scene, detector, focus, (K[0], K[-1]), accuracy)
    field = field_of_paths(
        light.path, light.amplitude, light.rough_amplitude, light.optical_path_length,
        light.missing, K, accuracy,
    )  # fmt: skip
    dense = dense_field(scene, detector, focus, K, accuracy)
    truth = np.abs(dense.field) ** 2
    error = np.abs(np.abs(field.values) ** 2 - truth).max() / truth.max()
    assert 2 * dense.error / np.abs(dense.field).max() < 0.3 * accuracy
    assert light.status == AccuracyStatus.REACHED
    assert error < accuracy
