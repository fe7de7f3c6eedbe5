"""The scheme paths, as the table of schemes takes it."""

import numpy as np
from numpy.typing import NDArray

from octsim.optics.polarisation import jones_rows
from octsim.optics.scene import Scene
from octsim.schemes.light import Field, Light, LightAt, Optics, Options, Sampled
from octsim.schemes.paths.integrate import integrate
from octsim.schemes.paths.path_sum import field_of_paths
from octsim.schemes.paths.sampled_paths import light_of_paths, sampled_paths
from octsim.schemes.reference_arm import with_reference


def tracer(optics: Optics, options: Options) -> LightAt:
    """Return the function of scene and focus (µm) that integrates all light paths.

    Parameters
    ----------
    optics : Optics
    options : mapping
        ``accuracy``, largest error of the intensity over the largest intensity.
    """

    def plain(scene: Scene, focus: float) -> Light:
        return integrate(
            scene, optics.detector, focus, optics.band, options["accuracy"],
            optics.max_intersections,
        )  # fmt: skip

    def with_effects(scene: Scene, focus: float) -> Light | Sampled:
        find = sampled_paths if optics.sampled else light_of_paths
        return find(optics, scene, focus, options["accuracy"], scene.attenuates)

    thesis = optics.plain

    def light_at(scene: Scene, focus: float) -> Light | Sampled:
        return (plain if thesis and not scene.attenuates else with_effects)(scene, focus)

    return light_at


def field(
    light: Light | Sampled, wavenumber: NDArray[np.float64], optics: Optics, options: Options
) -> Field:
    """Return the field of all light paths, interpolated in k, and of a reference arm."""
    if isinstance(light, Sampled):
        found = light.field_at(wavenumber)
    else:
        found = field_of_paths(
            light.path, light.amplitude, light.rough_amplitude, light.optical_path_length,
            light.missing, wavenumber, options["accuracy"],
        )  # fmt: skip
    share = np.ones(1, np.complex128)
    if optics.effects.vectorial:
        share = jones_rows(optics.polarisation, 0.0).sum(axis=1)
    return with_reference(found, optics.effects.reference, wavenumber, share)
