"""Light that one plane returns, in closed form: an integral over the aperture's squared radius."""

import math
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray
from scipy import integrate as quadrature

from octsim.optics.detector import Detector, fibre_detector
from octsim.optics.interface import cos_transmitted_squared, fresnel
from octsim.optics.materials import Constant, Material
from octsim.optics.scene import Plane, Region, Scene

APERTURE, GLASS, MAGNIFICATION = 0.5, 1.52, 20.0


def objective(aperture: float = APERTURE) -> Detector:
    return fibre_detector(aperture, GLASS, 300.0, MAGNIFICATION, 4.4)


def plane(beyond: Material) -> Scene:
    """Return a plane at z = 0, and a material above it."""
    glass = Region("glass", Constant(GLASS))
    return Scene(glass, (Plane("P", 0.0, glass, Region("beyond", beyond)),))


def returned(
    k: float, height: float, beyond: float, weigh: Callable[[float], float] | None = None
) -> complex:
    """Return the field that is detected for a focus at a height, µm, at a wavenumber, 1/µm.

    Light to a focus above the plane is returned from its mirror image, twice the height below.
    `weigh` is a factor on the amplitude, of the sine of its angle.
    """
    detector = objective()
    tangent = detector.objective_radius / detector.focus_distance

    def at(squared: float) -> complex:
        slope = math.sqrt(squared) * tangent
        cos, off = 1 / math.hypot(1, slope), 2 * height * slope
        lens = MAGNIFICATION * (math.hypot(detector.focal_length, off) - detector.focal_length)
        path = lens - 2 * height * GLASS / cos
        cos_t = math.sqrt(cos_transmitted_squared(GLASS, beyond, cos))
        amplitude = fresnel(GLASS, beyond, cos, cos_t)[0] * (1 - (off / detector.radius) ** 2)
        factor = weigh(slope * cos) if weigh else 1.0
        return amplitude * factor * complex(math.cos(k * path), math.sin(k * path))

    edge = min((detector.radius / (2 * height * tangent)) ** 2, 1.0) if height else 1.0
    return complex(quadrature.quad(at, 0, edge, complex_func=True)[0])


def fields(amplitude: NDArray[np.float64], length: NDArray[np.float64], k: NDArray[np.float64]) -> (
    NDArray[np.complex128]
):  # fmt: skip
    """Return the literal sum of rays at wavenumbers."""
    waves: NDArray[np.complex128] = np.exp(1j * np.outer(k, length)) @ amplitude
    return waves
