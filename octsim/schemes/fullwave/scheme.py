"""The scheme fullwave, as the table of schemes takes it."""

import numpy as np
from numpy.typing import NDArray

from octsim.base.errors import OctsimError
from octsim.optics.polarisation import jones_rows
from octsim.optics.scene import Scene
from octsim.schemes.fullwave.cylinder_on_plane import azimuth_of, cylinder_on_plane
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

    Raises
    ------
    OctsimError
        By the function, if the scene is another than one cylinder over one plane, or the numerical
        aperture is not below the index around the cylinder.
    """
    return sharing(optics, options, Operators())


def sharing(optics: Optics, options: Options, operators: Operators) -> LightAt:
    """Return such a function whose operators others share, as of another pupil."""

    def light_at(scene: Scene, focus: float) -> Waves:
        numbers = cylinder_on_plane(scene)
        if not optics.numerical_aperture < numbers.n_water:
            raise OctsimError(
                f"objective.numerical_aperture: {optics.numerical_aperture:g} given, but scheme "
                "fullwave has no light that decays around the cylinder; give one below the index "
                f"there, {numbers.n_water:g}, or tracing.scheme: paths"
            )
        found = solve(
            numbers, optics.pupil, optics.numerical_aperture, focus, optics.band,
            options["accuracy"], operators,
        )  # fmt: skip
        return found._replace(azimuth=azimuth_of(scene))

    return light_at


def field(
    light: Waves, wavenumber: NDArray[np.float64], optics: Optics, _options: Options
) -> Field:
    """Return the detected fields, by the Chebyshev series through both polarisations' nodes."""
    rows = jones_rows(optics.polarisation, light.azimuth)
    fields = over_band(light, light.values, wavenumber)
    values = rows[:, :1] * fields[0] + rows[:, 1:] * fields[1]
    weight = np.sqrt((np.abs(rows).sum(axis=1) ** 2).mean())
    return Field(values, float(weight) * light.error)
