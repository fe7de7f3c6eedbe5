"""What is simulated, at all wavenumbers and at one (for literal_effects)."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

Array = NDArray[Any]
Index = complex | Callable[[float], complex]
Falloff = (
    Literal["parabolic", "top_hat", "cosine"]
    | tuple[Literal["gaussian"], float | None]
    | tuple[Literal["fibre"], float]
)
GLASS, WATER, NEURON = 0, 1, 2
MEDIA = ("glass", "water", "neuron")


@dataclass(frozen=True)
class Setup:
    """The scene, the instrument and every effect; the defaults are the thesis's.

    Parameters
    ----------
    glass, water, neuron : complex or function of the wavelength in vacuum (µm)
        Refractive indices n + i kappa.
    diameter, gap, x : float
        Of the cylinder: its diameter, the water below it, and where its axis is.
    attenuation : mapping of "glass", "water", "neuron" to float
        Of intensity, in 1/µm, base e; a medium that is not named has none.
    polarisation : None or (input, analyser)
        None is the thesis's split. Input: None (unpolarised: the mean of two) or a Jones vector
        (x, y), taken as it is. Analyser: None or degrees from x to y, of the returned light.
    pupil : None, ("gaussian", fill) or ("fibre", mode-field diameter)
    apodisation : None or "aplanatic"
    zernike : mapping of Noll index to rms in µm
    zernike_rays : "normal" or "phase"
    focal_shift : None or (reference wavelength, linear, quadratic)
    falloff : "parabolic", "top_hat", "cosine", ("gaussian", mode-field diameter or None for 1/e at
        the core's radius), ("fibre", NA)
    waist : None, "diffraction" (lambda / pi NA) or a length
        Rulings of a Gaussian beam, of both families.
    waist_wavelength : "each" or one wavelength for all, of z_R with its index and its waist
    reference : None or (amplitude, one-way length)
        Under polarisation the reference arm returns the input's own Jones vector.
    """

    glass: Index = 1.52
    water: Index = 1.33
    neuron: Index = 1.39
    diameter: float = 1.4
    gap: float = 0.005
    x: float = 0.0
    numerical_aperture: float = 1.2
    focus_distance: float = 300.0
    magnification: float = 20.0
    core_diameter: float = 4.4
    focus: float = 0.877
    rays: int = 300
    max_intersections: int = 11
    attenuation: Mapping[str, float] = field(default_factory=dict)
    polarisation: tuple[tuple[complex, complex] | None, float | None] | None = None
    pupil: tuple[Literal["gaussian", "fibre"], float] | None = None
    apodisation: Literal["aplanatic"] | None = None
    zernike: Mapping[int, float] = field(default_factory=dict)
    zernike_rays: Literal["normal", "phase"] = "normal"
    focal_shift: tuple[float, float, float] | None = None
    falloff: Falloff = "parabolic"
    waist: Literal["diffraction"] | float | None = None
    waist_wavelength: Literal["each"] | float = "each"
    reference: tuple[float, float] | None = None

    def index(self, medium: str, wavelength: float) -> complex:
        """Return n + i kappa of a medium."""
        index = getattr(self, medium)
        return complex(index(wavelength) if callable(index) else index)

    def focus_at(self, wavelength: float) -> float:
        """Return z_f(lambda)."""
        if self.focal_shift is None:
            return self.focus
        lambda_0, linear, quadratic = self.focal_shift
        off = wavelength - lambda_0
        return self.focus + linear * off + quadratic * off**2


@dataclass(frozen=True)
class Colour:
    """What a set-up is at one wavenumber: n and mu are of glass, water and neuron."""

    k: float
    n: Array
    mu: Array
    focus: float
    aperture: float  # radius on the objective plane

    @classmethod
    def of(cls, setup: Setup, k: float) -> "Colour":
        """Look everything up at one wavenumber."""
        wavelength = 2 * np.pi / k
        index = np.array([setup.index(medium, wavelength) for medium in MEDIA])
        given = np.array([setup.attenuation.get(medium, 0.0) for medium in MEDIA])
        half_angle = np.arcsin(setup.numerical_aperture / index.real[GLASS])
        return cls(
            k,
            index.real,
            given + 4 * np.pi * index.imag / wavelength,
            setup.focus_at(wavelength),
            setup.focus_distance * np.tan(half_angle),
        )
