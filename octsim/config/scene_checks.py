"""What no single key of a scene can tell: media without an index, and bodies that don't fit."""

import difflib
import itertools
import math
from collections.abc import Iterator
from typing import NamedTuple

from octsim.config.dispersion import described, material_of, span_of
from octsim.config.dispersion_forms import TableIndex
from octsim.config.following import fitted_diameters, scan_diameter
from octsim.config.models import Config
from octsim.config.scene import SWEPT, CylinderConfig, SceneConfig
from octsim.config.units import format_length
from octsim.optics.materials import Material, Sellmeier
from octsim.schemes.table import SCHEMES

_THESIS = ("glass", "water", "neuron")
_TRIED = 128  # steps over the band in which an index is looked at
_CONTACT = 1e-12  # relative rounding of lengths of bodies that touch


def impossible_scene(config: Config) -> Iterator[str]:
    """Return what is impossible of a plain config's scene, a line each."""
    scene = config.scene
    if wrong := [*_media(config), *_layers(config)] or [*_swept(scene), *_indices(config)]:
        yield from wrong
    else:
        yield from _sizes(config)


def _media(config: Config) -> Iterator[str]:
    scene, media = config.scene, config.media
    known, used = scene.refractive_index.given, set(media.values())
    for key, medium in media.items():
        if medium not in known:
            nearest = difflib.get_close_matches(medium, known, n=1, cutoff=0)[0]
            yield (
                f"{key}: {medium} given, which has no refractive index; give "
                f"scene.refractive_index.{medium}, or one that is known: the nearest is {nearest}"
            )
    for medium, index in known.items():
        if medium not in used and medium not in _THESIS:
            nearest = difflib.get_close_matches(medium, sorted(used), n=1, cutoff=0)[0]
            yield (
                f"scene.refractive_index.{medium}: {described(index)} given, but nothing in the "
                f"scene is of {medium}; name it in scene.layers or scene.cylinders, or leave it "
                f"out; the nearest name in use is {nearest}"
            )
    within = set(scene.media.values())
    for medium in scene.attenuation.of:
        if medium not in within:
            yield (
                f"scene.attenuation.{medium}: given, but nothing in the scene is of {medium}; "
                f"leave it out, or name one of {', '.join(sorted(within))}"
            )


def _indices(config: Config) -> Iterator[str]:
    """Say which dispersions of the scene are not known, or impossible, somewhere in the band."""
    given = config.scene.refractive_index.given
    beam, around = config.beam, config.scene.objective_medium
    known, one = span_of(given[around]) or (0.0, math.inf), beam.wavelength
    if beam.waist is not None and isinstance(one, float) and not known[0] <= one <= known[1]:
        yield (
            f"beam.wavelength: {format_length(one)} given, but scene.refractive_index.{around} is "
            f"known from {format_length(known[0])} to {format_length(known[1])}; give one within, "
            "or each"
        )
    ends = config.spectrum.wavelength
    shortest, longest = sorted((ends.min, ends.max))
    for medium in dict.fromkeys(config.media.values()):
        key, index = f"scene.refractive_index.{medium}", given[medium]
        material, span = material_of(index), span_of(index)
        if span and not (span[0] <= shortest and longest <= span[1]):
            told = f", which is known from {span[0]:.10g} um to {span[1]:.10g} um"
            of_table = isinstance(index, TableIndex)
            yield (
                f"{key}: {described(index)} given{'' if of_table else told}, but "
                f"spectrum.wavelength is from {shortest:.10g} um to {longest:.10g} um; "
                f"{_meant(span, shortest, longest) if of_table else ''}give a dispersion that "
                "spans the band, or a narrower band"
            )
        elif material.dispersive and (wrong := _impossible_index(material, shortest, longest)):
            wavelength, found = wrong
            yield (
                f"{key}: {described(index)} given, whose index is {found:.6g} at "
                f"{wavelength:.6g} um, in the band; it should be from 1 to 10 (wavelengths in um)"
            )


