"""The archive of a run: the same bytes each time, whole, described, and never of two configs."""

import json
import os
import shutil
import subprocess
import sys
import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import IO, Any

import pytest
import xarray as xr
from made_runs import make
from rocrate.rocrate import ROCrate

import octsim
from octsim.archive import zip_file
from octsim.archive.checksums import SUMS
from octsim.archive.pack import pack
from octsim.archive.verify import problems, unpack, unpacked, verify
from octsim.cli.main import main
from octsim.datasets.files import write
from octsim.datasets.gallery import FORMS

ABOUT: dict[str, Any] = {
    "title": "Ours | {run}",
    "description": "What we simulated.",
    "creators": [
        {"name": "Ada Ray", "orcid": "0000-0002-1825-0097", "affiliation": "Institute"},
        {"name": "Max Beam", "affiliation": "Institute"},
    ],
    "license": "CC0-1.0",
    "date": "2026-01-31",
}


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Make a small run, some of its figures, and what an archive has to leave out."""
    folder = tmp_path_factory.mktemp("made") / "tiny"
    make(folder)
    make(folder, scan=False)
    drawn = (f"figures/figure_6.{form}" for form in FORMS)
    for name in (*drawn, "figures/mine.png", "logs/a.log"):
        (folder / name).parent.mkdir(exist_ok=True)
        (folder / name).write_bytes(b"drawn")
    return folder


@pytest.fixture
def folder(made: Path, tmp_path: Path) -> Path:
    return Path(shutil.copytree(made, tmp_path / "tiny"))


def config_of(folder: Path) -> octsim.Config:
    with xr.open_dataset(folder / "phase_slope.nc") as dataset:
        return octsim.load_config(json.loads(dataset.attrs["config"]), {"archive": ABOUT})


def names_in(file: Path) -> list[str]:
    with zipfile.ZipFile(file) as archive:
        return archive.namelist()


def command(*arguments: str | Path, **more: Any) -> subprocess.CompletedProcess[str]:
    line = [sys.executable, "-m", "octsim", *map(str, arguments)]
    return subprocess.run(line, capture_output=True, text=True, check=False, **more)


def test_an_archive_holds_the_run_and_what_explains_it(folder: Path) -> None:
    packed = pack(folder, config_of(folder))
    assert packed.file == folder / "tiny.zip"
    assert packed.bytes == packed.file.stat().st_size
    assert names_in(packed.file) == [
        "README.md", "SHA256SUMS", "config.yaml", "environment.json", "figures/figure_6.pdf",
        "figures/figure_6.png", "figures/figure_6.svg", "figures/figure_6.txt", "focus_scan.nc",
        "phase_slope.nc", "requirements.lock",
        "ro-crate-metadata.json", "spectra.nc",
    ]  # fmt: skip
    goes_without, left_out = packed.remarks
    assert goes_without.startswith(f"{folder}: the archive goes without focus_sweep.nc,")
    assert "fourier.nc" not in names_in(packed.file)
    assert "fourier.nc" in goes_without
    assert "spectra.nc" not in goes_without
    assert (
        left_out == f"{folder}: left out, as no datasets or figures of this run: figures/mine.png"
    )


def test_a_package_that_is_no_checkout_has_no_lock_and_says_so(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("octsim.archive.contents.lock_file", lambda: None)
    packed = pack(folder, config_of(folder))
    assert "requirements.lock" not in names_in(packed.file)
    assert "goes without requirements.lock, which stands in a checkout" in packed.remarks[-1]
    assert problems(packed.file) == []


def test_the_same_run_is_the_same_bytes_wherever_and_whenever(made: Path, tmp_path: Path) -> None:
    found = []
    for number, (zone, mask) in enumerate([("UTC", 0o022), ("Pacific/Auckland", 0o077)]):
        here = tmp_path / str(number)
        names = sorted(made.rglob("*"), reverse=bool(number))
        for file in names:
            if file.is_file():
                copy = here / "tiny" / file.relative_to(made)
                copy.parent.mkdir(parents=True, exist_ok=True)
                copy.write_bytes(file.read_bytes())
                os.utime(copy, (number * 1e9, number * 1e9))
                copy.chmod(0o600 if number else 0o755)
        more = {"TZ": zone, "PYTHONHASHSEED": str(number), "LC_ALL": ("C", "C.UTF-8")[number]}
        environment = os.environ | more
        done = command("archive", "tiny", cwd=here, env=environment, umask=mask)
        assert done.returncode == 0, done.stderr
        found.append((here / "tiny" / "tiny.zip").read_bytes())
    assert found[0] == found[1]


def test_what_is_unpacked_is_what_was_packed(folder: Path, tmp_path: Path) -> None:
    config = config_of(folder)
    file = pack(folder, config).file
    unpack(file, tmp_path / "out" / "there")
    out = tmp_path / "out" / "there"
    assert problems(out) == []
    for one in ("spectra.nc", "figures/figure_6.svg"):
        assert (out / one).read_bytes() == (folder / one).read_bytes()
    assert octsim.load_config(out / "config.yaml") == config
    assert "cache" not in (out / "config.yaml").read_text()
    assert list((tmp_path / "out").iterdir()) == [out]
    told = json.loads((out / "environment.json").read_text())
    with xr.open_dataset(out / "spectra.nc") as dataset:
        assert told["spectra"]["source_digest"] == dataset.attrs["source_digest"]
        assert told["spectra"]["environment"] == json.loads(dataset.attrs["environment"])
    with unpacked(file) as temporary:
        assert problems(temporary) == []
    assert not temporary.exists()
    # packed again from what was unpacked, it is the same archive
    assert pack(out, config, tmp_path / "again.zip").file.read_bytes() == file.read_bytes()


def test_coreutils_agree(folder: Path, tmp_path: Path) -> None:
    unpack(pack(folder, config_of(folder)).file, tmp_path / "out")

    def checked() -> subprocess.CompletedProcess[str]:
        line = ["sha256sum", "--check", "--strict", SUMS]
        return subprocess.run(
            line, cwd=tmp_path / "out", capture_output=True, text=True, check=False
        )

    done = checked()
    assert done.returncode == 0, done.stderr
    assert len(done.stdout.splitlines()) == 12
    (tmp_path / "out" / "spectra.nc").write_bytes(b"other")
    assert "spectra.nc: FAILED" in checked().stdout


def test_a_byte_anywhere_in_a_run_s_archive_is_found(folder: Path, tmp_path: Path) -> None:
    data = pack(folder, config_of(folder)).file.read_bytes()
    bad = tmp_path / "bad.zip"
    for at in range(0, len(data), 1999):
        bad.write_bytes(bytes((*data[:at], data[at] ^ 0x20, *data[at + 1 :])))
        with pytest.raises(octsim.ArchiveError):
            verify(bad)


def test_an_unpacked_folder_says_what_is_missing_changed_and_additional(
    folder: Path, tmp_path: Path
) -> None:
    out = tmp_path / "out"
    unpack(pack(folder, config_of(folder)).file, out)
    (out / "README.md").unlink()
    (out / "notes.txt").write_text("mine")
    (out / "figures" / "figure_6.png").write_bytes(b"other")
    (out / "spectra.nc").rename(tmp_path / "elsewhere.nc")
    (out / "spectra.nc").symlink_to(tmp_path / "elsewhere.nc")
    (out / "up").symlink_to(tmp_path)
    os.mkfifo(out / "pipe")
    assert problems(out) == [
        "README.md: missing", "figures/figure_6.png: changed", "notes.txt: additional",
        "pipe: additional", "spectra.nc: changed", "up: additional",
    ]  # fmt: skip
    done = command("verify", out)
    assert done.returncode == 1
    lines = done.stderr.splitlines()
    assert len(lines) == 6
    assert f"octsim: {out}: README.md: missing" in lines
    with (out / SUMS).open("ab") as stream:
        stream.write(b"x")
    with pytest.raises(octsim.ArchiveError, match="not as octsim writes it"):
        verify(out)


def test_a_dataset_of_another_config_is_not_packed(folder: Path) -> None:
    make(folder, {"scene": {"gap": "9 nm"}})
    for config in (config_of(folder), octsim.load_config(config_of(folder).to_dict())):
        with pytest.raises(octsim.DatasetError, match=r"focus_scan\.nc: .* \(its scene differ\)"):
            pack(folder, config)
    done = command("archive", folder)
    assert done.returncode == 2
    assert len(done.stderr.splitlines()) == 1
    assert not (folder / "tiny.zip").exists()


def test_a_run_of_another_config_than_the_one_asked_for_is_not_packed(folder: Path) -> None:
    asked = octsim.load_config(config_of(folder).to_dict(), {"spectrum": {"samples": 65}})
    with pytest.raises(octsim.DatasetError, match="its spectrum differ"):
        pack(folder, asked)


@pytest.mark.parametrize(
    "change",
    [
        lambda file: file.write_bytes(file.read_bytes()[::-1]),
        lambda file: file.write_bytes(file.read_bytes()[:-1]),
        lambda file: file.write_bytes(file.read_bytes() * 2),
    ],
    ids=["as long", "shorter", "longer"],
)
def test_a_file_that_changes_while_it_is_packed_is_said_and_the_old_archive_stays(
    change: Callable[[Path], object], folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    file = pack(folder, config_of(folder)).file
    before = file.read_bytes()

    def writing(stream: IO[bytes], members: list[zip_file.Member]) -> None:
        change(folder / "spectra.nc")
        zip_file.write(stream, members)

    monkeypatch.setattr("octsim.archive.pack.write", writing)
    with pytest.raises(octsim.ArchiveError, match=r"spectra\.nc: changed while it was packed"):
        pack(folder, config_of(folder))
    assert file.read_bytes() == before
    assert not list(folder.glob(".*"))


LIMITED = """
import resource, sys
from octsim.cli.main import main
resource.setrlimit(resource.RLIMIT_FSIZE, (20_000, 20_000))
sys.exit(main(sys.argv[1:]))
"""


def limited(*arguments: str | Path) -> str:
    """Run the command where no file can grow beyond 20 kB; give its one line."""
    line = [sys.executable, "-c", LIMITED, *map(str, arguments)]
    done = subprocess.run(line, capture_output=True, text=True, check=False)
    assert done.returncode == 2, done.stderr
    (said,) = done.stderr.splitlines()
    return said


def test_trouble_with_the_disk_is_one_line_and_what_was_there_stays(
    folder: Path, tmp_path: Path
) -> None:
    file = pack(folder, config_of(folder)).file
    before = file.read_bytes()
    said = limited("archive", folder)
    assert said == f"octsim: {file}: can't be written (File too large); what was there is unchanged"
    assert file.read_bytes() == before
    said = limited("unpack", file, tmp_path / "out" / "run")
    assert said == f"octsim: {tmp_path / 'out' / 'run'}: can't be written (File too large)"
    assert list((tmp_path / "out").iterdir()) == []


def test_only_into_a_folder_that_is_empty(folder: Path, tmp_path: Path) -> None:
    file = pack(folder, config_of(folder)).file
    (tmp_path / "empty").mkdir()
    unpack(file, tmp_path / "empty")
    assert problems(tmp_path / "empty") == []
    (tmp_path / "used").mkdir()
    (tmp_path / "used" / "notes").write_text("mine")
    for place in (tmp_path / "used", tmp_path / "used" / "notes", tmp_path / "empty"):
        with pytest.raises(octsim.FileError, match="not an empty folder; give one that is"):
            unpack(file, place)
    assert [one.name for one in (tmp_path / "used").iterdir()] == ["notes"]


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (("verify", "none.zip"), "none.zip: can't be read (No such file or directory)"),
        (("verify", "tiny/none"), "tiny/none: can't be read (No such file or directory)"),
        (("verify", "."), ".: no datasets and no archive; give one as results/thesis"),
        (("verify", "notes"), "notes: not a zip that is whole"),
        (("unpack", "tiny", "out"), "tiny: is a folder; give an archive's zip"),
        (("unpack", "notes", "out"), "notes: not a zip that is whole"),
        (("archive", "none"), "none: no datasets; give a folder as results/thesis"),
        (("archive", "tiny", "--config", "none.yaml"), "none.yaml: can't be read"),
        (("archive", "tiny", "--file", "notes/a.zip"), "notes/a.zip: can't be written"),
    ],
)
def test_what_cannot_be_done_is_one_line(
    arguments: tuple[str, ...], said: str, folder: Path
) -> None:
    (folder.parent / "notes").write_text("mine")
    done = command(*arguments, cwd=folder.parent)
    assert done.returncode == 2
    (line,) = done.stderr.splitlines()
    assert line.startswith(f"octsim: {said}")
    assert not (folder.parent / "out").exists()


def test_the_command_takes_what_it_says_of_the_run_from_a_config(
    folder: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    mine, file = tmp_path / "mine.yaml", tmp_path / "a.zip"
    mine.write_text(json.dumps({"run": "other", "archive": ABOUT}))
    arguments = ["archive", str(folder), "--file", str(file)]
    assert main([*arguments, "--config", str(mine)]) == 0
    assert "archive.date" not in capsys.readouterr().err
    assert file.read_bytes() == pack(folder, config_of(folder)).file.read_bytes()
    file.unlink()  # what is replaced is kept
    assert main(arguments) == 0
    said = capsys.readouterr().err.splitlines()
    assert said[0].startswith("octsim: warning: archive.date: not given, so 1980-01-01 stands")
    assert said[1].startswith("octsim: warning: archive.creators: not given")


def test_the_day_is_never_the_clock_s(
    folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    config = config_of(folder)
    config = octsim.load_config(config.to_dict(), {"archive": {"date": None}})

    def day() -> str:
        with zipfile.ZipFile(pack(folder, config, tmp_path / "a.zip").file) as archive:
            graph = json.loads(archive.read("ro-crate-metadata.json"))["@graph"]
        (root,) = (one for one in graph if one["@id"] == "./")
        return str(root["datePublished"])

    monkeypatch.delenv("SOURCE_DATE_EPOCH", raising=False)
    assert day() == "1980-01-01"
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "1769900400")
    assert day() == "2026-01-31"
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "today")
    with pytest.raises(octsim.ArchiveError, match="SOURCE_DATE_EPOCH: 'today' given"):
        day()


def test_the_metadata_is_an_ro_crate(folder: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    unpack(pack(folder, config_of(folder)).file, out)
    told = json.loads((out / "ro-crate-metadata.json").read_text())
    assert told["@context"][0] == "https://w3id.org/ro/crate/1.1/context"
    graph = {one["@id"]: one for one in told["@graph"]}
    assert len(graph) == len(told["@graph"])
    assert graph["ro-crate-metadata.json"]["about"] == {"@id": "./"}
    root = graph["./"]
    assert root["@type"] == "Dataset"
    assert (root["name"], root["description"]) == (ABOUT["title"], ABOUT["description"])
    assert root["datePublished"] == "2026-01-31"
    assert root["license"] == {"@id": "https://spdx.org/licenses/CC0-1.0"}
    assert [graph[one["@id"]]["name"] for one in root["creator"]] == ["Ada Ray", "Max Beam"]
    assert root["creator"][0]["@id"] == "https://orcid.org/0000-0002-1825-0097"
    files = {one.relative_to(out).as_posix() for one in out.rglob("*") if one.is_file()}
    parts = {one["@id"] for one in root["hasPart"]}
    assert parts == files - {"ro-crate-metadata.json"}
    sums = dict(line.split("  ")[::-1] for line in (out / SUMS).read_text().splitlines())
    for name in parts - {SUMS}:
        assert graph[name]["@type"] == "File"
        assert graph[name]["sha256"] == sums[name]
        assert int(graph[name]["contentSize"]) == (out / name).stat().st_size
        assert graph[name]["name"]
    assert "phase_slope (mrad/nm)" in graph["phase_slope.nc"]["variableMeasured"]
    for form, media in FORMS.items():
        figure = graph[f"figures/figure_6.{form}"]
        assert figure["isBasedOn"] == [{"@id": "focus_scan.nc"}]
        assert figure["encodingFormat"] == media
    (action,) = (one for one in told["@graph"] if one["@type"] == "CreateAction")
    assert graph[action["instrument"]["@id"]]["softwareVersion"] == octsim.__version__
    assert {one["@id"] for one in action["result"]} == {n for n in files if n.endswith(".nc")}

    def references(part: object) -> list[str]:
        if isinstance(part, dict):
            own = [part["@id"]] if set(part) == {"@id"} else []
            return own + [one for value in part.values() for one in references(value)]
        return [o for value in part for o in references(value)] if isinstance(part, list) else []

    outside = {one for one in references(told["@graph"]) if one not in graph}
    assert outside == {"https://w3id.org/ro/crate/1.1", action["actionStatus"]["@id"]}
    assert ROCrate(out).root_dataset["name"] == ABOUT["title"]  # other tools read it


def test_an_animation_goes_with_the_scan_that_it_is_of(folder: Path, tmp_path: Path) -> None:
    (folder / "figures" / "animation.gif").write_bytes(b"GIF89a")
    packed = pack(folder, config_of(folder))
    assert not [said for said in packed.remarks if "animation.gif" in said]
    unpack(packed.file, tmp_path / "out")
    told = json.loads((tmp_path / "out" / "ro-crate-metadata.json").read_text())
    (moving,) = (one for one in told["@graph"] if one["@id"] == "figures/animation.gif")
    assert moving["encodingFormat"] == "image/gif"
    assert moving["isBasedOn"] == [{"@id": "focus_scan.nc"}]


def test_no_file_is_packed_but_those_of_the_run(folder: Path, tmp_path: Path) -> None:
    """An expansion holds its series; what its config names as one may be anybody's."""
    secret = tmp_path / "secret"
    secret.write_text("a key")
    (folder / "figures" / "figure_6.svg").unlink()
    (folder / "figures" / "figure_6.svg").symlink_to(secret)
    (folder / "figures" / "figure_6.gif").write_text("mine")
    shutil.copy(folder / "spectra.nc", folder / "spectra_backup.nc")
    (folder / ".spectra.partial.nc").touch()
    config = octsim.load_config(config_of(folder).to_dict())
    named = octsim.load_config(config.to_dict(), {"expansion": {"series": str(secret)}})
    packed = pack(folder, named)
    with zipfile.ZipFile(packed.file) as archive:
        names = archive.namelist()
    assert "figures/figure_6.png" in names
    assert not {"figures/figure_6.svg", "figures/figure_6.gif", "spectra_backup.nc"} & set(names)
    assert b"a key" not in packed.file.read_bytes()
    (left,) = (said for said in packed.remarks if "left out" in said)
    for name in ("figures/figure_6.svg", "figures/figure_6.gif", "spectra_backup.nc"):
        assert name in left


