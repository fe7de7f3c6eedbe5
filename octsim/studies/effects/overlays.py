"""Overlays of a config that put an effect into it."""

import math
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from octsim.config.derive import nested
from octsim.config.dispersion import moved
from octsim.config.dispersion_forms import CauchyIndex
from octsim.config.models import Config
from octsim.config.scene_checks import diameters_of
from octsim.config.units import format_angle, format_length
from octsim.optics.shipped_materials import SHIPPED

Overlay = Mapping[str, Any]
OverlayOf = Callable[[Config], Overlay | None]
"""Returns what is laid over a config; None where its scene has no place for that."""

CHROMATIC = 0.1
"""By which the focus moves over the band, µm."""
WIDER = 1.1
"""How much larger the core of the fibre is, as a factor."""


def always(key: str, value: object) -> OverlayOf:
    """Give a key a value, whatever the config."""
    return lambda _: nested(key, value)


def dispersion(**materials: str) -> OverlayOf:
    """Disperse media of a scene that are constant, each with its index at the middle of the band.

    They are named by what they are in the scene: glass, water, neuron.
    """

    def overlay(config: Config) -> Overlay | None:
        scene, k = config.scene, config.spectrum.middle
        names = {
            "glass": scene.objective_medium, "water": scene.host_medium,
            "neuron": scene.swept_medium,
        }  # fmt: skip
        of = scene.refractive_index.of
        laid = {
            names[medium]: _dispersed(config, material, of[names[medium]].index(k).real)
            for medium, material in materials.items()
            if not of[names[medium]].dispersive
        }
        return nested("scene.refractive_index", laid) if laid else None

    return overlay


def _dispersed(config: Config, material: str, n: float) -> object:
    """Return a material's index that is n at the middle of the band."""
    index = _solution(config) if material == SOLUTION else material
    return moved(index, n, config.spectrum.middle)


def _solution(config: Config) -> CauchyIndex:
    """Return water by Cauchy's formula, to 1e-6 in the band.

    What is dissolved in it adds to its index about the same at all wavelengths (Gladstone and
    Dale), and `moved` does so to this form of it.
    """
    band, water = config.spectrum.wavelength, SHIPPED["water"].material
    wavelength = np.linspace(band.min, band.max, _FITTED)
    index = [water.index(2 * math.pi / one).real for one in wavelength.tolist()]
    terms = np.polynomial.Polynomial.fit(wavelength**-2, index, _DEGREE).convert().coef
    return CauchyIndex(cauchy=tuple(terms.tolist()))


SOLUTION = "solution"
"""Of a neuron: water whose index is raised by what is dissolved in it."""
_FITTED, _DEGREE = 41, 4  # wavelengths, and the power of 1/λ²


def attenuation(per_cm: float, *, around: bool) -> OverlayOf:
    """Attenuate light in what is swept, and around it if that is asked for."""

    def overlay(config: Config) -> Overlay:
        scene, taken = config.scene, config.scene.attenuation.of
        names = (scene.swept_medium, *((scene.host_medium,) if around else ()))
        total = {name: f"{taken.get(name, 0.0) + 1e-4 * per_cm:.12g} /um" for name in names}
        return nested("scene.attenuation", total)

    return overlay


def zernike(number: int, rms: float, **objective: str) -> OverlayOf:
    """Add an aberration by Noll's number, µm rms, with more keys of the objective."""

    def overlay(config: Config) -> Overlay:
        total = config.objective.zernike.of.get(number, 0.0) + rms
        return {"objective": {"zernike": {str(number): format_length(total)}, **objective}}

    return overlay


def other_immersion(by: float, thickness: str) -> OverlayOf:
    """Put an immersion below a slide, of an index that is higher by so much."""

    def overlay(config: Config) -> Overlay | None:
        known = config.scene.refractive_index.of
        if config.objective.immersion is not None or "immersion" in known:
            return None
        slide, *above = config.to_dict()["scene"]["layers"]
        return {
            "scene": {
                "refractive_index": {"immersion": config.objective_index + by},
                "layers": [{"medium": slide, "thickness": thickness}, *above],
            },
            "objective": {"immersion": "immersion"},
        }

    return overlay


