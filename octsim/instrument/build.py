"""A config as optics: its scene, its objective and its detector. It becomes that nowhere else."""

from __future__ import annotations

from typing import TYPE_CHECKING

from octsim.optics.detector import Detector, fibre_detector
from octsim.optics.materials import Constant
from octsim.optics.pupil import FibrePupil, Pupil
from octsim.optics.scene import NEURON_ON_GLASS, Scene, neuron_on_glass
from octsim.schemes.light import Optics

if TYPE_CHECKING:
    # what light is traced through follows from values of the config, not from how it is read
    from octsim.config.models import Config


def detector_of(config: Config) -> Detector:
    """Return the objective as a receiver, and the fibre."""
    objective = config.objective
    return fibre_detector(
        objective.numerical_aperture, config.scene.refractive_index.glass,
        objective.focus_distance, objective.magnification, config.detector.core_diameter,
    )  # fmt: skip


def scene_of(config: Config, diameter: float) -> Scene:
    """Return the scene with a neuron of a diameter, µm."""
    index = config.scene.refractive_index
    return neuron_on_glass(
        Constant(index.glass), Constant(index.water), Constant(index.neuron), config.scene.gap,
        diameter,
    )  # fmt: skip


def surface_names(config: Config) -> tuple[str, ...]:  # noqa: ARG001
    """Return the short names of the scene's surfaces, of which those of light paths are made."""
    return NEURON_ON_GLASS


def pupil_of(config: Config) -> Pupil:
    """Return what weighs the light over the pupil: the fibre's mode, seen at the magnification."""
    return FibrePupil(5.0, config.objective.magnification)


def most_nodes(config: Config) -> int:
    """Return the most wavenumbers at which the field of any diameter of the sweep is solved."""
    # here, as rays need none of it
    from octsim.schemes.fullwave.cylinder_on_plane import cylinder_on_plane
    from octsim.schemes.fullwave.orders import most_nodes

    largest = cylinder_on_plane(scene_of(config, config.sweep.diameters.stop))
    return most_nodes(largest, optics_of(config).band, config.tracing.accuracy)


def optics_of(config: Config) -> Optics:
    """Return what every scheme works with."""
    k = config.spectrum.wavenumbers()
    band = float(k[0]), float(k[-1])
    objective = config.objective
    return Optics(
        detector_of(config), band, config.tracing.max_intersections,
        objective.numerical_aperture, pupil_of(config),
    )  # fmt: skip
