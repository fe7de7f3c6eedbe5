"""Times ahead of the clock are set back, in the order of the files, and said where it matters."""

import os
import time
from pathlib import Path

import pytest

from octsim.base import clock
from octsim.base.errors import FileError

NS = 10**9


def written(file: Path, ahead: float) -> int:
    file.parent.mkdir(parents=True, exist_ok=True)
    file.write_text("data")
    at = time.time_ns() + int(ahead * NS)
    os.utime(file, ns=(at, at))
    return file.stat().st_mtime_ns


def test_files_ahead_are_set_to_now_in_their_order(tmp_path: Path) -> None:
    places = [tmp_path / name for name in ("b.nc", "figures/a.svg", "c.nc")]
    for place, file in enumerate(places):
        written(file, 7200 + place)
    past = written(tmp_path / "past.nc", -60)
    begin = time.time_ns()
    said = clock.set_back(tmp_path)
    times = [file.stat().st_mtime_ns for file in places]
    assert times == sorted(times)
    assert len(set(times)) == 3
    assert begin - NS < times[0]
    assert times[-1] <= time.time_ns()
    assert (tmp_path / "past.nc").stat().st_mtime_ns == past
    assert said is not None
    assert said.startswith(f"{tmp_path / 'c.nc'}: its time, 20")
    assert "is ahead of this machine's clock, 20" in said
    assert ", and 2 more: set to now" in said
    assert clock.set_back(tmp_path) is None


def test_the_seconds_of_a_file_server_are_set_back_without_a_word(tmp_path: Path) -> None:
    file = tmp_path / "a.nc"
    written(file, 5)
    assert clock.set_back(tmp_path) is None
    assert file.stat().st_mtime_ns <= time.time_ns()


def test_what_is_not_there_is_no_concern(tmp_path: Path) -> None:
    (tmp_path / "dangling").symlink_to(tmp_path / "nowhere")
    assert clock.set_back(tmp_path) is None
    assert clock.set_back(tmp_path / "nowhere") is None


def test_a_time_that_cannot_be_set_is_one_line_with_the_remedy(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    file = tmp_path / "a.nc"
    before = written(file, 7200)

    def refused(*_: object, **__: object) -> None:
        raise PermissionError

    monkeypatch.setattr(os, "utime", refused)
    with pytest.raises(FileError, match=r"a\.nc: its time, .* touch the file: touch .*a\.nc$"):
        clock.set_back(tmp_path)
    assert file.stat().st_mtime_ns == before
