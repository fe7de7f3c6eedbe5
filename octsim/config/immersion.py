"""The objective's immersion where it is of another medium than the slide: what that does."""

from collections.abc import Iterator

from octsim.base.remembered import remembered
from octsim.config.models import Config
from octsim.config.scene import SWEPT
from octsim.config.scene_checks import least_index
from octsim.config.units import format_length
from octsim.optics.slide import SlideAberration, slide_aberration

_KEY, _SLIDE = "objective.immersion", "scene.layers.0"
_MOST_LEFT_OUT = 0.002  # of the shortest wavelength: rms of what Zernike terms don't have


@remembered
def of_slide(config: Config) -> SlideAberration | None:
    """Return the aberration of a plain config's slide, of indices in the middle of the band.

    None where the immersion is that of the slide, as in the thesis.
    """
    immersion, thickness = config.objective.immersion, config.scene.layers[0].thickness
    if immersion is None or not isinstance(thickness, float):
        return None
    before = config.scene.refractive_index.of[immersion].index(config.spectrum.middle).real
    return slide_aberration(
        config.objective.numerical_aperture, before, config.objective_index, thickness
    )


def aberration_terms(config: Config) -> tuple[tuple[int, float], ...]:
    """Return Zernike terms of a plain config by Noll's numbers, µm rms: objective's and slide's."""
    slide = of_slide(config)
    return (*config.objective.zernike.of.items(), *(slide.terms if slide else ()))


def impossible_immersion(config: Config) -> Iterator[str]:
    """Return what is impossible of an immersion and its slide, of possible media, a line each."""
    immersion, slide = config.objective.immersion, config.scene.layers[0]
    if immersion is None:
        return
    if not isinstance(slide.thickness, float):
        given = "is swept" if slide.thickness == SWEPT else "has no thickness"
        yield (
            f"{_KEY}: {immersion} given, but the slide above it, {_SLIDE}, {given}; give it as "
            f"{{medium: {slide.medium}, thickness: 170 um}}"
        )
        return
    aperture = config.objective.numerical_aperture
    index = least_index(config, immersion)
    if not aperture < index:
        yield (
            f"objective.numerical_aperture: {aperture} given; it must be below the index of "
            f"{immersion}, the immersion, scene.refractive_index.{immersion} = {index}"
        )
        return
    found, shortest = of_slide(config), config.spectrum.wavelength.min
    if found and found.remainder > _MOST_LEFT_OUT * shortest:
        yield (
            f"{_KEY}: {immersion} given under {format_length(slide.thickness)} of {slide.medium}, "
            f"which aberrates by {found.rms:.3g} um rms, {found.remainder:.2g} um of it finer "
            "than Zernike terms of the tenth degree; an objective that is corrected for its slide "
            "is one without objective.immersion"
        )
