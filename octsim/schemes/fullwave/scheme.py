"""The scheme fullwave, as the table of schemes takes it."""

import numpy as np
from numpy.typing import NDArray

from octsim.optics.scene import Scene
from octsim.schemes.fullwave.cylinder_on_plane import cylinder_on_plane
from octsim.schemes.fullwave.operators import Operators
from octsim.schemes.fullwave.series import over_band
from octsim.schemes.fullwave.solve import solve
from octsim.schemes.light import Field, LightAt, Optics, Options, Waves


def tracer(optics: Optics, options: Options) -> LightAt:
    """Return the function of scene and focus (µm) that solves Maxwell's equations.

    Parameters
    ----------
    optics : Optics
    options : mapping
        ``accuracy``, largest error of the intensity over the largest intensity.
    """
    operators = Operators()

    def light_at(scene: Scene, focus: float) -> Waves:
        return solve(
            cylinder_on_plane(scene), optics.pupil, optics.numerical_aperture, focus, optics.band,
            options["accuracy"], operators,
        )  # fmt: skip

    return light_at


def field(
    light: Waves, wavenumber: NDArray[np.float64], _optics: Optics, _options: Options
) -> Field:
    """Return the fields of both polarisations, by the Chebyshev series through their nodes."""
    return Field(over_band(light, light.values, wavenumber), light.error)
