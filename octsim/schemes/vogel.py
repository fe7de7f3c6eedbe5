"""The scheme vogel: the thesis's spiral of rays, each followed through the whole tree."""

import numpy as np
from numpy.typing import NDArray

from octsim.optics.beam import vogel_beam
from octsim.optics.polarisation import detected_fields
from octsim.optics.scene import Scene
from octsim.schemes.counted_over_band import light_of_spiral, sampled_spiral
from octsim.schemes.field_sum import field_of_rays
from octsim.schemes.light import (
    AccuracyStatus,
    Field,
    Light,
    LightAt,
    Optics,
    Options,
    Sampled,
)
from octsim.schemes.ray_trees import dropped_field
from octsim.schemes.reference_arm import with_reference
from octsim.tracing.tree import trace


def tracer(optics: Optics, options: Options) -> LightAt:
    """Return the function of scene and focus (µm) that traces the spiral.

    The rougher rule is every second ray: a spiral of half the rays.

    Parameters
    ----------
    optics : Optics
    options : mapping
        ``rays``, their number, and ``min_amplitude``, below which a ray is dropped.
    """
    detector = optics.detector
    beam = vogel_beam(options["rays"], detector.objective_radius, detector.focus_distance)

    def plain(scene: Scene, focus: float) -> Light:
        found = trace(
            scene, beam, detector, focus, optics.max_intersections, options["min_amplitude"]
        )
        return Light(
            found.path,
            found.amplitude,
            np.where(found.ray % 2 == 0, 2 * found.amplitude, 0.0),
            found.optical_path_length,
            dropped_field(found.outcomes, options),
            found.segments,
            AccuracyStatus.NOT_CONTROLLED,
            found.outcomes,
        )

    thesis = optics.plain

    def light_at(scene: Scene, focus: float) -> Light | Sampled:
        if thesis and not scene.attenuates:
            return plain(scene, focus)
        find = sampled_spiral if optics.sampled else light_of_spiral
        return find(optics, options, scene, focus, scene.attenuates)

    return light_at


def field(
    light: Light | Sampled, wavenumber: NDArray[np.float64], optics: Optics, _options: Options
) -> Field:
    """Return the field of the detected rays, summed one by one, and of a reference arm."""
    if isinstance(light, Sampled):
        found = light.field_at(wavenumber)
    else:
        found = field_of_rays(
            light.amplitude, light.rough_amplitude, light.optical_path_length, wavenumber
        )
        found = found._replace(error=found.error + light.missing)
    share = np.ones(1, np.complex128)
    if optics.effects.vectorial:
        share = detected_fields(optics.polarisation, np.eye(2, dtype=complex)[np.newaxis])[:, 0]
    return with_reference(found, optics.effects.reference, wavenumber, share)
