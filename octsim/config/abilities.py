"""What a config asks of a scheme beyond the thesis's instrument, and whether the scheme can do it.

A default means the scheme's own way; only what a user gives is asked for.
"""

import math
from collections.abc import Iterator
from typing import NamedTuple

from octsim.config.dispersion import absorbs, described, without_absorption
from octsim.config.effects import ZernikeConfig, zernike_name
from octsim.config.fields import as_text
from octsim.config.mirror_plane import directions, mirrored_at
from octsim.config.models import Config
from octsim.config.scene import AttenuationConfig, CylinderConfig, RefractiveIndex
from octsim.optics.zernike import Aberration
from octsim.schemes.table import SCHEMES, Ability, Scheme


class Asked(NamedTuple):
    """Something that a config asks of its scheme."""

    ability: Ability
    key: str
    given: str


def asked_of_scheme(config: Config) -> Iterator[Asked]:
    """Return what a plain config asks of its scheme, with the keys that do."""
    objective = config.objective
    if objective.pupil not in (None, "uniform"):
        pupil = objective.model_dump(mode="json")["pupil"]
        yield Asked(Ability.PUPIL, "objective.pupil", as_text(pupil))
    if objective.apodisation is not None:
        yield Asked(Ability.APLANATIC, "objective.apodisation", objective.apodisation)
    yield from _effects(config)
    for name in ("input", "analyser"):
        if (given := getattr(config.polarisation, name)) is not None:
            yield Asked(Ability.POLARISATION, f"polarisation.{name}", _written(given))
    scene = config.scene
    for medium, attenuation in scene.attenuation.of.items():
        if attenuation > 0:
            given = f"{attenuation * 1e4:g} /cm"
            ability = _attenuation_of(config, medium)
            yield Asked(ability, f"scene.attenuation.{medium}", given)
    yield from _indices(config)
    layers = [layer.medium for layer in scene.layers]
    media = [cylinder.medium for cylinder in scene.cylinders]
    if media and (len(layers) > 2 or layers[0] == layers[1]):
        yield Asked(Ability.LAYERS, "scene.layers", as_text(layers))
    if len(media) > 1:
        yield Asked(Ability.CYLINDERS, "scene.cylinders", as_text(media))
    elif not media and len(set(layers)) > 1:
        yield Asked(Ability.PLATES, "scene.cylinders", as_text(media))
    elif not media:
        yield Asked(Ability.NO_CYLINDER, "scene.layers", as_text(layers))
    azimuths = [cylinder.azimuth for cylinder in scene.cylinders]
    if any(math.remainder(one - azimuths[0], math.pi) for one in azimuths[1:]):
        yield Asked(Ability.CROSSED, "scene.cylinders", directions(scene))
    if mirrored_at(scene) is None:
        yield Asked(Ability.UNMIRRORED, "scene.cylinders", directions(scene))
    for place, cylinder in enumerate(scene.cylinders):
        key = f"scene.cylinders.{place}"
        if cylinder.medium == scene.host_medium and not cylinder.shells:
            # the same material on both sides is no surface
            yield Asked(Ability.NO_CYLINDER, f"{key}.medium", cylinder.medium)
        if cylinder.x:
            yield Asked(Ability.OFF_AXIS, f"{key}.x", f"{cylinder.x:g} um")
        if cylinder.azimuth:
            yield Asked(Ability.AZIMUTH, f"{key}.azimuth", _written(cylinder.azimuth))
        if cylinder.elevation:
            yield Asked(Ability.ELEVATION, f"{key}.elevation", _written(cylinder.elevation))
        if cylinder.shells:
            shells = [shell.medium for shell in cylinder.shells]
            yield Asked(Ability.SHELLS, f"{key}.shells", as_text(shells))


def _effects(config: Config) -> Iterator[Asked]:
    objective, beam = config.objective, config.beam
    if objective.immersion is not None:
        yield Asked(Ability.ZERNIKE, "objective.immersion", objective.immersion)
    if objective.zernike.of:
        names = filter(None, map(zernike_name, objective.zernike.of))
        given = as_text(objective.model_dump(mode="json")["zernike"])
        terms = f"{given} ({', '.join(names)})".replace(" ()", "")
        yield Asked(Ability.ZERNIKE, "objective.zernike", terms)
        aberration = Aberration(tuple(objective.zernike.of.items()))
        if not aberration.turned(mirrored_at(config.scene) or 0.0).even[1]:
            yield Asked(Ability.ODD_ALONG, "objective.zernike", terms)
    if objective.focal_shift and objective.focal_shift.moves:
        shift = as_text(objective.model_dump(mode="json")["focal_shift"])
        yield Asked(Ability.FOCAL_SHIFT, "objective.focal_shift", shift)
    if config.detector.falloff != _FALLOFF:
        fibre = config.detector.falloff == "fibre"
        ability = Ability.FIBRE_FALLOFF if fibre else Ability.FALLOFF
        yield Asked(ability, "detector.falloff", config.detector.falloff)
    if beam.waist is not None:
        yield Asked(Ability.WAIST, "beam.waist", beam.model_dump(mode="json")["waist"])
    if (arm := config.interferometer.reference) and arm.amplitude:
        reference = as_text(config.interferometer.model_dump(mode="json")["reference"])
        yield Asked(Ability.REFERENCE, "interferometer.reference", reference)


