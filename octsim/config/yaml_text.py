"""YAML or JSON as plain data, read in bounds: what makes it large, deep or endless is refused.

PyYAML's parser gives events; values are built from them here, as its own composer follows anchors
however often they repeat what they name.
"""

import json
from collections.abc import Iterator
from typing import Any, NamedTuple

import yaml

from octsim.base.errors import ConfigError
from octsim.config.bounds import (
    DEEPEST,
    LONGEST_KEY,
    LONGEST_TEXT,
    MOST_VALUES,
    NO_TEXT,
    TOO_DEEP,
    TOO_MANY,
    code_of,
    short,
    wrong_text,
)

_TAG = "tag:yaml.org,2002:"
_MERGE = f"{_TAG}merge"
_SCALARS = tuple(f"{_TAG}{name}" for name in ("null", "bool", "int", "float", "timestamp", "str"))
_PARSER: Any = yaml.CSafeLoader if yaml.__with_libyaml__ else yaml.SafeLoader


class _At(NamedTuple):
    """A place in the text, counted from 1."""

    line: int
    column: int


class _FoundError(Exception):
    """What is wrong, and where."""

    def __init__(self, what: str, at: _At) -> None:
        super().__init__(f", line {at.line}, column {at.column}: {what}")


class _Built(NamedTuple):
    """A value, and how many there are in it."""

    value: Any
    values: int


class _Scalars(yaml.resolver.Resolver, yaml.constructor.SafeConstructor):
    """What text without quotes is: a number, a day, a word."""

    def __init__(self) -> None:
        yaml.resolver.Resolver.__init__(self)
        yaml.constructor.SafeConstructor.__init__(self)


def read_text(text: str) -> Any:
    """Return the plain data that YAML or JSON is; None of an empty one.

    Raises
    ------
    ConfigError
        If it is none. Its text begins as ``, line 3, column 5: `` after the name of a file.
    """
    if found := NO_TEXT.search(text):
        at = _place(text, found.start())
        raise ConfigError(
            f", line {at.line}, column {at.column}: holds the character {code_of(found[0])}, which "
            "no text has; write the file as plain text in UTF-8"
        )
    try:
        return _as_json(text) if text.lstrip().startswith("{") else _Reader(text).read()
    except _FoundError as problem:
        raise ConfigError(str(problem)) from None
    except yaml.MarkedYAMLError as error:
        raise ConfigError(_of_syntax(text, error)) from None
    except yaml.YAMLError as error:
        raise ConfigError(f": not YAML: {' '.join(str(error).split())}") from None


def _place(text: str, index: int) -> _At:
    before = text[:index]
    return _At(before.count("\n") + 1, index - before.rfind("\n"))


def _of_syntax(text: str, error: yaml.MarkedYAMLError) -> str:
    mark = error.problem_mark or error.context_mark
    if mark is None:
        return f": not as YAML should be: {error.problem}"
    lines = text.splitlines()
    line = lines[mark.line] if mark.line < len(lines) else ""
    said = short(" ".join((error.problem or "not YAML").split()))
    if "\t" in line[: mark.column + 1]:
        said = "a tab stands before it; YAML takes blanks alone there"
    return f", line {mark.line + 1}, column {mark.column + 1}: not as YAML should be: {said}"


def _as_json(text: str) -> Any:
    """Return what JSON holds, which is read ten times as fast; whatever is none is read as YAML."""
    # each value but the first has one of these before it
    if sum(map(text.count, ",[{:")) <= MOST_VALUES:
        try:
            return json.loads(text, object_pairs_hook=_once)
        except (ValueError, RecursionError):
            pass
    return _Reader(text).read()


