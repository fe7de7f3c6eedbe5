"""What is read back is right or missing, and nothing of others is touched, whatever the file."""

import contextlib
import os
import random
import re
import resource
import shutil
import sqlite3
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path

import pytest
from cache_worker import ENTRIES, POINTS, SOME, in_order, log, right

from octsim.base.errors import CacheError
from octsim.instrument.cache import PointCache, clear, describe

GB = 0.1


@pytest.fixture
def file(tmp_path: Path) -> Path:
    return tmp_path / "cache" / "points.sqlite"


@pytest.fixture
def filled(file: Path) -> Path:
    with PointCache(file, GB) as cache:
        cache.put(SOME)
        cache.record("paths", 40, 2.0, 40_000)
    return file


def flip(file: Path, place: int, mask: int = 0x41) -> None:
    with file.open("r+b") as stream:
        stream.seek(place)
        (byte,) = stream.read(1)
        stream.seek(place)
        stream.write(bytes([byte ^ mask]))


@contextlib.contextmanager
def unprivileged(*places: Path) -> Iterator[None]:
    """Take the right to write in places; from root too, who may write anywhere."""
    modes = [place.stat().st_mode for place in places]
    for place in places:
        place.chmod(0o555 if place.is_dir() else 0o444)
    root = os.geteuid() == 0
    if root:
        os.seteuid(65534)
    try:
        yield
    finally:
        if root:
            os.seteuid(0)
        for place, mode in zip(places, modes, strict=True):
            place.chmod(mode)


@pytest.fixture
def public() -> Iterator[Path]:
    """Make a folder that others may enter."""
    with tempfile.TemporaryDirectory() as name:
        Path(name).chmod(0o755)
        yield Path(name)


@pytest.mark.parametrize("place", [0, 1, 2_000, 4_100, 5_999])
def test_a_damaged_body_is_dropped_and_can_be_put_again(
    place: int, filled: Path, caplog: pytest.LogCaptureFixture
) -> None:
    key, body = SOME[7]
    begin = min(place, len(body) - 16)
    flip(filled, filled.read_bytes().index(body[begin : begin + 16]) + place - begin)
    with PointCache(filled, GB) as cache:
        assert cache.get(key) is None
        assert cache.get(key) is None
        assert right(cache, SOME) == 39
        cache.put([SOME[7]])
        assert right(cache, SOME) == 40
    assert [r.message.split(": ", 2)[2] for r in caplog.records] == [
        f"{filled}: a damaged point is left out, and traced anew"
    ]
    assert in_order(filled)


def test_a_damaged_key_finds_nothing_wrong(filled: Path) -> None:
    key, _ = SOME[7]
    content = filled.read_bytes()
    (place,) = (m.start() for m in re.finditer(re.escape(key), content))
    last = SOME[39][0]
    for other in (SOME[8][0], last, bytes(len(key)), key[:-1] + b"!"):
        filled.write_bytes(content[:place] + other + content[place + len(key) :])
        with PointCache(filled, GB) as cache:
            right(cache, SOME)
            cache.put([SOME[7]])
            assert cache.get(key) == SOME[7][1]
            cache.put(ENTRIES[40:])
            assert right(cache, ENTRIES) > 350


def survives(file: Path) -> None:
    """Use what may be damaged as a run would: nothing is wrong, and clearing mends it."""
    try:
        with PointCache(file, GB) as cache:
            right(cache, ENTRIES)
            cache.put(ENTRIES[20:60])
            right(cache, ENTRIES)
            cache.record("paths", 1, 1.0, 1)
            cache.rates("paths")
        with contextlib.suppress(CacheError):
            describe(file)
        clear(file)
    except CacheError as error:
        told = str(error)
        # what can't be recognised is somebody's, and stays
        assert "move it away" in told
        file.unlink()
    with PointCache(file, GB) as cache:
        assert right(cache, ENTRIES) == 0
        cache.put(SOME)
        assert right(cache, SOME) == 40
    assert in_order(file)


@pytest.mark.parametrize("pages", ["first", "all"])
def test_a_changed_byte_anywhere_gives_nothing_wrong(pages: str, filled: Path) -> None:
    draw = random.Random(11)
    content = filled.read_bytes()
    for turn in range(30):
        changed = bytearray(content)
        for _ in range(1 + turn % 3):
            place = draw.randrange(100 if pages == "first" else len(content))
            changed[place] ^= draw.randrange(1, 256)
        filled.write_bytes(changed)
        survives(filled)


def test_a_page_of_anything_gives_nothing_wrong(filled: Path) -> None:
    draw = random.Random(12)
    content = filled.read_bytes()
    for begin in range(0, len(content), 4096):
        changed = bytearray(content)
        kept = 100 if begin == 0 else 0
        changed[begin + kept : begin + 4096] = draw.randbytes(4096 - kept)
        filled.write_bytes(changed)
        survives(filled)


@pytest.mark.parametrize("left", [1, 99, 4_096, 50_000, 200_001])
def test_a_truncated_file_gives_nothing_wrong(left: int, filled: Path) -> None:
    os.truncate(filled, left)
    survives(filled)


def test_a_log_cut_off_or_changed_gives_nothing_wrong(filled: Path) -> None:
    with PointCache(filled, GB) as cache:
        cache.put(ENTRIES[40:80])
        database, logged = filled.read_bytes(), log(filled).read_bytes()
    assert len(logged) > 100_000
    for turn in range(8):
        filled.write_bytes(database)
        log(filled).write_bytes(logged[: 20_000 * turn])
        if turn % 2:
            flip(log(filled), 10_000 * turn)
        survives(filled)