def _indices(config: Config) -> Iterator[Asked]:
    given = config.scene.refractive_index.given
    for medium in _dispersive(config):
        key = f"scene.refractive_index.{medium}"
        yield Asked(Ability.DISPERSION, key, described(given[medium]))
        if absorbs(given[medium]):
            yield Asked(_attenuation_of(config, medium), f"{key}.table.kappa", "above zero")


def _attenuation_of(config: Config, medium: str) -> Ability:
    """Return what is asked for by attenuation in a medium."""
    around = config.scene.objective_medium, config.scene.host_medium
    return Ability.ATTENUATION_AROUND if medium in around else Ability.ATTENUATION


def _dispersive(config: Config) -> list[str]:
    """Return the media of the scene whose index depends on the wavenumber."""
    of = config.scene.refractive_index.of
    media = dict.fromkeys(config.scene.media.values())
    return [medium for medium in media if medium in of and of[medium].dispersive]


def _written(given: str | float) -> str:
    return given if isinstance(given, str) else f"{math.degrees(given):.10g} deg"


_FALLOFF = "parabolic"
_ATTENUATES = {Ability.ATTENUATION, Ability.ATTENUATION_AROUND}
_OF_CYLINDERS = {
    Ability.OFF_AXIS: "x",
    Ability.AZIMUTH: "azimuth",
    Ability.ELEVATION: "elevation",
    Ability.SHELLS: "shells",
}


def beyond_scheme(config: Config) -> Iterator[str]:
    """Say, a line each, what a plain config gives that its scheme can't do, and which one can."""
    scheme = SCHEMES[config.tracing.scheme]
    for ability, key, given in asked_of_scheme(config):
        if ability in scheme.honours:
            continue
        if ability is Ability.NO_CYLINDER:
            yield (
                f"{key}: {given} given, but the same material on both sides is no surface, and "
                "there is nothing to be swept; give what is swept another medium"
            )
            continue
        able = [name for name, other in SCHEMES.items() if ability in other.honours]
        instead = (
            f"give tracing.scheme: {' or '.join(able)}, or leave it out"
            if able
            else "no scheme does yet: leave it out"
        )
        yield (
            f"{key}: {given} given, but tracing.scheme: {scheme.name} {ability.value}; {instead}"
        )


def as_far_as(scheme: Scheme, config: Config) -> Config:
    """Return a config, not checked, without what a scheme can't do of what it asks for.

    For light by another scheme than the run's, beside its own.
    """
    asked = {one.ability for one in asked_of_scheme(config)} - scheme.honours
    objective, polarisation, scene = config.objective, config.polarisation, config.scene
    if Ability.PUPIL in asked:
        objective = objective.model_copy(update={"pupil": None})
    if Ability.APLANATIC in asked:
        objective = objective.model_copy(update={"apodisation": None})
    if {Ability.ZERNIKE, Ability.ODD_ALONG} & asked:
        objective = objective.model_copy(update={"zernike": ZernikeConfig()})
    if Ability.FOCAL_SHIFT in asked:
        objective = objective.model_copy(update={"focal_shift": None})
    if Ability.POLARISATION in asked:
        polarisation = type(polarisation)()
    beam, detector, interferometer = config.beam, config.detector, config.interferometer
    if Ability.WAIST in asked:
        beam = type(beam)()
    if {Ability.FALLOFF, Ability.FIBRE_FALLOFF} & asked:
        detector = detector.model_copy(update={"falloff": _FALLOFF})
    if Ability.REFERENCE in asked:
        interferometer = type(interferometer)()
    cylinders = tuple(_without(asked, cylinder) for cylinder in scene.cylinders)
    scene = scene.model_copy(
        update={
            "cylinders": cylinders,
            "refractive_index": _indices_for(asked, config),
            "attenuation": AttenuationConfig() if _ATTENUATES & asked else scene.attenuation,
        }
    )
    return config.model_copy(
        update={
            "objective": objective, "polarisation": polarisation, "scene": scene, "beam": beam,
            "detector": detector, "interferometer": interferometer,
        }
    )  # fmt: skip


def _indices_for(asked: set[Ability], config: Config) -> RefractiveIndex:
    """Return the indices of a config, constants of the middle of the band where they must be."""
    indices, k = config.scene.refractive_index, config.spectrum.middle
    given = dict(indices)
    media = _dispersive(config)
    if Ability.DISPERSION in asked:
        plain = {medium: indices.of[medium].index(k).real for medium in media}
    elif _ATTENUATES & asked:
        plain = {medium: without_absorption(given[medium]) for medium in media}
    else:
        return indices
    return RefractiveIndex.model_validate({**given, **plain})


def _without(asked: set[Ability], cylinder: CylinderConfig) -> CylinderConfig:
    if {Ability.UNMIRRORED, Ability.CROSSED} & asked:
        asked = asked | {Ability.AZIMUTH, Ability.ELEVATION}
    fields = {one: name for one, name in _OF_CYLINDERS.items() if one in asked}
    plain = CylinderConfig(medium=cylinder.medium)
    return cylinder.model_copy(update={name: getattr(plain, name) for name in fields.values()})
