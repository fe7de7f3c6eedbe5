"""Configs that none can be made of: what hangs, what is endless, and what is no text."""

import json
from collections.abc import Iterator
from typing import NamedTuple

BIG = 10**400


class Bad(NamedTuple):
    """What a file holds, and what is said of it."""

    name: str
    content: bytes
    says: str
    """A part of what is said."""
    lines: int = 1
    """Of what is said."""


def _bomb(first: str, line: str) -> str:
    """Write anchors that each repeat the one before nine times."""
    rows = [f"a0: &a0 {first}"]
    rows += [
        f"a{n}: &a{n} " + line.format(",".join([f"*a{n - 1}"] * 9), before=n - 1)
        for n in range(1, 12)
    ]
    return "\n".join(rows)


def _keys(prefix: str, count: int, indent: str = "") -> str:
    return "".join(f"{indent}{prefix}{n}: {n}\n" for n in range(count))


def _list(of: str, count: int) -> str:
    return "[" + ",".join([of] * count) + "]"


_MANY = "more than 250000 values"
_PLAIN = "more than 20000 values outside of grid and tables"
_DEEP = "within each other more than 20 deep"
_DIGITS = "a number of 401 digits given; numbers go to 1e308"


def _endless() -> Iterator[tuple[str, str | bytes, str]]:
    """Yield what repeats itself, or goes on for long."""
    yield "lists in lists", _bomb("[x,x,x,x,x,x,x,x,x]", "[{0}]"), f"line 6, column 18: {_MANY}"
    yield "merged in merged", _bomb("{x: 1}", "{{<<: [{0}]}}"), _MANY
    named = ",".join(f"k{n}: *a{{before}}" for n in range(9))
    yield "mappings in mappings", _bomb("{x: 1}", f"{{{{{named}}}}}"), _MANY
    yield "within itself", "scene: &a {gap: *a}\n", "line 1, column 17: *a stands within &a itself"
    yield "a list within itself", "&a [*a]\n", "*a stands within &a itself, without end"
    yield "merged within itself", "scene: &a {<<: *a}\n", "*a stands within &a itself"
    yield "no anchor", "scene: *nothing\n", "line 1, column 8: *nothing given, but nothing before"
    yield "100 000 unknown keys", _keys("key", 100_000), _PLAIN
    yield "keys of a section", "tracing:\n" + _keys("key", 100_000, "  "), _PLAIN
    yield "media", "scene:\n  refractive_index:\n" + _keys("m", 100_000, "    "), _PLAIN
    yield "keys of a grid", "grid:\n" + "".join(f"  k{n}: [1]\n" for n in range(100_000)), _MANY
    yield "2 000 000 entries", f"run: {_list('a', 2_000_000)}\n", f"line 1, column 500001: {_MANY}"
    yield "JSON of empty lists", f'{{"run": {_list("[]", 2_000_000)}}}', _MANY
    yield (
        "cylinders",
        f"scene: {{cylinders: {_list('{medium: neuron}', 6000)}}}",
        "100 at most",
    )
    yield "fills", f"design: {{fills: {_list('0.5', 15_000)}}}", "it should have 1000 at most"
    yield "a window", f"processing: {{window: {_list('1', 15_000)}}}", "it should have 10 at most"
    yield "brackets", "a: " + "[" * 100_000, _DEEP
    yield "braces", "{a: " * 100_000, _DEEP
    yield "JSON in JSON", '{"a": ' * 100_000, _DEEP
    yield "dashes", "- " * 100_000, _DEEP
    yield "17 MB", b"#" * 17_000_000, "can't be read (it holds 17 MB, of 16 MB at most)"
    yield "16 MB of remarks", b"# x\n" * 3_900_000 + b"- 1", "holds a list, not keys with values"
    yield "a million documents", "---\n" * 1_000_000, "line 2, column 1: a second document begins"
    yield "a long key", "k" * 1_000_000 + ": 1\n", "1000000 characters given; it should be 10000"
    yield "a key of 9000", f"? {'k' * 9000}\n: 1\n", "9000 characters given; it should be 200"
    yield "a long text", "run: " + "k" * 1_000_000, "1000000 characters given; it should be 10000"
    yield "digits of a length", f'scene: {{gap: "{"1" * 9990}x!"}}', "not a length; write it with"
    yield "blanks of a length", f'scene: {{gap: "5{" " * 9990}!"}}', "not a length; write it with"