def _meant(span: tuple[float, float], shortest: float, longest: float) -> str:
    """Guess which unit the wavelengths of a table are in that is far from the band."""
    if span[0] < longest and span[1] > shortest:
        return ""
    for by, guess in ((1e-3, "nm, not um"), (1e3, "um, not nm"), (0.1, "angstrom, not nm")):
        if max(span[0] * by, shortest) < min(span[1] * by, longest):
            return f"are these {guess}? "
    return ""


def _impossible_index(
    material: Material, shortest: float, longest: float
) -> tuple[float, float] | None:
    """Return a wavelength (µm) of a band at which an index is beyond its limits, and the index."""
    tried = [2 * math.pi / k for k in _over_band(shortest, longest)]
    if isinstance(material, Sellmeier):
        # however narrow they are
        poles = (math.sqrt(c) for c in material.c if c > 0)
        tried = [pole for pole in poles if shortest <= pole <= longest] + tried
    for wavelength in tried:
        index = material.index(2 * math.pi / wavelength).real
        if not 1 <= index <= 10:
            return wavelength, index
    return None


def _over_band(shortest: float, longest: float) -> list[float]:
    """Return wavenumbers of a band between two wavelengths, µm, both ends included, 1/µm."""
    lowest, step = 2 * math.pi / longest, 2 * math.pi / shortest - 2 * math.pi / longest
    return [lowest + step * place / _TRIED for place in range(_TRIED)] + [2 * math.pi / shortest]


def least_index(config: Config, medium: str) -> float:
    """Return the smallest refractive index that a medium has in the band."""
    material, band = config.scene.refractive_index.of[medium], config.spectrum.wavelength
    if not material.dispersive:
        return material.index(config.spectrum.middle).real
    over = _over_band(*sorted((band.min, band.max)))
    return min(material.index(k).real for k in over)


def _layers(config: Config) -> Iterator[str]:
    scene = config.scene
    last = len(scene.layers) - 1
    for place, layer in enumerate(scene.layers):
        outer, key = place in (0, last), f"scene.layers.{place}"
        if place == last and layer.thickness is not None:
            yield f"{key}.thickness: given, but the highest layer has no end; leave it out"
        if place == 0 and layer.thickness is not None and config.objective.immersion is None:
            yield (
                f"{key}.thickness: given, but the lowest layer has no end; leave it out, or name "
                "in objective.immersion what is below it"
            )
        if not outer and layer.thickness is None:
            yield (
                f"{key}: {layer.medium} given, between two other layers; give its thickness, as "
                f"{{medium: {layer.medium}, thickness: 2 um}}"
            )
        if layer.thickness == SWEPT and scene.cylinders:
            yield (
                f"{key}.thickness: swept given beside cylinders; give it a length, or cylinders: []"
            )


def _swept(scene: SceneConfig) -> Iterator[str]:
    swept = scene.swept
    if len(swept) == 1:
        return
    what = ", ".join(swept) or "nothing"
    yield (
        f"scene: {what} to be swept; just one thing has no size of its own: a cylinder without "
        "diameter, or with cylinders: [] a layer with thickness: swept"
    )


class _Body(NamedTuple):
    """A cylinder at some diameter; all in µm."""

    key: str
    at: tuple[float, float, float]
    along: tuple[float, float, float]
    radius: float


def diameters_of(config: Config) -> dict[str, float]:
    """Return the diameters between which a run's are, µm, by the keys that ask for them."""
    sweep, law = config.sweep.diameters, fitted_diameters(config)
    return {
        "sweep.diameters.start": sweep.start, "sweep.diameters.stop": sweep.stop,
        "focus_law.diameters.start": law.start, "focus_law.diameters.stop": law.stop,
        "focus_scan.diameter": scan_diameter(config),
    }  # fmt: skip


