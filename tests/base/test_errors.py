"""What is said is one line for each problem, whatever a file's text holds."""

import pickle

import pytest

from octsim.base.errors import LONGEST, ConfigError, OctsimError, OctsimWarning, one_line, printable

HOSTILE = "a\x1b[2J\nb\r\u202e\ud800\0\x85\u2028"


@pytest.mark.parametrize("kind", [OctsimError, ConfigError, OctsimWarning])
def test_text_of_a_file_is_part_of_the_line_that_it_stands_in(kind: type[Exception]) -> None:
    said = str(kind(f"file: {HOSTILE} given"))
    assert said == r"file: a\x1b[2J\nb\r\u202e\ud800\x00\x85\u2028 given"


def test_each_problem_is_a_line_of_its_own() -> None:
    error = ConfigError("run: wrong\noctsim: right", "scene: wrong")
    assert str(error).split("\n") == [r"run: wrong\noctsim: right", "scene: wrong"]
    assert str(pickle.loads(pickle.dumps(error))) == str(error)


@pytest.mark.parametrize("letter", ["x", "\n", "\x1b", "é", "\u202e"])
@pytest.mark.parametrize("count", [299, 300, 301, 100_000])
def test_a_line_is_cut_to_300_letters_and_keeps_its_end(letter: str, count: int) -> None:
    said = one_line(f"file: {letter * count}; mend it")
    assert len(said) <= LONGEST == 300
    assert said.isprintable()
    assert said.startswith("file: ")
    assert said.endswith("; mend it")


def test_what_is_a_line_stays_as_it_is() -> None:
    for text in ("", "scene.gap: 5 µm given; λ is 1.2 um", "x" * 300):
        assert one_line(text) == printable(text) == text
