"""The thesis's rays by the package and by the slow literal reference, set up as a config says."""

from collections.abc import Callable

import reference

from octsim.config.models import Config
from octsim.instrument.build import detector_of, scene_of
from octsim.optics.beam import Beam, vogel_beam
from octsim.tracing.tree import Detections, trace


def spiral(config: Config) -> Beam:
    """Return the thesis's spiral of rays."""
    detector = detector_of(config)
    return vogel_beam(config.tracing.rays, detector.objective_radius, detector.focus_distance)


def trace_spiral(config: Config) -> Callable[[float, float], Detections]:
    """Return the function of diameter and focus (µm) that traces the thesis's spiral."""
    beam, detector, tracing = spiral(config), detector_of(config), config.tracing

    def at(diameter: float, focus: float) -> Detections:
        scene = scene_of(config, diameter)
        return trace(scene, beam, detector, focus, tracing.max_intersections, tracing.min_amplitude)

    return at


def literal(config: Config, diameter: float, focus: float) -> reference.Traced:
    index, objective = config.scene.refractive_index, config.objective
    return reference.trace_all(
        reference.Scene(index.glass, index.water, index.neuron, config.scene.gap, diameter),
        reference.Instrument(
            objective.numerical_aperture,
            objective.focus_distance,
            objective.magnification,
            config.detector.core_diameter,
        ),
        reference.Settings(
            config.tracing.rays, config.tracing.max_intersections, config.tracing.min_amplitude
        ),
        focus,
    )