def test_an_unpacked_archive_stays_as_it_is_and_packs_to_the_same_bytes(
    folder: Path, tmp_path: Path
) -> None:
    file = pack(folder, config_of(folder)).file
    unpack(file, tmp_path / "out")
    config = octsim.load_config(tmp_path / "out" / "config.yaml")
    with pytest.raises(octsim.ArchiveError, match="is an unpacked archive, which stays as it is"):
        pack(tmp_path / "out", config)
    again = pack(tmp_path / "out", config, tmp_path / "again.zip").file
    assert again.read_bytes() == file.read_bytes()
    verify(tmp_path / "out")


def test_data_of_other_libraries_is_said_as_the_lock_is_not_theirs(folder: Path) -> None:
    assert not [said for said in pack(folder, config_of(folder)).remarks if "lock" in said]
    dataset = xr.load_dataset(folder / "spectra.nc")
    write(dataset.assign_attrs(environment="{"), folder / "spectra.nc")
    (said,) = (one for one in pack(folder, config_of(folder)).remarks if "lock" in one)
    assert "spectra was computed with other libraries" in said


def test_an_orcid_id_is_of_one_person() -> None:
    twice = [{"name": name, "orcid": "0000-0002-1825-0097"} for name in ("A", "B")]
    with pytest.raises(octsim.ConfigError, match=r"archive\.creators: .*is given for two of them"):
        octsim.load_config({"archive": {"creators": twice}})


def test_who_made_the_data_is_in_the_readme_and_kept_when_packed_again(
    folder: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    about = tmp_path / "about.yaml"
    about.write_text(
        "archive:\n  date: 2026-01-31\n  license: MIT\n  creators:\n"
        "    - {name: Ada Ray, orcid: 0000-0002-1825-0097, affiliation: A {braced} place}\n"
        "    - {name: Max Beam}\n".replace("A {braced} place", "'A {braced} place'")
    )
    assert main(["archive", str(folder), "--config", str(about)]) == 0
    file = folder / "tiny.zip"
    first = file.read_bytes()
    with zipfile.ZipFile(file) as archive:
        told = archive.read("README.md").decode()
    assert (
        "- Ada Ray, A {braced} place, https://orcid.org/0000-0002-1825-0097\n- Max Beam\n" in told
    )
    assert "Licence: MIT, published 2026-01-31." in told
    assert main(["archive", str(folder)]) == 0
    assert "archive.creators" not in capsys.readouterr().err
    assert file.read_bytes() == first
    file.write_bytes(b"not a zip")
    assert main(["archive", str(folder)]) == 0
    assert "archive.creators: not given" in capsys.readouterr().err
