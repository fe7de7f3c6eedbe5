"""The slow literal reference, set up as a config says."""

import reference

from octsim.config.models import Config


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
