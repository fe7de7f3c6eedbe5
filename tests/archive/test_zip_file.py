"""The zip of an archive: one for given contents, every bit of it checked, nothing hostile read."""

import hashlib
import io
import stat
import struct
import zipfile
from collections.abc import Callable
from functools import partial
from pathlib import Path, PurePosixPath, PureWindowsPath

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from octsim.archive import zip_file
from octsim.archive.checksums import LARGEST, SUMS, format_sums, parse_sums
from octsim.archive.safe_names import is_plain
from octsim.archive.verify import problems, unpack, verify
from octsim.base.errors import ArchiveError

FILES = {"a.nc": b"light" * 3, "figures/b.svg": b"<svg/>", "README.md": b"", "inputs/c.csv": b"1"}

SMALL = {"a.nc": b"light", "b/c": b"1"}


def digest(data: bytes) -> str:
    return hashlib.sha256(data).hexdigest()


def members(files: dict[str, bytes]) -> list[zip_file.Member]:
    return [
        zip_file.Member(name, len(data), partial(io.BytesIO, data)) for name, data in files.items()
    ]


def with_sums(files: dict[str, bytes]) -> dict[str, bytes]:
    return {**files, SUMS: format_sums({name: digest(data) for name, data in files.items()})}


def packed(files: dict[str, bytes]) -> bytes:
    stream = io.BytesIO()
    zip_file.write(stream, members(files))
    return stream.getvalue()


def is_found(file: Path, data: bytes) -> bool:
    file.write_bytes(data)
    try:
        return bool(problems(file))
    except ArchiveError:
        return True


def refused(tmp_path: Path, data: bytes) -> str:
    """Return why an archive is refused, and see that nothing of it is written anywhere."""
    home = tmp_path / "home" / "below"
    home.mkdir(parents=True)
    (home / "bad.zip").write_bytes(data)
    with pytest.raises(ArchiveError) as caught:
        unpack(home / "bad.zip", home / "out")
    with pytest.raises(ArchiveError):
        problems(home / "bad.zip")
    assert sorted(tmp_path.rglob("*")) == [home.parent, home, home / "bad.zip"]
    said = str(caught.value).removeprefix(f"{home / 'bad.zip'}: ")
    assert "\n" not in said
    return said


def test_the_same_contents_are_the_same_bytes_in_any_order_and_for_ever() -> None:
    data = packed(with_sums(FILES))
    assert packed(dict(reversed(with_sums(FILES).items()))) == data
    known = "8c17d9292f1c33d0dadb7ba3e25f79dcf854e4f8f569f3023a7c0c879caca719"
    assert digest(data) == known  # as octsim 0.2.0 packs them


def test_other_readers_read_it_and_nothing_in_it_can_be_run() -> None:
    with zipfile.ZipFile(io.BytesIO(packed(with_sums(FILES)))) as archive:
        assert archive.testzip() is None
        assert {name: archive.read(name) for name in archive.namelist()} == with_sums(FILES)
        assert {info.external_attr >> 16 for info in archive.infolist()} == {stat.S_IFREG | 0o644}