def _sizes(config: Config) -> Iterator[str]:
    scene, diameters = config.scene, diameters_of(config)
    smallest = min(diameters.items(), key=lambda item: item[1])
    # cylinders on one plane that do not overlap at the largest do not at a smaller one
    largest = max(diameters.items(), key=lambda item: item[1])
    for place, cylinder in enumerate(scene.cylinders):
        key = f"scene.cylinders.{place}"
        own = (f"{key}.diameter", cylinder.diameter) if cylinder.diameter else None
        name, diameter = own or smallest
        thick = math.fsum(shell.thickness for shell in cylinder.shells)
        if thick >= diameter / 2:
            yield (
                f"{key}.shells: {format_length(thick)} thick together, but the radius by {name} is "
                f"{format_length(diameter / 2)}; give thinner shells or a larger diameter"
            )
        below = {one.medium for one in scene.layers[: scene.host + 1]}
        if cylinder.elevation and len(below) == 1:
            yield (
                f"{key}.elevation: given, but below it is nothing but {scene.host_medium}, as "
                "around it, so that it would end at no plane; give 0 deg, or another layer below"
            )
        layer = scene.layers[scene.host]
        name, diameter = own or largest
        top = scene.gap_of(cylinder) + diameter
        height = layer.thickness if isinstance(layer.thickness, float) else math.inf
        if not cylinder.elevation and top > (1 + _CONTACT) * height:
            yield (
                f"{key}: reaches {format_length(top)} above the lower plane of its layer (its gap "
                f"and {name}), through the upper one at {format_length(height)}; give "
                f"scene.layers.{scene.host}.thickness more, or a smaller diameter"
            )
    bodies = [_body(scene, place, largest[1]) for place in range(len(scene.cylinders))]
    for one, other in itertools.combinations(bodies, 2):
        apart, needed = _distance(one, other), one.radius + other.radius
        if apart < (1 - _CONTACT) * needed:
            yield (
                f"{other.key}: overlaps {one.key}: their axes are {apart:.6g} um apart and their "
                f"radii together {needed:.6g} um (at {largest[0]}); give another x, gap or azimuth"
            )


def _body(scene: SceneConfig, place: int, swept: float) -> _Body:
    cylinder = scene.cylinders[place]
    radius = (cylinder.diameter or swept) / 2
    a, e = cylinder.azimuth, cylinder.elevation
    return _Body(
        f"scene.cylinders.{place}",
        (cylinder.x, 0.0, scene.floor + scene.gap_of(cylinder) + radius),
        (-math.sin(a) * math.cos(e), math.cos(a) * math.cos(e), math.sin(e)),
        radius,
    )


def _distance(one: _Body, other: _Body) -> float:
    """Return how far two axes, without an end, are from each other."""
    between = [b - a for a, b in zip(one.at, other.at, strict=True)]
    normal = _cross(one.along, other.along)
    length = math.hypot(*normal)
    if length < 1e-9:
        return math.hypot(*_cross(between, one.along))
    return abs(sum(a * b for a, b in zip(between, normal, strict=True))) / length


def _cross(a: list[float] | tuple[float, ...], b: tuple[float, ...]) -> tuple[float, ...]:
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def scene_remarks(config: Config) -> Iterator[str]:
    """Say, a line each, what of a possible scene is likely not meant."""
    scene = config.scene
    for place, cylinder in enumerate(scene.cylinders):
        key = f"scene.cylinders.{place}"
        shells = len(cylinder.shells)
        if shells and 4 * shells + 5 > config.tracing.max_intersections:
            yield (
                f"tracing.max_intersections: {config.tracing.max_intersections}, but light that "
                f"returns from the far side of {key} meets {4 * shells + 5} surfaces; raise it"
            )
        if cylinder.elevation:
            yield _met(config, key, cylinder)
    aperture, index = config.objective.numerical_aperture, config.host_index
    rays = SCHEMES[config.tracing.scheme].light == "rays"
    if index < aperture and rays and not config.polarisation.given:
        yield (
            f"objective.numerical_aperture: {aperture} is above the index of {scene.host_medium}, "
            f"{index}, with polarisation.input: none: the thesis's split makes light off the plane "
            "too bright where the focus is off the law; give polarisation.input: unpolarised"
        )


def _met(config: Config, key: str, cylinder: CylinderConfig) -> str:
    radius = (cylinder.diameter or scan_diameter(config)) / 2
    lift = abs(math.tan(cylinder.elevation))
    below = config.scene.gap_of(cylinder) + radius - radius / math.cos(cylinder.elevation)
    return (
        f"{key}.elevation: {math.degrees(cylinder.elevation):.6g} deg, so the cylinder meets the "
        f"plane below it {max(0.0, below) / lift:.2g} um from the optical axis, and ends there"
    )
