"""What a source says is found once for each text, by whichever process, and never of another."""

from pathlib import Path

import pytest

from octsim.base import kept_syntax
from octsim.base.code_folder import can_write
from octsim.base.kept_syntax import KeptSyntax, name
from octsim.base.syntax import Syntax, syntax_of

SOURCE = b"import math\n\n\ndef twice(x):\n    return 2 * x\n"
OTHER = b"import cmath\n\n\ndef twice(x):\n    return 3 * x"
MODULE = ("octsim", "room", "formula")


@pytest.fixture(autouse=True)
def place(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    can_write.cache_clear()
    monkeypatch.setattr(kept_syntax, "places", lambda: (tmp_path,))
    return tmp_path


@pytest.fixture
def parsed(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """Give the texts that are parsed from now on."""
    texts: list[str] = []

    def parse(text: str, module: tuple[str, ...]) -> Syntax:
        texts.append(text)
        return syntax_of(text, module)

    monkeypatch.setattr(kept_syntax, "syntax_of", parse)
    return texts


def found(source: bytes = SOURCE, module: tuple[str, ...] = MODULE) -> Syntax:
    """Find what a source says, as a process does that has just begun."""
    kept = KeptSyntax()
    one = kept.of(source, module)
    kept.keep()
    return one


def test_what_one_process_has_found_the_next_one_reads(parsed: list[str]) -> None:
    assert found() == found() == syntax_of(SOURCE.decode(), MODULE)
    assert len(parsed) == 1


def test_of_another_text_or_module_nothing_is_known(parsed: list[str]) -> None:
    assert found() != found(OTHER)
    assert found(b"from . import b").imported == ("octsim.room", "octsim.room.b")
    assert found(b"from . import b", ("octsim", "b", "c")).imported == ("octsim.b", "octsim.b.b")
    assert len(parsed) == 4
    found(OTHER)
    assert len(parsed) == 4


@pytest.mark.parametrize("damage", [b"", b"\xff", b"[]", "cut", "changed"])
def test_a_damaged_file_is_as_good_as_none_and_replaced(
    damage: bytes | str, place: Path, parsed: list[str]
) -> None:
    right = found()
    whole = (place / name()).read_bytes()
    named = {"cut": whole[:-9], "changed": whole.replace(b"math", b"path")}
    bad = damage if isinstance(damage, bytes) else named[damage]
    assert bad != whole
    (place / name()).write_bytes(bad)
    assert found() == right
    assert len(parsed) == 2
    assert (place / name()).read_bytes() == whole


def test_what_other_code_or_another_python_has_found_is_not_read(
    monkeypatch: pytest.MonkeyPatch, parsed: list[str]
) -> None:
    found()
    monkeypatch.setattr(kept_syntax, "name", lambda: "of-another.json")
    found()
    assert len(parsed) == 2


def test_where_nothing_can_be_written_it_is_found_each_time(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, parsed: list[str]
) -> None:
    (tmp_path / "file").touch()
    monkeypatch.setattr(kept_syntax, "places", lambda: (tmp_path / "file",))
    assert found() == found()
    assert len(parsed) == 2


def test_what_can_only_be_read_is_added_to_elsewhere(
    place: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, parsed: list[str]
) -> None:
    found()
    image = place.rename(tmp_path.with_name("image"))
    tmp_path.mkdir()
    monkeypatch.setattr(kept_syntax, "places", lambda: (image, tmp_path))
    monkeypatch.setattr(kept_syntax, "writable", lambda _: tmp_path)
    for source in (SOURCE, OTHER, SOURCE, OTHER):
        found(source)
    assert len(parsed) == 2


def test_a_file_that_has_grown_too_large_is_begun_anew(
    place: Path, monkeypatch: pytest.MonkeyPatch, parsed: list[str]
) -> None:
    found()
    monkeypatch.setattr(kept_syntax, "_LARGEST", (place / name()).stat().st_size)
    found(OTHER)  # now it is larger
    found(OTHER)
    assert parsed == [SOURCE.decode(), OTHER.decode(), OTHER.decode()]
    found()
    assert len(parsed) == 4
