"""Where the point cache lies: as named, and in a cluster's job on its own node."""

import os
from pathlib import Path

import pytest

from octsim.base.errors import CacheError, ConfigError
from octsim.instrument.cacheplace import cache_file


@pytest.fixture
def job(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Be a job of Slurm, on a node with this folder for temporary files."""
    monkeypatch.setenv("SLURM_JOB_ID", "7")
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    return tmp_path / f"octsim-{os.getuid()}"


@pytest.fixture(autouse=True)
def no_job(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("SLURM_JOB_ID", raising=False)


def test_a_file_is_where_it_is_named_with_environment_variables(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    assert cache_file(".octsim/points.sqlite") == Path(".octsim/points.sqlite")
    assert cache_file("~/points") == Path.home() / "points"
    monkeypatch.setenv("OCTSIM_TEST_DISK", "/disk")
    named = "$OCTSIM_TEST_DISK/of.${OCTSIM_TEST_USER}.sqlite"
    with pytest.raises(ConfigError, match=r"^cache\.file: .* variable OCTSIM_TEST_USER is not set"):
        cache_file(named)
    monkeypatch.setenv("OCTSIM_TEST_USER", "me")
    assert cache_file(named) == Path("/disk/of.me.sqlite")


def test_a_relative_file_of_a_cluster_s_job_is_the_node_s_own(job: Path) -> None:
    assert cache_file(".octsim/points.sqlite") == job / ".octsim" / "points.sqlite"
    assert job.stat().st_mode & 0o777 == 0o700
    assert cache_file("/disk/points") == Path("/disk/points")


@pytest.mark.parametrize("kind", ["of somebody else", "link", "file", "open to all"])
def test_a_node_s_folder_that_others_can_write_is_refused_in_a_line(kind: str, job: Path) -> None:
    if kind == "link":
        job.symlink_to(job.parent)
    elif kind == "file":
        job.touch()
    else:
        job.mkdir()
    if kind == "open to all":
        job.chmod(0o777)
    elif kind == "of somebody else":
        if os.getuid() != 0:
            pytest.skip("only root can give a folder away")
        os.chown(job, 12345, -1)
    with pytest.raises(CacheError, match="not a folder that only you can write") as caught:
        cache_file("points.sqlite")
    assert "\n" not in str(caught.value)