def _numbers() -> Iterator[tuple[str, str | bytes, str]]:
    """Yield numbers that go beyond all."""
    for key in (
        "tracing.rays", "objective.numerical_aperture", "scene.gap", "run", "sweep.diameters.num",
        "cache.gigabytes", "scene.refractive_index.glass", "measured.average",
    ):  # fmt: skip
        *sections, name = key.split(".")
        text = f"{name}: {BIG}"
        for section in reversed(sections):
            text = f"{section}: {{{text}}}"
        yield f"{key} of 401 digits", text, f"{key}: {_DIGITS}"
    yield "in a grid", f"grid: {{tracing.rays: [1, {BIG}]}}", f"grid.tracing.rays.1: {_DIGITS}"
    yield "a range", f"grid: {{tracing.rays: {{start: 1, stop: {BIG}, num: 3}}}}", _DIGITS
    yield "as a key", f"{BIG}: 1", f"a key: {_DIGITS}"
    yield "5000 digits", f"tracing: {{rays: {'9' * 5000}}}", "line 1, column 17: 9999"
    yield "hexadecimal", f"tracing: {{rays: 0x{'f' * 9000}}}", "a number of 10838 digits given"
    yield "of sixties", f"tracing: {{rays: 1{':30' * 3000}}}", "digits given; numbers go to 1e308"
    yield "an exponent", "tracing: {accuracy: 1e999999999999}", "it should be a finite number"
    yield "a long length", "scene: {gap: 1e99999999999999999999 nm}", "far out of range"
    yield "no number", "tracing: {accuracy: .nan}", "tracing.accuracy: nan given"


def _texts() -> Iterator[tuple[str, str | bytes, str]]:
    """Yield what is no text, or no YAML."""
    half = "holds the character U+D800, which no text has"
    yield "half a letter", json.dumps({"archive": {"title": "\ud800"}}), f"archive.title: {half}"
    yield "half a letter as a key", json.dumps({"\ud800": 1}), half
    yield "half a letter in YAML", 'archive: {title: "\\ud800"}', "not as YAML should be"
    yield "a byte 0", b"run: a\0b\n", "line 1, column 7: holds the character U+0000"
    yield "byte 0 as escape", 'cache: {file: "a\\0b"}', "cache.file: holds the character U+0000"
    yield "byte 0 in JSON", json.dumps({"expansion": {"series": "a\0b"}}), "expansion.series: holds"
    yield "an escape sequence", 'archive: {title: "\\e[31m"}', "archive.title: holds the character"
    yield "Latin-1", b"run: x\n# caf\xe9\n", "line 2: it is not text in UTF-8; save it as that"
    yield "UTF-16", "run: x\n".encode("utf-16"), "line 1: it is not text in UTF-8 but UTF-16"
    yield "a tab", "scene:\n\tgap: 5 nm\n", "line 2, column 1: not as YAML should be: a tab stands"
    yield (
        "a tab later",
        "scene:\n  gap: 5 nm\n\trun: x\n",
        "line 3, column 1: not as YAML",
    )
    yield "a list", "- 1\n- 2\n", "holds a list, not keys with values"
    yield "a word", "hello\n", "holds text, not keys with values"
    yield "a number", "3\n", "holds a number, not keys with values"
    yield (
        "a key twice",
        "run: a\n\nrun: b\n",
        "line 3, column 1: the key 'run' stands twice, on",
    )
    yield "twice in JSON", '{"run": "a",\n "run": "b"}', "line 2, column 2: the key 'run' stands"
    yield "twice within", "scene:\n  gap: 1 nm\n  gap: 2 nm\n", "line 3, column 3: the key 'gap'"
    yield "two documents", "run: a\n---\nrun: b\n", "line 2, column 1: a second document begins"
    yield "code", 'run: !!python/object/apply:os.system ["true"]', "the tag !!python/object/apply:"
    yield "a set", "scene: !!set {gap}", "the tag !!set is not known here"
    yield "bytes", "run: !!binary aGk=", "the tag !!binary is not known here"
    yield "no integer", 'tracing: {rays: !!int "x"}', "column 17: x is no number that there is"
    yield "no day", "archive: {date: 2026-13-01}", "2026-13-01 is no date that there is (month"
    yield "a template", "run: {{ name }}", "line 1, column 7: a mapping stands as a key"
    yield "a list as a key", "? [a, b]\n: 1\n", "a list stands as a key"
    yield "an open quote", 'run: "abc\n', "not as YAML should be: found unexpected end of stream"
    yield "an open brace", "scene: {gap: 5 nm\n", "line 2, column 1: not as YAML should be"
    yield "two colons", "a: b: c\n", "line 1, column 5: not as YAML should be"


BAD = (
    *(
        Bad(name, text if isinstance(text, bytes) else text.encode(), says)
        for part in (_endless(), _numbers(), _texts())
        for name, text, says in part
    ),
    Bad("19 000 unknown keys", _keys("key", 19_000).encode(), "key0: unknown key; the nearest", 21),
    Bad(
        "19 000 unknown keys of scene", ("scene:\n" + _keys("key", 19_000, " ")).encode(),
        "and more, once these are mended", 21,
    ),
    Bad(
        "19 000 wrong values", f"scene: {{layers: {_list('3', 19_000)}}}".encode(),
        "scene.layers.0: 3 given; it should be a mapping", 21,
    ),
    Bad(
        "code for snakemake", b"__use_yte__: true\nrun: ?1 + 1\n",
        "__use_yte__: unknown key", 2,
    ),
)  # fmt: skip
SHORT = ("lists in lists", "within itself", "a list", "a tab", "Latin-1", "code for snakemake")
"""Names of some, one of each kind."""
