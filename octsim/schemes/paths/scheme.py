"""The scheme paths, as the table of schemes takes it."""

import numpy as np
from numpy.typing import NDArray

from octsim.optics.scene import Scene
from octsim.schemes.light import Field, Light, LightAt, Optics, Options
from octsim.schemes.paths.integrate import integrate
from octsim.schemes.paths.path_sum import field_of_paths


def tracer(optics: Optics, options: Options) -> LightAt:
    """Return the function of scene and focus (µm) that integrates all light paths.

    Parameters
    ----------
    optics : Optics
    options : mapping
        ``accuracy``, largest error of the intensity over the largest intensity.
    """

    def light_at(scene: Scene, focus: float) -> Light:
        return integrate(
            scene, optics.detector, focus, optics.band, options["accuracy"],
            optics.max_intersections,
        )  # fmt: skip

    return light_at


def field(
    light: Light, wavenumber: NDArray[np.float64], _optics: Optics, options: Options
) -> Field:
    """Return the field of all light paths, each interpolated in k about its mean path."""
    return field_of_paths(
        light.path, light.amplitude, light.rough_amplitude, light.optical_path_length,
        light.missing, wavenumber, options["accuracy"],
    )  # fmt: skip
