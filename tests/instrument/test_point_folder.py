"""A store lies where it is named, but beside a point cache of octsim 0.2.0, which stays."""

from pathlib import Path

import pytest

from octsim.base.errors import ConfigError
from octsim.instrument.point_folder import expanded_path, folder_of, old_cache
from octsim.instrument.point_store import PointStore, describe

OLD = b"SQLite format 3\0".ljust(68, b"\0") + b"OCTP".ljust(8124, b"\0")


def test_a_folder_is_where_it_is_named_with_environment_variables(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setenv("SLURM_JOB_ID", "7")  # nodes share it
    assert expanded_path(".octsim/points") == Path(".octsim/points")
    assert expanded_path("~/points") == Path.home() / "points"
    monkeypatch.setenv("OCTSIM_TEST_DISK", "/disk")
    named = "$OCTSIM_TEST_DISK/of.${OCTSIM_TEST_USER}.points"
    with pytest.raises(ConfigError, match=r"^cache\.file: .* variable OCTSIM_TEST_USER is not set"):
        expanded_path(named)
    monkeypatch.setenv("OCTSIM_TEST_USER", "me")
    assert expanded_path(named) == Path("/disk/of.me.points")


@pytest.mark.parametrize("content", [OLD, b""])
def test_beside_an_old_cache_is_the_store_also_when_it_is_deleted(
    content: bytes, tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    file = tmp_path / "points.sqlite"
    file.write_bytes(content)
    for _ in range(2):
        store = PointStore(file, 0.1)
        store.put(b"key", b"body")
        assert store.get(b"key") == b"body"
    assert file.read_bytes() == content
    assert [record.message for record in caplog.records] == [
        f"octsim: warning: {file}: a point cache of octsim 0.2.0, which is not used any more; it "
        "can be deleted"
    ]
    file.unlink()
    assert PointStore(file, 0.1).get(b"key") == b"body"
    held = describe(file)
    assert held is not None
    assert held.points == 1
    assert folder_of(file) == tmp_path / "points.sqlite.store"


def test_the_old_default_is_found_beside_the_new_one(tmp_path: Path) -> None:
    file = tmp_path / "points"
    assert old_cache(file) is None
    (tmp_path / "points.sqlite").write_bytes(OLD)
    assert old_cache(file) == tmp_path / "points.sqlite"
    assert folder_of(file) == file
    PointStore(file, 0.1).put(b"key", b"body")
    assert folder_of(file) == file


def test_a_store_that_is_there_is_taken_whatever_lies_beside_it(tmp_path: Path) -> None:
    file, beside = tmp_path / "points", tmp_path / "points.store"
    for place in (file, beside):
        PointStore(place, 0.1).put(b"key", place.name.encode())
    assert PointStore(file, 0.1).get(b"key") == b"points"
    assert PointStore(beside, 0.1).get(b"key") == b"points.store"
