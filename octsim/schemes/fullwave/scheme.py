"""The scheme fullwave, as the table of schemes takes it."""

import numpy as np
from numpy.typing import NDArray

from octsim.base.errors import OctsimError
from octsim.optics.polarisation import jones_rows
from octsim.optics.scene import Plane, Scene
from octsim.optics.zernike import Aberration
from octsim.schemes.fullwave.cylinder_on_plane import azimuth_of, cylinders_of
from octsim.schemes.fullwave.illumination import Wavefront
from octsim.schemes.fullwave.operators import Operators
from octsim.schemes.fullwave.plates import solve_plates, stack_of
from octsim.schemes.fullwave.series import over_band
from octsim.schemes.fullwave.solve import Place, Point, solve
from octsim.schemes.light import Field, LightAt, Optics, Options, Waves
from octsim.schemes.reference_arm import with_reference
from octsim.schemes.tables_of_indices import phase_left_out

_PUPIL = np.linspace(-0.7, 0.7, 15)


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
        By the function, if the scene is another than one cylinder over one plane, or plates, or
        the numerical aperture is not below the index around the cylinder.
    """
    return sharing(optics, options, Operators())


def sharing(optics: Optics, options: Options, operators: Operators) -> LightAt:
    """Return such a function whose operators others share, as of another pupil."""
    middle = sum(optics.band) / 2

    def plates_at(scene: Scene, focus: float) -> Waves:
        wavefront = wavefront_by(optics.effects.aberration, 0.0)
        return solve_plates(
            lambda k: (stack_of(scene, k), optics.focus_at(focus, k)),
            optics.pupil, optics.numerical_aperture, optics.band, options["accuracy"], wavefront,
        )  # fmt: skip

    def light_at(scene: Scene, focus: float) -> Waves:
        if all(isinstance(surface, Plane) for surface in scene.surfaces):
            return plates_at(scene, focus)
        azimuth = azimuth_of(scene)

        def place_at(wavenumber: float) -> Place:
            first, *others = cylinders_of(scene, wavenumber)
            return Place(first, optics.focus_at(focus, wavenumber), tuple(others))

        numbers, height, others = place_at(middle)
        if not optics.numerical_aperture < numbers.n_water:
            raise OctsimError(
                f"objective.numerical_aperture: {optics.numerical_aperture:g} given, but scheme "
                "fullwave has no light that decays around the cylinder; give one below the index "
                f"there, {numbers.n_water:g}, or tracing.scheme: paths"
            )
        absorbs = any(one.absorbs for one in (numbers, *others))
        point = Point(
            numbers, optics.pupil, optics.numerical_aperture, height,
            place_at if optics.scene_varies or absorbs else None,
            wavefront_by(optics.effects.aberration, azimuth),
            lambda number: phase_left_out(scene, optics.detector, height, *optics.band, number),
            others,
        )  # fmt: skip
        found = solve(point, optics.band, options["accuracy"], operators)
        return found._replace(azimuth=azimuth)

    return light_at


def wavefront_by(aberration: Aberration | None, azimuth: float) -> Wavefront | None:
    """Return an aberration in the frame of a cylinder at an angle from the y axis, rad.

    Raises
    ------
    OctsimError
        If it is not even along the cylinder.
    """
    if aberration is None:
        return None
    turn_cos, turn_sin = np.cos(azimuth), np.sin(azimuth)

    def wavefront(px: NDArray[np.float64], py: NDArray[np.float64]) -> NDArray[np.float64]:
        return aberration.wavefront(px * turn_cos - py * turn_sin, px * turn_sin + py * turn_cos)

    px, py = np.meshgrid(_PUPIL, _PUPIL)
    there, mirrored = wavefront(px, py), wavefront(px, -py)
    if not np.abs(there - mirrored).max() <= 1e-9 * np.abs(there).max():
        raise OctsimError(
            "objective.zernike: not even along the cylinder, which scheme fullwave takes for "
            "granted; leave out the terms that are odd in y, or give tracing.scheme: vogel"
        )
    return wavefront


def field(
    light: Waves, wavenumber: NDArray[np.float64], optics: Optics, _options: Options
) -> Field:
    """Return the detected fields, by the Chebyshev series through both polarisations' nodes."""
    rows = jones_rows(optics.polarisation, light.azimuth)
    fields = over_band(light, light.values, wavenumber)
    values = rows[:, :1] * fields[0] + rows[:, 1:] * fields[1]
    weight = np.sqrt((np.abs(rows).sum(axis=1) ** 2).mean())
    found = Field(values, float(weight) * light.error)
    return with_reference(found, optics.effects.reference, wavenumber, rows.sum(axis=1))
