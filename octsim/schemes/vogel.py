"""The scheme vogel: the thesis's spiral of rays, each followed through the whole tree."""

from collections.abc import Callable

import numpy as np

from octsim.config.models import Config
from octsim.optics.beam import vogel_beam
from octsim.optics.detector import detector_of
from octsim.optics.scene import neuron_on_glass
from octsim.schemes.light import AccuracyStatus, Light
from octsim.tracing.tree import Detections, trace


def vogel_tracer(config: Config) -> Callable[[float, float], Detections]:
    """Make the function of diameter and focus (µm) that traces the thesis's spiral of rays."""
    beam = vogel_beam(config.objective, config.tracing, config.scene.refractive_index.glass)
    detector, tracing = detector_of(config), config.tracing

    def at(diameter: float, focus: float) -> Detections:
        scene = neuron_on_glass(config.scene, diameter)
        return trace(scene, beam, detector, focus, tracing.max_intersections, tracing.min_amplitude)

    return at


def spiral_tracer(config: Config) -> Callable[[float, float], Light]:
    """Make the function of diameter and focus (µm) that gives the spiral's detected light.

    The rougher rule is every second ray: a spiral of half the rays.
    """
    trace_at = vogel_tracer(config)

    def at(diameter: float, focus: float) -> Light:
        found = trace_at(diameter, focus)
        return Light(
            found.path,
            found.amplitude,
            np.where(found.ray % 2 == 0, 2 * found.amplitude, 0.0),
            found.optical_path_length,
            0.0,
            found.segments,
            AccuracyStatus.NOT_CONTROLLED,
            found.outcomes,
        )

    return at
