"""The scheme paths, as the table of schemes takes it."""

import numpy as np
from numpy.typing import NDArray

from octsim.base.errors import OctsimError
from octsim.optics.mirror_plane import mirror_azimuth
from octsim.optics.polarisation import jones_rows
from octsim.optics.scene import Scene
from octsim.schemes.light import Field, Light, LightAt, Optics, Options, Sampled
from octsim.schemes.paths.integrate import integrate
from octsim.schemes.paths.path_sum import field_of_paths
from octsim.schemes.paths.sampled_paths import light_of_paths, sampled_paths
from octsim.schemes.reference_arm import with_reference


def tracer(optics: Optics, options: Options) -> LightAt:
    """Return the function of scene and focus (µm) that integrates all light paths.

    A scene is solved in the axes in which it is its own mirror image in the plane y = 0.

    Parameters
    ----------
    optics : Optics
    options : mapping
        ``accuracy``, largest error of the intensity over the largest intensity.

    Raises
    ------
    OctsimError
        By the function, if there are no such axes.
    """

    def plain(scene: Scene, focus: float) -> Light:
        return integrate(
            scene, optics.detector, focus, optics.band, options["accuracy"],
            optics.max_intersections,
        )  # fmt: skip

    def with_effects(scene: Scene, focus: float, angle: float) -> Light | Sampled:
        find = sampled_paths if optics.sampled else light_of_paths
        return find(optics.turned(angle), scene, focus, options["accuracy"], scene.attenuates)

    thesis = optics.plain

    def light_at(scene: Scene, focus: float) -> Light | Sampled:
        angle = mirror_azimuth(scene)
        if angle is None:
            raise OctsimError(
                "scene.cylinders: not their own mirror image in any plane through the optical "
                "axis, as scheme paths needs; give tracing.scheme: vogel"
            )
        mirrored = scene.turned(angle)
        if thesis and not scene.attenuates:
            return plain(mirrored, focus)
        return with_effects(mirrored, focus, angle)

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