def test_damage_met_on_the_way_is_said_once(filled: Path, caplog: pytest.LogCaptureFixture) -> None:
    with PointCache(filled, GB) as cache:
        content = filled.read_bytes()
        filled.write_bytes(content[:4096] + bytes(len(content) - 4096))
        for _ in range(3):
            assert right(cache, SOME) == 0
            cache.put(SOME)
        assert len(caplog.records) == 1
        assert f"`octsim cache clear --file {filled}` makes a new one" in caplog.text
        clear(filled)  # this run no longer uses it
        assert right(cache, SOME) == 0
    with PointCache(filled, GB) as cache:
        cache.put(SOME)
        assert right(cache, SOME) == 40


@pytest.mark.parametrize("what", ["text", "database", "short", "later"])
def test_what_is_no_cache_of_this_octsim_is_refused_and_stays(what: str, filled: Path) -> None:
    if what == "later":
        flip(filled, 63, 0x02)
    else:
        filled.unlink()
    if what == "database":
        with contextlib.closing(sqlite3.connect(filled)) as connection:
            connection.execute("PRAGMA journal_mode = WAL")
            connection.execute("CREATE TABLE points (mine)")
            connection.commit()
            # as a killed process leaves it: its last words in a log
            shutil.copytree(filled.parent, filled.parent.with_name("copy"))
        shutil.rmtree(filled.parent)
        shutil.move(filled.parent.with_name("copy"), filled.parent)
    elif what != "later":
        filled.write_text({"text": 50 * "my notes\n", "short": "my"}[what])
    before = {path: path.read_bytes() for path in filled.parent.iterdir()}
    says = "later octsim" if what == "later" else "is not a point cache"
    for use in (lambda: PointCache(filled, GB), lambda: describe(filled), lambda: clear(filled)):
        with pytest.raises(CacheError, match=rf"points.sqlite: .*{says}.*; move it away") as told:
            use()
        assert "\n" not in str(told.value)
    assert {path: path.read_bytes() for path in filled.parent.iterdir()} == before


@pytest.mark.parametrize("state", ["alone", "in use", "left by a kill"])
def test_what_cannot_be_written_is_read(
    state: str, public: Path, caplog: pytest.LogCaptureFixture
) -> None:
    file = public / "points.sqlite"
    cache = PointCache(file, GB)
    cache.put(SOME)
    if state == "left by a kill":
        left = public / "left"
        shutil.copytree(public, left)
        file = left / "points.sqlite"
        file.with_name("points.sqlite-shm").unlink()
    if state != "in use":
        cache.close()
    with unprivileged(file, file.parent), PointCache(file, GB) as other:
        found = right(other, SOME)
        other.put(ENTRIES)
        other.record("paths", 1, 1.0, 1)
        assert right(other, ENTRIES) == found
        assert found == (0 if state == "left by a kill" else 40)
        with pytest.raises(CacheError, match=r"points.sqlite: can't be cleared \("):
            clear(file)
    cache.close()
    assert len(caplog.records) == 1
    assert "new points are not kept" in caplog.text


def test_where_no_file_can_be_made_a_run_goes_on(
    public: Path, caplog: pytest.LogCaptureFixture
) -> None:
    file = public / "cache" / "points.sqlite"
    with unprivileged(public), PointCache(file, GB) as cache:
        cache.put(SOME)
        assert right(cache, SOME) == 0
    assert [r.message for r in caplog.records] == [
        f"octsim: warning: {file}: can't be opened (Permission denied); new points are not kept"
    ]
    assert list(public.iterdir()) == []


@contextlib.contextmanager
def longest_file(size: int) -> Iterator[None]:
    """Have every write beyond a size fail."""
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (size, hard))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))


def test_a_full_disk_is_said_once_and_reads_go_on(
    filled: Path, caplog: pytest.LogCaptureFixture
) -> None:
    with PointCache(filled, GB) as cache:
        right(cache, SOME)
        with longest_file(100_000):
            for _ in range(3):
                cache.put(ENTRIES)
                assert right(cache, ENTRIES) == 40
    assert len(caplog.records) == 1
    assert "points.sqlite: can't be written (" in caplog.text
    with PointCache(filled, GB) as cache:
        assert right(cache, ENTRIES) == 40
        cache.put(ENTRIES)
        assert right(cache, ENTRIES) == POINTS
    assert in_order(filled)


@pytest.mark.parametrize("size", [0, 50, 5_000])
def test_a_disk_that_is_full_from_the_start_leaves_no_half_cache(
    size: int, file: Path, caplog: pytest.LogCaptureFixture
) -> None:
    with longest_file(size), PointCache(file, GB) as cache:
        cache.put(SOME)
        assert right(cache, SOME) == 0
    assert len(caplog.records) == 1
    assert "points.sqlite: can't be opened (" in caplog.text
    with PointCache(file, GB) as cache:
        cache.put(SOME)
        assert right(cache, SOME) == 40


def test_a_damaged_file_is_not_replaced_under_those_who_use_it(filled: Path) -> None:
    command = [sys.executable, "-m", "octsim", "cache", "clear", "--file", str(filled)]
    # to open it here, and to close that again, would take the locks of SQLite's along
    code = f"from pathlib import Path\nfile = Path({str(filled)!r}).open('r+b')\nfile.write(b'?')"
    with PointCache(filled, GB):
        subprocess.run([sys.executable, "-c", code], check=True)
        done = subprocess.run(command, check=False, capture_output=True, text=True)
        assert done.returncode == 1
        assert "clear it when nothing uses it" in done.stderr
    assert filled.stat().st_size > 200_000
    subprocess.run(command, check=True, capture_output=True)
    survives(filled)
