"""A folder that a run can't use is named before anything is made."""

import os
from pathlib import Path

import pytest

from octsim.base.errors import FileError
from octsim.base.files import remove_unfinished, require_folder, whole


@pytest.mark.parametrize("name", [b"back\\slash", b"latin\xff"])
def test_a_folder_that_netcdf_can_not_name_is_refused(name: bytes, tmp_path: Path) -> None:
    folder = tmp_path / os.fsdecode(name) / "results" / "tiny"
    with pytest.raises(FileError, match="has a backslash or a character that is not UTF-8; rename"):
        require_folder(folder)
    assert not folder.parent.parent.exists()


@pytest.mark.parametrize("name", ["my data", "it's", 'a"b', "naïve µ 日本", "new\nline", "$HOME"])
def test_a_folder_of_any_other_name_is_taken(name: str, tmp_path: Path) -> None:
    require_folder(tmp_path / name / "results")
    assert not (tmp_path / name).exists()


def test_a_file_is_written_under_a_name_that_nobody_can_guess(tmp_path: Path) -> None:
    names = set()
    for text in ("one", "other"):
        with whole(tmp_path / "held.txt") as file:
            assert file.is_file()  # made anew, before anything is written
            names.add(file.name)
            file.write_text(text, encoding="utf-8")
        assert (tmp_path / "held.txt").read_text(encoding="utf-8") == text
    assert len(names) == 2
    assert [one.name for one in tmp_path.iterdir()] == ["held.txt"]


def test_no_link_is_followed_where_a_file_is_written(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("secrets.token_hex", lambda _: "0" * 16)
    other = tmp_path / "other.txt"
    other.write_text("theirs", encoding="utf-8")
    link = tmp_path / f".held.{'0' * 16}.partial.txt"
    link.symlink_to(other)
    with (
        pytest.raises(FileError, match="can't be written"),
        whole(tmp_path / "held.txt") as file,
    ):
        file.write_text("mine", encoding="utf-8")
    assert other.read_text(encoding="utf-8") == "theirs"


def test_what_killed_processes_left_is_removed_and_nothing_else(tmp_path: Path) -> None:
    for name in (".a.0123456789abcdef.partial.nc", "b/.c.partial.png", "partial.nc", ".lock"):
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).touch()
    remove_unfinished(tmp_path)
    assert {one.name for one in tmp_path.rglob("*")} == {"b", "partial.nc", ".lock"}
