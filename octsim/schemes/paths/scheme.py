"""The scheme paths, as the table of schemes takes it."""

import math

import numpy as np
from numpy.typing import NDArray

from octsim.optics.scene import Scene
from octsim.schemes.light import Field, Light, LightAt, Optics, Options, PointCost
from octsim.schemes.paths.integrate import integrate
from octsim.schemes.paths.path_sum import field_of_paths

RAY_BYTES = 32
"""Of the four numbers that are kept of a weighted ray."""


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


def field(light: Light, wavenumber: NDArray[np.float64], options: Options) -> Field:
    """Return the field of all light paths, each interpolated in k about its mean path."""
    return field_of_paths(
        light.path, light.amplitude, light.rough_amplitude, light.optical_path_length,
        light.missing, wavenumber, options["accuracy"],
    )  # fmt: skip


def cost(options: Options) -> PointCost:
    """Return what a point takes, by rates measured on one machine (`snakemake tradeoff`)."""
    digits = -math.log10(options["accuracy"])
    return PointCost(
        size=RAY_BYTES * 45 * 10 ** (0.18 * digits), seconds=4.7e-4 * 10 ** (0.145 * digits),
        paths=12, memory=0.0,
    )  # fmt: skip
