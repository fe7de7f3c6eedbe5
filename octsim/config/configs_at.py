"""Configs of a grid's combinations: what no varied key is in is checked once, and shared."""

import functools
from collections.abc import Mapping
from typing import Any, NamedTuple

from pydantic import ValidationError
from pydantic.fields import FieldInfo

from octsim.config.derive import config_at, nested, nested_all, overlaid, part_of
from octsim.config.fields import Section
from octsim.config.models import Config

_MOST_MADE = 10_000
"""Sections that are kept for other combinations."""


class _Divided(NamedTuple):
    """The keys of a section at other values, and its parts that they do not reach."""

    by_section: Mapping[str, tuple[str, ...]]
    """Keys that are within a section of this one, by its name."""
    other: tuple[str, ...]
    """The other keys."""
    shared: Mapping[str, Any]
    """Parts, checked, that no key is in."""


class ConfigsAt:
    """Configs of one config's plain data, with some dotted keys at other values.

    They are those of `config_at`. Sections are made once for the values of the keys in them, and
    have the same objects wherever no key is in, as what follows from these is remembered by which
    they are (`octsim.base.remembered`).

    Parameters
    ----------
    base : mapping
        A checked config's plain data.
    """

    def __init__(self, base: Mapping[str, Any]) -> None:
        self._base = base
        self._plain = Config.model_validate(base)
        self._divided: dict[tuple[object, ...], _Divided] = {}
        self._made: dict[tuple[object, ...], tuple[Section, list[Any]]] = {}

    def at(self, values: Mapping[str, Any]) -> Config:
        """Return the config with some dotted keys at these values.

        Raises
        ------
        ValidationError
            If a value is wrong.
        """
        sections = _by_part(tuple(values), 0)
        try:
            made = {name: self._section((name,), keys, values) for name, keys in sections.items()}
        except ValidationError:
            return config_at(self._base, values)  # says where it is
        return self._plain.model_copy(update=made)

    def _section(
        self, place: tuple[str, ...], keys: tuple[str, ...], values: Mapping[str, Any]
    ) -> Section:
        """Return a section, or one within it, with these keys of it at their values."""
        own = [values[key] for key in keys]
        # which value it is, as lists and mappings can't be looked up; they are held here meanwhile
        which = (place, *keys, *map(id, own))
        found = self._made.get(which)
        if found is None:
            if len(self._made) >= _MOST_MADE:  # the first go, as neighbours have the last in common
                del self._made[next(iter(self._made))]
            found = self._made[which] = self._made_of(place, keys, values), own
        return found[0]

    def _made_of(
        self, place: tuple[str, ...], keys: tuple[str, ...], values: Mapping[str, Any]
    ) -> Section:
        divided = self._divided.get((place, keys))
        if divided is None:
            divided = self._divided[place, keys] = self._divide(place, keys)
        sections = divided.by_section.items()
        made = {part: self._section((*place, part), of, values) for part, of in sections}
        parts = {**divided.shared, **made}
        plain = self._at(place)
        if not divided.other and not _checks_parts(type(plain)):
            return plain.model_copy(update=parts)
        name, laid = ".".join(place), nested_all({key: values[key] for key in divided.other})
        given = part_of(overlaid(nested(name, part_of(self._base, name)), laid), name)
        checked = plain.model_validate({**given, **parts} if isinstance(given, Mapping) else given)
        # of tuples checking makes others, and a section that checks its parts may change them
        return checked if _checks_parts(type(plain)) else checked.model_copy(update=parts)

    def _divide(self, place: tuple[str, ...], keys: tuple[str, ...]) -> _Divided:
        if ".".join(place) in keys:  # the whole section is given
            return _Divided({}, keys, {})
        section = self._at(place)
        fields, varied = type(section).model_fields, _by_part(keys, len(place))
        by_section = {
            part: of for part, of in varied.items()
            if _is_section(fields.get(part)) and ".".join((*place, part)) not in of
        }  # fmt: skip
        within = {key for of in by_section.values() for key in of}
        parts = {part: getattr(section, part) for part in fields if part not in varied}
        return _Divided(
            by_section,
            tuple(key for key in keys if key not in within),
            {part: value for part, value in parts.items() if _is_checked(value)},
        )

    def _at(self, place: tuple[str, ...]) -> Section:
        found: Section = functools.reduce(getattr, place, self._plain)
        return found


@functools.lru_cache(maxsize=64)
def _by_part(keys: tuple[str, ...], depth: int) -> Mapping[str, tuple[str, ...]]:
    """Return dotted keys by the names that they have at a depth."""
    names = dict.fromkeys(key.split(".")[depth] for key in keys)
    return {name: tuple(k for k in keys if k.split(".")[depth] == name) for name in names}


def _is_section(field: FieldInfo | None) -> bool:
    """Return whether a field is a section, whatever is given, and nothing else looks at that."""
    kind = field.annotation if field and not field.metadata else None
    return isinstance(kind, type) and issubclass(kind, Section)


@functools.cache
def _checks_parts(model: type[Section]) -> bool:
    """Return whether a section checks its parts itself, together or one by one."""
    own = model.__pydantic_decorators__
    return bool(own.model_validators or own.field_validators)


def _is_checked(value: object) -> bool:
    """Return whether a part can be given as it is, and not as the text that it was made of."""
    if isinstance(value, tuple):
        return bool(value) and all(isinstance(one, Section) for one in value)
    return isinstance(value, Section)