def _once(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    whole = dict(pairs)
    if len(whole) < len(pairs):
        raise ValueError("a key stands twice")
    return whole


class _Reader:
    """Values of one text, event by event."""

    def __init__(self, text: str) -> None:
        self._events: Iterator[yaml.Event] = yaml.parse(text, _PARSER)
        self._scalars = _Scalars()
        self._resolve: Any = self._scalars.resolve
        self._anchors: dict[str, _Built | None] = {}
        self._left = MOST_VALUES

    def read(self) -> Any:
        """Return the value of the one document; None of none."""
        value: Any = None
        documents = 0
        for event in self._events:
            if isinstance(event, yaml.DocumentStartEvent):
                documents += 1
                if documents > 1:
                    raise _FoundError("a second document begins; give one", _at(event))
            elif isinstance(event, yaml.NodeEvent):
                value = self._node(event, 0).value
        return value

    def _node(self, event: Any, depth: int) -> _Built:
        """Return the value that begins with an event."""
        if isinstance(event, yaml.AliasEvent):
            return self._repeated(event)
        if depth > DEEPEST:
            raise _FoundError(TOO_DEEP, _at(event))
        self._spend(1, event)
        anchor = getattr(event, "anchor", None)
        if anchor is not None:
            self._anchors[anchor] = None
        if isinstance(event, yaml.ScalarEvent):
            built = _Built(self._scalar(event), 1)
        else:
            mapping = isinstance(event, yaml.MappingStartEvent)
            plain = f"{_TAG}{'map' if mapping else 'seq'}"
            if event.tag not in (None, "!", plain):
                raise _FoundError(_unknown(event.tag), _at(event))
            built = self._mapping(depth) if mapping else self._list(depth)
        if anchor is not None:
            self._anchors[anchor] = built
        return built

    def _spend(self, count: int, event: Any) -> None:
        self._left -= count
        if self._left < 0:
            raise _FoundError(TOO_MANY, _at(event))

    def _repeated(self, event: Any) -> _Built:
        """Return what an anchor names."""
        name = short(event.anchor)
        if event.anchor not in self._anchors:
            raise _FoundError(f"*{name} given, but nothing before it is named &{name}", _at(event))
        built = self._anchors[event.anchor]
        if built is None:
            raise _FoundError(f"*{name} stands within &{name} itself, without end", _at(event))
        self._spend(built.values, event)
        return built

    def _list(self, depth: int) -> _Built:
        values, count = [], 1
        for event in self._events:
            if isinstance(event, yaml.SequenceEndEvent):
                break
            value, inner = self._node(event, depth + 1)
            values.append(value)
            count += inner
        return _Built(values, count)

    def _mapping(self, depth: int) -> _Built:
        own: dict[Any, Any] = {}
        merged: dict[Any, Any] = {}
        lines: dict[Any, int] = {}
        count = 1
        for event in self._events:
            if isinstance(event, yaml.MappingEndEvent):
                break
            at = _at(event)
            merges = isinstance(event, yaml.ScalarEvent) and self._tag(event) == _MERGE
            key, of_key = _Built(None, 1) if merges else self._node(event, depth + 1)
            begin = next(self._events)
            value, inner = self._node(begin, depth + 1)
            count += of_key + inner
            if merges:
                merged |= self._merged(value, _at(begin))
                continue
            self._require_key(key, lines, at)
            lines[key] = at.line
            own[key] = value
        return _Built(merged | own, count)

    def _require_key(self, key: Any, lines: dict[Any, int], at: _At) -> None:
        if isinstance(key, dict | list):
            kind = "mapping" if isinstance(key, dict) else "list"
            raise _FoundError(f"a {kind} stands as a key; keys are names, such as scene", at)
        if isinstance(key, str) and (wrong := wrong_text(key, LONGEST_KEY)):
            raise _FoundError(f"the key {short(key)}: {wrong}", at)
        if key in lines:
            raise _FoundError(f"the key '{key}' stands twice, on line {lines[key]} too", at)

    def _merged(self, value: Any, at: _At) -> dict[Any, Any]:
        """Return what ``<<`` brings: of a list of mappings, the first that has a key."""
        parts = value if isinstance(value, list) else [value]
        whole: dict[Any, Any] = {}
        for part in reversed(parts):
            if not isinstance(part, dict):
                raise _FoundError("<< takes a mapping, or a list of them", at)
            whole |= part
        return whole

    def _tag(self, event: Any) -> str:
        if event.tag is None or event.tag == "!":
            return str(self._resolve(yaml.ScalarNode, event.value, event.implicit))
        return str(event.tag)

    def _scalar(self, event: Any) -> Any:
        if len(event.value) > LONGEST_TEXT:
            raise _FoundError(str(wrong_text(event.value)), _at(event))
        tag = self._tag(event)
        if tag not in _SCALARS:
            raise _FoundError(_unknown(tag), _at(event))
        node = yaml.ScalarNode(tag, event.value)
        try:
            return self._scalars.yaml_constructors[tag](self._scalars, node)
        except (ValueError, OverflowError, LookupError, AttributeError) as error:
            kind = {"timestamp": "date", "int": "number", "float": "number"}
            name = tag.removeprefix(_TAG)
            said = f" ({error})" if name == "timestamp" and isinstance(error, ValueError) else ""
            raise _FoundError(
                f"{short(event.value)} is no {kind.get(name, name)} that there is{said}", _at(event)
            ) from None


def _unknown(tag: str) -> str:
    name = short(tag.replace(_TAG, "!!"))
    return f"the tag {name} is not known here; write plain keys, numbers and text"


def _at(event: Any) -> _At:
    return _At(event.start_mark.line + 1, event.start_mark.column + 1)
