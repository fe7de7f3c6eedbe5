"""Which run of a name is the latest."""

from pathlib import Path

import pytest

from octsim.stages.run_id import begin, is_latest


@pytest.fixture(autouse=True)
def no_run(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("OCTSIM_RUN_ID", "")  # put back what was there, whatever a test does
    monkeypatch.delenv("OCTSIM_RUN_ID")


def test_a_job_outside_of_any_run_is_of_the_latest(tmp_path: Path) -> None:
    assert is_latest(tmp_path)
    (tmp_path / "logs").mkdir()
    (tmp_path / "logs" / "run_id").write_text("another")
    assert is_latest(tmp_path)


def test_a_job_is_of_the_latest_run_until_another_begins(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    begin(tmp_path)
    assert is_latest(tmp_path)
    monkeypatch.setenv("OCTSIM_RUN_ID", "of an earlier run")
    assert not is_latest(tmp_path)


@pytest.mark.parametrize("found", ["", None])
def test_what_cannot_be_told_ends_nothing(found: str | None, tmp_path: Path) -> None:
    begin(tmp_path)
    file = tmp_path / "logs" / "run_id"
    file.unlink() if found is None else file.write_text(found)
    assert is_latest(tmp_path)
