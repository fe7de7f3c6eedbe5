"""The objective's immersion where it is of another medium than the slide: what that does."""

import math
from collections.abc import Iterator

from octsim.base.remembered import remembered
from octsim.config.dispersion import absorbs
from octsim.config.models import Config
from octsim.config.scene import SWEPT
from octsim.config.scene_checks import least_index
from octsim.config.units import format_length
from octsim.optics.slide import SlideAberration, slide_aberration

_KEY, _SLIDE = "objective.immersion", "scene.layers.0"
_FOCUS_MOVES = 0.05  # µm
_MOST_LEFT_OUT = 0.002  # waves


@remembered
def of_slide(config: Config) -> SlideAberration | None:
    """Return the aberration of a plain config's slide, of indices in the middle of the band.

    None where the immersion is that of the slide, as in the thesis.
    """
    return _at(config, config.spectrum.middle)


def aberration_terms(config: Config) -> tuple[tuple[int, float], ...]:
    """Return Zernike terms of a plain config by Noll's numbers, µm rms: objective's and slide's."""
    slide = of_slide(config)
    return (*config.objective.zernike.of.items(), *(slide.terms if slide else ()))


def immersion_disperses(config: Config) -> bool:
    """Return whether the aberration of a plain config's slide follows from the band."""
    immersion = config.objective.immersion
    return immersion is not None and config.scene.refractive_index.of[immersion].dispersive


def _at(config: Config, k: float) -> SlideAberration | None:
    immersion, thickness = config.objective.immersion, config.scene.layers[0].thickness
    if immersion is None or not isinstance(thickness, float):
        return None
    before = config.scene.refractive_index.of[immersion].index(k).real
    slide = config.objective_material.index(k).real
    if before == slide:
        return None
    return slide_aberration(config.objective.numerical_aperture, before, slide, thickness)


def impossible_immersion(config: Config) -> Iterator[str]:
    """Return what is impossible of an immersion and its slide, of possible media, a line each."""
    immersion, scene = config.objective.immersion, config.scene
    slide = scene.layers[0]
    if immersion is None:
        return
    if not isinstance(slide.thickness, float):
        given = "is swept" if slide.thickness == SWEPT else "has no thickness"
        yield (
            f"{_KEY}: {immersion} given, but the slide above it, {_SLIDE}, {given}; give it as "
            f"{{medium: {slide.medium}, thickness: 170 um}}"
        )
        return
    distance, thickness = config.objective.focus_distance, format_length(slide.thickness)
    if not slide.thickness < distance:
        yield (
            f"{_SLIDE}.thickness: {thickness} given; the slide must be thinner than "
            f"objective.focus_distance = {format_length(distance)}"
        )
    aperture, index = config.objective.numerical_aperture, least_index(config, immersion)
    if not aperture < index:
        yield (
            f"objective.numerical_aperture: {aperture} given; it must be below the index of "
            f"{immersion}, the immersion, scene.refractive_index.{immersion} = {index}"
        )
    for medium in dict.fromkeys((immersion, slide.medium)):
        if scene.attenuation.of.get(medium) or absorbs(scene.refractive_index.given[medium]):
            yield (
                f"{_KEY}: {immersion} given, but {medium} attenuates, whose way below the scene is "
                f"not that of an objective in {slide.medium}; leave its attenuation out"
            )


def immersion_remarks(config: Config) -> Iterator[str]:
    """Say, a line each, what of a possible immersion is likely not meant, or is left out."""
    slide, band = of_slide(config), config.spectrum.wavelength
    if slide is None:
        return
    shortest, longest = band.min, band.max
    below = f"{_KEY}: {config.objective.immersion} below a slide of {config.scene.objective_medium}"
    if slide.remainder > _MOST_LEFT_OUT * shortest:
        yield (
            f"{below} aberrates by {slide.rms:.3g} um rms, of which {slide.remainder:.2g} um is "
            "finer than Zernike terms of the tenth degree, and left out"
        )
    ends = (_at(config, 2 * math.pi / one) for one in (shortest, longest))
    short, long = (one.focus if one else 0.0 for one in ends)
    if abs(long - short) > _FOCUS_MOVES:
        yield (
            f"{below} moves the focus by {long - short:+.2g} um from the shortest to the "
            "longest wavelength, as they disperse differently; that is left out: give it as "
            "objective.focal_shift"
        )
