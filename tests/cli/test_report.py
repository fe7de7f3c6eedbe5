"""`octsim report` says where the page is, or in one line why there is none."""

from pathlib import Path

import pytest
from made_runs import make

from octsim.cli.main import main


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("made") / "tiny"
    make(folder, scan=False)
    return folder


def test_the_page_is_written_and_where_it_is_is_said(
    folder: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    for given, file in ([], folder / "report.html"), (["-o", "a.html"], tmp_path / "a.html"):
        asked = [*given[:1], str(file)] if given else []
        assert main(["report", str(folder), *asked]) == 0
        said = capsys.readouterr()
        assert said.out == f"{file}: {file.stat().st_size / 1e6:.2f} MB\n"
        assert said.err == ""


def test_who_is_cited_is_what_a_config_says(folder: Path, tmp_path: Path) -> None:
    (tmp_path / "mine.yaml").write_text("archive: {creators: [{name: Ada Ray}]}\n", "utf-8")
    file = tmp_path / "a.html"
    asked = ["report", str(folder), "-o", str(file)]
    assert main([*asked, "--config", str(tmp_path / "mine.yaml")]) == 0
    assert "Ada Ray" in file.read_text("utf-8")
    assert main(asked) == 0
    assert "Ada Ray" not in file.read_text("utf-8")


@pytest.mark.parametrize(
    ("arguments", "status", "line"),
    [
        (["none"], 1, "octsim: none: no datasets; give a folder as results/thesis"),
        (
            ["{folder}", "--combination", "2"],
            1,
            "octsim: --combination: 2 given, but the run has no grid; give 1 to 1",
        ),
        (["{folder}", "--config", "none.yaml"], 2, "octsim: none.yaml: "),
        (["{folder}", "-o", "{folder}"], 1, "octsim: {folder}: can't be written ("),
    ],
)
def test_what_is_wrong_is_one_line(
    arguments: list[str],
    status: int,
    line: str,
    folder: Path,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    assert main(["report", *(one.format(folder=folder) for one in arguments)]) == status
    said = capsys.readouterr()
    assert said.out == ""
    assert len(said.err.splitlines()) == 1
    assert said.err.startswith(line.format(folder=folder))
