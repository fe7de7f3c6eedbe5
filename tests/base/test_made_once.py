"""What tests of several workers read is made by one of them, and again where that failed."""

from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest
from made_once import Once


def test_who_asks_first_makes_it_and_the_others_get_a_copy(tmp_path: Path) -> None:
    made: list[Path] = []

    def make(folder: Path) -> list[int]:
        made.append(folder)
        return [1, 2]

    with ThreadPoolExecutor(4) as workers:
        asked = [workers.submit(Once(tmp_path).made, "thing", make) for _ in range(8)]
        found = [one.result() for one in asked]
    assert found == 8 * [[1, 2]]
    assert found[0] is not found[1]
    assert made == [tmp_path / "thing"]


def test_what_failed_leaves_nothing_to_who_asks_next(tmp_path: Path) -> None:
    def fails(folder: Path) -> int:
        (folder / "part").touch()
        raise OSError("no room")

    once = Once(tmp_path)
    with pytest.raises(OSError, match="no room"):
        once.made("thing", fails)
    assert once.made("thing", lambda folder: [*folder.iterdir()]) == []