@pytest.mark.parametrize("limit", [None, 10], ids=["usual", "as if beyond 4 GB"])
def test_every_flipped_bit_is_found(
    limit: int | None, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    if limit:
        monkeypatch.setattr(zipfile, "ZIP64_LIMIT", limit)
    data, file = packed(with_sums(SMALL)), tmp_path / "a.zip"
    assert not is_found(file, data)
    for at in range(len(data)):
        for flip in (1 << bit for bit in range(8)):
            changed = bytes((*data[:at], data[at] ^ flip, *data[at + 1 :]))
            assert is_found(file, changed), (at, flip)


def test_every_byte_that_is_missing_or_additional_is_found(tmp_path: Path) -> None:
    data, file = packed(with_sums(SMALL)), tmp_path / "a.zip"
    for at in range(len(data) + 1):
        assert is_found(file, data[:at] + b"\0" + data[at:]), at
        if at < len(data):
            assert is_found(file, data[:at] + data[at + 1 :]), at
            assert is_found(file, data[:at]), at
    assert is_found(file, data + data)


def test_what_is_changed_is_named(tmp_path: Path) -> None:
    file = tmp_path / "a.zip"

    def said(data: bytes) -> list[str]:
        file.write_bytes(data)
        return problems(file)

    files = with_sums(FILES)
    data = packed(files)
    assert said(data) == []
    assert said(data.replace(b"light", b"night", 1)) == ["a.nc: changed"]
    a_sum = digest(FILES["a.nc"]).encode()
    assert said(data.replace(a_sum, a_sum.upper())) == [f"{SUMS}: changed"]
    assert said(data[:-2] + b"\1\0!") == ["its headers or its directory: changed"]
    others = {name: one for name, one in files.items() if name != "a.nc"} | {"d.nc": b""}
    assert said(packed(others)) == ["a.nc: missing", "d.nc: additional"]


def test_a_sums_file_that_is_not_canonical_is_refused_in_a_zip_that_is(tmp_path: Path) -> None:
    sums = with_sums(FILES)[SUMS]
    lines = sums.splitlines(keepends=True)
    for number, (bad, why) in enumerate(
        [
            (sums.upper(), "line 1: not a digest and a name"),
            (b"".join(reversed(lines)), "not as octsim writes it"),
            (sums + lines[0], "twice"),
            (sums[:-1], "not as octsim writes it"),
            (sums.replace(b"  ", b" *"), "line 1: not a digest"),
            (sums + b"\n", "line 5: not a digest"),
            (sums.replace(b"\n", b"\r\n"), "not a plain path"),
            (sums + b"\xff", "not text"),
            (format_sums({SUMS: "0" * 64}), "without itself"),
        ]
    ):  # fmt: skip
        folder = tmp_path / str(number)
        folder.mkdir()
        assert why in refused(folder, packed({**FILES, SUMS: bad}))


BAD_NAMES = [
    "../evil", "figures/../../evil", "/etc/evil", "..", ".", "", "a//b", "a/", "./a", ".hidden",
    "..\\evil", "a\\b", "C:evil", "C:/evil", "\\\\host\\evil", "~/evil", "a\nb", "a\x1b[2Jb",
    "é.nc", "a\u202eb", "NUL", "con.nc", "figures/aux", "a.", "a ", "a b", "a:b", "-rf", "a" * 200,
    "/".join("abcdefghij"),
]  # fmt: skip


@pytest.mark.parametrize("name", [name for name in BAD_NAMES if name], ids=ascii)
def test_a_name_that_leaves_the_folder_is_refused(name: str, tmp_path: Path) -> None:
    said = refused(tmp_path, packed(with_sums({"a.nc": b"x"}) | {name: b"evil"}))
    assert said.startswith("holds ")
    assert "not a plain path below its folder" in said
    assert said.isprintable()


@pytest.mark.parametrize("name", BAD_NAMES, ids=ascii)
def test_a_name_that_leaves_the_folder_is_refused_in_the_sums(name: str, tmp_path: Path) -> None:
    sums = f"{'0' * 64}  {name}\n".encode()
    said = refused(tmp_path, packed({"a.nc": b"x", SUMS: sums}))
    assert said.startswith(SUMS)
    assert said.isprintable()


@pytest.mark.parametrize(
    ("names", "why"),
    [
        (("a.nc", "A.nc"), "the same but for its case"),
        (("figures/a.png", "Figures/b.png"), "the same but for its case"),
        (("a", "a/b"), "as a file and as a folder"),
        (("a/b", "a"), "as a file and as a folder"),
    ],
)
def test_names_that_can_be_one_file_are_refused(
    names: tuple[str, ...], why: str, tmp_path: Path
) -> None:
    assert why in refused(tmp_path, packed(with_sums(dict.fromkeys(names, b"x"))))


@pytest.mark.filterwarnings("ignore:Duplicate name")
def test_a_name_that_stands_twice_is_refused(tmp_path: Path) -> None:
    stream = io.BytesIO()
    zip_file.write(stream, [*members(with_sums(FILES)), *members({"a.nc": b"other"})])
    assert refused(tmp_path, stream.getvalue()) == "holds a.nc twice"


def by_hand(change: Callable[[zipfile.ZipInfo], None], data: bytes = b"../../etc") -> bytes:
    """Pack a good archive, and another member that is changed before."""
    stream = io.BytesIO(packed(with_sums(FILES)))
    with zipfile.ZipFile(stream, "a") as archive:
        info = zipfile.ZipInfo("z", (1980, 1, 1, 0, 0, 0))
        info.create_system, info.external_attr = 3, (stat.S_IFREG | 0o644) << 16
        change(info)
        archive.writestr(info, data)
    return stream.getvalue()


@pytest.mark.parametrize(
    ("mode", "kind"),
    [
        (stat.S_IFLNK | 0o777, "a link"),
        (stat.S_IFDIR | 0o755, "not a plain file"),
        (stat.S_IFIFO | 0o644, "not a plain file"),
        (stat.S_IFREG | 0o755, "not a plain file"),
        (stat.S_IFREG | stat.S_ISUID | 0o644, "not a plain file"),
    ],
)
def test_links_folders_and_programs_are_refused(mode: int, kind: str, tmp_path: Path) -> None:
    def change(info: zipfile.ZipInfo) -> None:
        info.external_attr = mode << 16

    assert refused(tmp_path, by_hand(change)) == f"holds 'z', which is {kind}"


def test_a_bomb_is_refused_before_it_is_inflated(tmp_path: Path) -> None:
    def change(info: zipfile.ZipInfo) -> None:
        info.compress_type = zipfile.ZIP_DEFLATED

    bomb = by_hand(change, bytes(50_000_000))
    assert len(bomb) < 100_000
    assert refused(tmp_path, bomb) == "holds z compressed, as octsim packs no file"


def test_sizes_that_are_stated_and_not_there_are_refused(tmp_path: Path) -> None:
    data = bytearray(packed(with_sums(FILES)))
    at = data.index(b"PK\1\2") + 20  # compressed and plain size of the first in the directory
    data[at : at + 8] = struct.pack("<II", 2_000_000_000, 2_000_000_000)
    assert refused(tmp_path, bytes(data)) == "states that it holds more than it can"


def test_members_that_share_their_bytes_are_refused(tmp_path: Path) -> None:
    data = bytearray(packed(with_sums({"a": b"x" * 500, "b": b"x" * 500})))
    entries = [at for at in range(len(data)) if data[at : at + 4] == b"PK\1\2"]
    data[entries[2] + 42 : entries[2] + 46] = data[entries[1] + 42 : entries[1] + 46]
    file = tmp_path / "a.zip"
    assert is_found(file, bytes(data))


def test_a_directory_without_bound_is_not_read(tmp_path: Path) -> None:
    size = LARGEST + 1
    end = struct.pack("<4s4H2LH", b"PK\5\6", 0, 0, 1, 1, size, 0, 0)
    assert "directory is larger" in refused(tmp_path, b"PK\1\2".ljust(size, b"\0") + end)


def test_what_is_no_zip_is_refused_in_a_line(tmp_path: Path) -> None:
    for number, data in enumerate([b"", b"PK", b"text" * 100, packed({}), packed(FILES)]):
        (tmp_path / str(number)).mkdir()
        said = refused(tmp_path / str(number), data)
        assert "not a zip" in said or f"holds no {SUMS}" in said


DEVICES = {"CON", "PRN", "AUX", "NUL", *(f"{one}{n}" for one in ("COM", "LPT") for n in range(10))}


@given(st.text(max_size=12) | st.text("abAB./\\:~- \0", max_size=12))
@example("a/b.nc")
@example("a/Aux.nc")
def test_a_plain_name_is_below_its_folder_on_every_system(name: str) -> None:
    if not is_plain(name):
        return
    assert not PurePosixPath(name).is_absolute()
    there = PureWindowsPath(name)
    assert (there.drive, there.root) == ("", "")
    assert not {part.split(".")[0].upper() for part in there.parts} & DEVICES
    assert ".." not in there.parts
    assert "/".join(there.parts) == "/".join(PurePosixPath(name).parts) == name


@given(st.dictionaries(st.from_regex(r"[a-z]{1,8}(\.nc)?", fullmatch=True), st.binary(max_size=9)))
def test_sums_are_read_as_they_are_written(files: dict[str, bytes]) -> None:
    digests = {name: digest(data) for name, data in files.items() if is_plain(name)}
    assert parse_sums(format_sums(digests)) == digests


def test_what_is_exchanged_after_it_was_verified_is_not_written(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    file = tmp_path / "a.zip"
    file.write_bytes(packed(with_sums(FILES)))

    def verify_and_exchange(path: Path) -> None:
        verify(path)
        path.write_bytes(packed({"../evil": b"x"}))

    monkeypatch.setattr("octsim.archive.verify.verify", verify_and_exchange)
    with pytest.raises(ArchiveError, match="not a plain path"):
        unpack(file, tmp_path / "out")
    assert [one.name for one in tmp_path.rglob("*")] == ["a.zip"]
