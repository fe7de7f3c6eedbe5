"""What a config asks of a scheme beyond the thesis's instrument, and whether the scheme can do it.

A default means the scheme's own way; only what a user gives is asked for.
"""

import math
from collections.abc import Iterator
from typing import NamedTuple

from octsim.config.fields import as_text
from octsim.config.models import Config
from octsim.config.scene import CylinderConfig
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
        pupil = config.to_dict()["objective"]["pupil"]
        yield Asked(Ability.PUPIL, "objective.pupil", as_text(pupil))
    if objective.apodisation is not None:
        yield Asked(Ability.APLANATIC, "objective.apodisation", objective.apodisation)
    for name in ("input", "analyser"):
        if (given := getattr(config.polarisation, name)) is not None:
            yield Asked(Ability.POLARISATION, f"polarisation.{name}", _written(given))
    scene = config.scene
    for medium, attenuation in scene.attenuation.of.items():
        if attenuation > 0:
            given = f"{attenuation:g} /um"
            yield Asked(Ability.ATTENUATION, f"scene.attenuation.{medium}", given)
    layers = [layer.medium for layer in scene.layers]
    if len(layers) > 2 or layers[0] == layers[1]:
        yield Asked(Ability.LAYERS, "scene.layers", as_text(layers))
    media = [cylinder.medium for cylinder in scene.cylinders]
    if len(media) != 1:
        ability = Ability.CYLINDERS if media else Ability.NO_CYLINDER
        yield Asked(ability, "scene.cylinders", as_text(media))
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


def _written(given: str | float) -> str:
    return given if isinstance(given, str) else f"{math.degrees(given):.10g} deg"


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
    if Ability.POLARISATION in asked:
        polarisation = type(polarisation)()
    cylinders = tuple(_without(asked, cylinder) for cylinder in scene.cylinders)
    scene = scene.model_copy(update={"cylinders": cylinders})
    return config.model_copy(
        update={"objective": objective, "polarisation": polarisation, "scene": scene}
    )


def _without(asked: set[Ability], cylinder: CylinderConfig) -> CylinderConfig:
    fields = {one: name for one, name in _OF_CYLINDERS.items() if one in asked}
    plain = CylinderConfig(medium=cylinder.medium)
    return cylinder.model_copy(update={name: getattr(plain, name) for name in fields.values()})
