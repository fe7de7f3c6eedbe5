"""A config as optics: its scene, its objective and its detector. It becomes that nowhere else."""

from __future__ import annotations

from typing import TYPE_CHECKING

from octsim.optics.detector import Detector, fibre_detector
from octsim.optics.materials import Constant
from octsim.optics.polarisation import LEFT, RIGHT, Polarisation, linear
from octsim.optics.pupil import FibrePupil, GaussianPupil, Pupil, UniformPupil
from octsim.optics.scene import NEURON_ON_GLASS, Scene, neuron_on_glass
from octsim.schemes.light import Optics

if TYPE_CHECKING:
    # what light is traced through follows from values of the config, not from how it is read
    from octsim.config.models import Config


def detector_of(config: Config) -> Detector:
    """Return the objective as a receiver, and the fibre."""
    objective = config.objective
    return fibre_detector(
        objective.numerical_aperture, config.scene.objective_index,
        objective.focus_distance, objective.magnification, config.detector.core_diameter,
    )  # fmt: skip


def scene_of(config: Config, diameter: float) -> Scene:
    """Return the scene of a slide and a cylinder, the only one that schemes have, µm.

    Parameters
    ----------
    config : Config
        A plain one.
    diameter : float
        Of the cylinder, µm.
    """
    scene = config.scene
    (cylinder,) = scene.cylinders
    return neuron_on_glass(
        Constant(scene.objective_index), Constant(scene.host_index), Constant(scene.swept_index),
        scene.swept_gap, diameter, cylinder.x, cylinder.azimuth,
    )  # fmt: skip


def surface_names(config: Config) -> tuple[str, ...]:  # noqa: ARG001
    """Return the short names of the scene's surfaces, of which those of light paths are made."""
    return NEURON_ON_GLASS


def pupil_of(config: Config) -> Pupil:
    """Return the pupil: the one that a config gives, or its scheme's own."""
    match config.pupil:
        case object(gaussian=fill):
            return GaussianPupil(fill)
        case object(fibre=mode_field_diameter):
            return FibrePupil(mode_field_diameter, config.objective.magnification)
        case _:
            return UniformPupil()


def polarisation_of(config: Config) -> Polarisation:
    """Return the polarisation that goes in and is detected; unpolarised where none is given."""
    given, analyser = config.polarisation.input, config.polarisation.analyser
    if given is None or given == "unpolarised":
        return Polarisation(None, analyser)
    state = {"left": LEFT, "right": RIGHT}[given] if isinstance(given, str) else linear(given)
    return Polarisation(state, analyser)


def optics_of(config: Config) -> Optics:
    """Return what every scheme works with."""
    k = config.spectrum.wavenumbers()
    band = float(k[0]), float(k[-1])
    objective = config.objective
    return Optics(
        detector_of(config), band, config.tracing.max_intersections,
        objective.numerical_aperture, pupil_of(config), polarisation_of(config),
    )  # fmt: skip