def middle_wavelength(config: Config) -> str:
    """Return the wavelength of the middle of the band, to a nanometre."""
    return f"{2e3 * math.pi / config.spectrum.middle:.0f} nm"


def chromatic(config: Config) -> Overlay:
    """Let the focus be higher at longer wavelengths, by `CHROMATIC` over the band."""
    band = config.spectrum.wavelength
    linear = CHROMATIC / (band.max - band.min)
    shift = {"reference": middle_wavelength(config), "linear": f"{linear:.12g} um/um"}
    return nested("objective.focal_shift", shift)


def rulings(waist: str, each: bool) -> OverlayOf:
    """Make rays a Gaussian beam's rulings, of each wavelength or of that of mid-band."""

    def overlay(config: Config) -> Overlay:
        wavelength = "each" if each else middle_wavelength(config)
        return {"beam": {"waist": waist, "wavelength": wavelength}}

    return overlay


def wider_core(config: Config) -> Overlay:
    """Make the fibre's core wider."""
    return nested("detector.core_diameter", format_length(WIDER * config.detector.core_diameter))


def of_cylinder(**fields: object) -> OverlayOf:
    """Change the cylinder that is swept."""

    def overlay(config: Config) -> Overlay | None:
        section, place = config.scene.swept[0].rsplit(".", 1)
        return nested(f"{section}.{place}", fields) if section == "scene.cylinders" else None

    return overlay


def shell(medium: str, index: float, thickness: str) -> OverlayOf:
    """Put a shell around the cylinder that is swept, of a medium that the config has not."""
    shells = [{"medium": medium, "thickness": thickness}]

    def overlay(config: Config) -> Overlay | None:
        laid = of_cylinder(shells=shells)(config)
        if laid is None or medium in config.scene.refractive_index.of:
            return None
        return {"scene": {**laid["scene"], "refractive_index": {medium: index}}}

    return overlay


def neighbour(beside: float) -> OverlayOf:
    """Put a cylinder of the swept one's medium beside it, as thick as the sweep's middle.

    It is that far away (µm) from the thickest of the config; from a thinner one farther.
    """

    def overlay(config: Config) -> Overlay | None:
        scene, sweep = config.scene, config.sweep.diameters
        own = next((one for one in scene.cylinders if one.diameter is None), None)
        if own is None:
            return None
        thick, thickest = (sweep.start + sweep.stop) / 2, max(diameters_of(config).values())
        # both stand on one plane: centres at half their diameters
        apart = (thick + thickest) / 2 + beside
        lifted = (thickest - thick) / 2
        # both axes are parallel; x is where they cross the plane y = 0
        x = own.x + math.sqrt(apart**2 - lifted**2) / math.cos(own.azimuth)
        other = {
            "medium": own.medium, "diameter": format_length(thick), "x": format_length(x),
            "gap": format_length(scene.gap_of(own)), "azimuth": format_angle(own.azimuth),
        }  # fmt: skip
        return {"scene": {"cylinders": [*config.to_dict()["scene"]["cylinders"], other]}}

    return overlay


def cover(height: str) -> OverlayOf:
    """Put a second slide above the water, so high above the first."""

    def overlay(config: Config) -> Overlay | None:
        scene = config.scene
        if len(scene.layers) != 2 or not scene.cylinders:
            return None
        between = {"medium": scene.host_medium, "thickness": height}
        slide = config.to_dict()["scene"]["layers"][0]
        return nested("scene.layers", [slide, between, scene.objective_medium])

    return overlay


def polarised(state: object, analyser: object = None) -> OverlayOf:
    """Polarise the light that goes in, and maybe what is detected."""
    return always("polarisation", {"input": state, "analyser": analyser})
