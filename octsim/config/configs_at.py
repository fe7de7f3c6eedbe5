"""Configs of a grid's combinations: what no varied key is in is checked once, and shared."""

import functools
from collections.abc import Mapping
from typing import Any

from pydantic import ValidationError
from pydantic.fields import FieldInfo

from octsim.config.derive import config_at, merge, nested, overlaid, part_of
from octsim.config.fields import Section
from octsim.config.models import Config

_MOST_MADE = 10_000
"""Sections that are kept for other combinations."""


@functools.lru_cache(maxsize=64)
def _by_part(keys: tuple[str, ...], depth: int) -> Mapping[str, tuple[str, ...]]:
    """Return dotted keys by the names that they have at a depth."""
    names = dict.fromkeys(key.split(".")[depth] for key in keys)
    return {name: tuple(k for k in keys if k.split(".")[depth] == name) for name in names}


class ConfigsAt:
    """Configs of one config's plain data, with some dotted keys at other values.

    They are those of `config_at`, made of their sections: each is checked once for its own values,
    as none depends on another.

    Parameters
    ----------
    base : mapping
        A checked config's plain data.
    """

    def __init__(self, base: Mapping[str, Any]) -> None:
        self._base = base
        self._plain = Config.model_validate(base)
        self._made: dict[tuple[object, ...], tuple[Section, list[Any]]] = {}
        self._beside = functools.cache(self._parts_beside)

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
            within, beside = self._beside(place, keys)
            made = {part: self._section((*place, part), of, values) for part, of in within.items()}
            laid: dict[str, Any] = {}
            for key in keys:
                if not any(key in of for of in within.values()):
                    laid = merge(laid, nested(key, values[key]))
            plain = functools.reduce(getattr, place, self._plain)
            if laid or _looks_at_all(type(plain)):
                name = ".".join(place)
                given = part_of(overlaid(nested(name, part_of(self._base, name)), laid), name)
                plain = plain.model_validate({**given, **beside, **made})
            # tuples too are the same ones, as what is found of them is remembered by which they are
            found = plain.model_copy(update={**beside, **made}), own
            if len(self._made) >= _MOST_MADE:  # the first go, as neighbours have the last in common
                del self._made[next(iter(self._made))]
            self._made[which] = found
        return found[0]

    def _parts_beside(
        self, place: tuple[str, ...], keys: tuple[str, ...]
    ) -> tuple[Mapping[str, tuple[str, ...]], Mapping[str, Any]]:
        """Return the keys within each section of a section, and the parts that none is in.

        These, checked, are the same in all configs.
        """
        if ".".join(place) in keys:  # it is itself among the values
            return {}, {}
        section = functools.reduce(getattr, place, self._plain)
        fields, varied = type(section).model_fields, _by_part(keys, len(place))
        within = {
            part: of for part, of in varied.items()
            if _is_section(fields.get(part)) and ".".join((*place, part)) not in of
        }  # fmt: skip
        parts = {part: getattr(section, part) for part in fields if part not in varied}
        return within, {part: value for part, value in parts.items() if _is_checked(value)}


def _is_section(field: FieldInfo | None) -> bool:
    """Return whether a field is a section, whatever is given, and nothing else looks at that."""
    kind = field.annotation if field and not field.metadata else None
    return isinstance(kind, type) and issubclass(kind, Section)


@functools.cache
def _looks_at_all(model: type[Section]) -> bool:
    """Return whether a section checks its parts together."""
    own = model.__pydantic_decorators__
    return bool(own.model_validators or own.field_validators)


def _is_checked(value: object) -> bool:
    """Return whether a part can be given as it is, and not as the text that it was made of."""
    if isinstance(value, tuple):
        return bool(value) and all(isinstance(one, Section) for one in value)
    return isinstance(value, Section)
