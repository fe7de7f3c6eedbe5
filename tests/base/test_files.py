"""A folder that a run can't use is named before anything is made."""

import os
from pathlib import Path

import pytest

from octsim.base.errors import FileError
from octsim.base.files import require_folder


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
