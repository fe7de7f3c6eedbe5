"""Configs with an effect and without it, as far as a scheme has it."""

from collections.abc import Iterator, Sequence
from enum import IntEnum
from typing import Any, NamedTuple

from octsim.base.errors import ConfigError
from octsim.config.abilities import asked_of_scheme
from octsim.config.checks import impossible
from octsim.config.derive import merge, overlap, validated
from octsim.config.models import Config
from octsim.config.scene import RefractiveIndex
from octsim.config.scheme import scheme_of
from octsim.schemes.table import SCHEMES, Ability, Scheme
from octsim.studies.effects.kinds import EFFECTS, Effect
from octsim.studies.effects.switches import is_on, without

CONFIGURED = " as configured"
"""Ends the names of effects that a config already has."""


class EffectStatus(IntEnum):
    """Whether an effect's change is measured, and why not."""

    MEASURED = 0
    NOT_BY_THIS_SCHEME = 1
    """The scheme does not honour it; `able_schemes` names those that do."""
    AS_CONFIGURED = 2
    """The config, or its scheme by itself, has this one, or another that excludes it: what is on
    has a row of its own, with what switching it off changes."""
    NOT_IN_THIS_SCENE = 3
    """The scene has no place for it, or the whole would be impossible."""
    NO_FRINGE = 4
    """Too few diameters have a fringe with it and without: the spectra's changes are known, those
    of the slope are not."""


class Variant(NamedTuple):
    """An effect, and the configs that differ by it."""

    effect: Effect
    status: EffectStatus
    with_effect: Config
    without_effect: Config
    able: tuple[str, ...] = ()
    """Names of the schemes that honour it."""

    @property
    def focus(self) -> float:
        """By how much the focus is moved with it, µm."""
        return self.effect.focus

    @property
    def configured(self) -> bool:
        """Whether it is what the config has, and is switched off without it."""
        return self.effect.name.endswith(CONFIGURED)

    @property
    def measured(self) -> bool:
        """Whether there are spectra with it and without."""
        return self.status == EffectStatus.MEASURED


def variants(config: Config) -> list[Variant]:
    """Return every effect about a plain config; those that it already has are switched off."""
    return [*(_tried(config, effect) for effect in EFFECTS), *_switched_off(config)]


def combined(config: Config, variants: Sequence[Variant]) -> Variant | None:
    """Return effects at once over a plain config; None where its scheme can't have them so."""
    data, focus = config.to_dict(), 0.0
    for variant in variants:
        laid = variant.effect.overlay(config)
        if laid is None:
            return None
        data, focus = merge(data, laid), focus + variant.focus
    both = _possible(data)
    if both is None or any(impossible(both)):
        return None
    name = " and ".join(variant.effect.name for variant in variants)
    effect = Effect(name, "pair", "both at once", lambda _: {}, focus=focus)
    return Variant(effect, EffectStatus.MEASURED, both, config)


def _tried(config: Config, effect: Effect) -> Variant:
    def found(status: EffectStatus, other: Config = config, able: tuple[str, ...] = ()) -> Variant:
        return Variant(effect, status, other, config, able)

    if effect.alone and is_on(config, effect.kind):
        return found(EffectStatus.AS_CONFIGURED)
    if _own(config, effect):
        return found(EffectStatus.AS_CONFIGURED)
    laid = effect.overlay(config)
    if laid is None:
        on = effect.kind == "dispersion" and config.dispersive
        return found(EffectStatus.AS_CONFIGURED if on else EffectStatus.NOT_IN_THIS_SCENE)
    other = _possible(merge(config.to_dict(), laid))
    if other is None:
        return found(EffectStatus.NOT_IN_THIS_SCENE)
    keys = set(_leaves(laid))
    able = tuple(one.name for one in SCHEMES.values() if _honours(one, other, keys))
    if scheme_of(config).name not in able:
        return found(EffectStatus.NOT_BY_THIS_SCHEME, able=able)
    if any(impossible(other)):
        return found(EffectStatus.NOT_IN_THIS_SCENE, able=able)
    return found(EffectStatus.MEASURED, other, able)


def _own(config: Config, effect: Effect) -> bool:
    """Return whether a scheme is so by itself."""
    if effect.name == "uniform pupil":
        return config.pupil == "uniform"
    return effect.kind == "apodisation" and scheme_of(config).light == "waves"


def _switched_off(config: Config) -> Iterator[Variant]:
    for kind in dict.fromkeys(effect.kind for effect in EFFECTS):
        if not is_on(config, kind):
            continue
        off = _possible(merge(config.to_dict(), without(config, kind)))
        if off is None or any(impossible(off := _without_unused(off))):
            continue
        effect = Effect(f"{kind}{CONFIGURED}", kind, "the config's own, against none", lambda _: {})
        own = (scheme_of(config).name,)
        yield Variant(effect, EffectStatus.MEASURED, config, off, own)


def _without_unused(config: Config) -> Config:
    """Return a config, not checked as a whole, without media that nothing is of any more."""
    used = {*RefractiveIndex.model_fields, *config.media.values()}
    data = config.to_dict()
    for section in ("refractive_index", "attenuation"):
        of = data["scene"][section]
        data["scene"][section] = {name: value for name, value in of.items() if name in used}
    return validated(data)


def _possible(data: dict[str, Any]) -> Config | None:
    """Return the config of plain data, each key checked and not the whole; None if one is wrong."""
    try:
        return validated(data)
    except ConfigError:
        return None


def _honours(scheme: Scheme, config: Config, keys: set[str]) -> bool:
    """Return whether a scheme can do what a config asks for, and reads all of some keys."""
    read = (*scheme.instrument, "polarisation", "interferometer")
    asked: set[Ability] = {one.ability for one in asked_of_scheme(config)}
    return asked <= scheme.honours and all(any(overlap(key, one) for one in read) for key in keys)


def _leaves(data: Any, prefix: str = "") -> Iterator[str]:
    for name, value in data.items():
        # polarisation and the like are read as a whole
        yield from (
            _leaves(value, f"{prefix}{name}.")
            if isinstance(value, dict) and value
            else [f"{prefix}{name}"]
        )
