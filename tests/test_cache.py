"""What is read back from a cache is right or missing, whatever became of its file."""

import contextlib
import multiprocessing
import os
import random
import re
import resource
import shutil
import signal
import sqlite3
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Iterator
from pathlib import Path

import cache_worker
import pytest
from cache_worker import GIGABYTES, POINTS, entry

from octsim.cache import PointCache, clear, describe, opened
from octsim.cachetables import Rate
from octsim.errors import CacheError

KILLS = int(os.environ.get("OCTSIM_KILLS", "4"))
ENTRIES = [entry(number) for number in range(POINTS)]
SOME = ENTRIES[:40]
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


def right(cache: PointCache, entries: list[tuple[bytes, bytes]]) -> int:
    """Count what is found, all of which must be right."""
    found = [(body, cache.get(key)) for key, body in entries]
    assert all(read in (None, body) for body, read in found)
    return sum(read is not None for _, read in found)


def log(file: Path) -> Path:
    return file.with_name(file.name + "-wal")


def in_use(file: Path) -> int:
    held = describe(file)
    assert held is not None
    return held.bytes


def in_order(file: Path) -> bool:
    connection = sqlite3.connect(file)
    with contextlib.closing(connection):
        answers = connection.execute("PRAGMA integrity_check").fetchall()
        (strays,) = connection.execute(
            "SELECT (SELECT count(*) FROM points) - count(*) FROM points JOIN bodies USING (number)"
        ).fetchone()
        (more,) = connection.execute(
            "SELECT (SELECT count(*) FROM bodies) - count(*) FROM points JOIN bodies USING (number)"
        ).fetchone()
    return answers == [("ok",)] and strays == more == 0


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


def test_what_was_put_is_there_again_and_nothing_else_is(file: Path) -> None:
    with PointCache(file, GB) as cache:
        assert right(cache, SOME) == 0
        cache.put(iter(SOME))
        assert right(cache, SOME) == len(SOME)
    with PointCache(file, GB) as cache:
        assert right(cache, ENTRIES) == len(SOME)
        cache.put([])
        cache.put([(b"empty", b"")])
        assert cache.get(b"empty") == b""
    assert in_order(file)


def test_the_last_put_of_a_key_counts(file: Path) -> None:
    with PointCache(file, GB) as cache:
        cache.put([(b"key", b"one" * 3000), (b"key", b"two" * 4000)])
        assert cache.get(b"key") == b"two" * 4000
        cache.put([(b"key", b"three")])
        assert cache.get(b"key") == b"three"
    held = describe(file)
    assert held is not None
    assert held.entries == 1
    assert in_order(file)


def test_costs_add_up(filled: Path) -> None:
    with PointCache(filled, GB) as cache:
        cache.record("paths", 2, 0.5, 3_000)
        assert cache.rates("paths") == Rate(42, 2.5, 43_000)
        assert cache.rates("vogel") is None


def test_a_failed_source_of_entries_keeps_none(file: Path) -> None:
    def source() -> Iterator[tuple[bytes, bytes]]:
        yield SOME[0]
        raise ZeroDivisionError

    with PointCache(file, GB) as cache:
        with pytest.raises(ZeroDivisionError):
            cache.put(source())
        assert right(cache, SOME) == 0


def test_no_gigabytes_keep_nothing_and_make_nothing(file: Path) -> None:
    with opened(file, 0) as cache:
        cache.put(SOME)
        cache.record("paths", 1, 1.0, 1)
        assert right(cache, SOME) == 0
        assert cache.rates("paths") is None
    assert not file.parent.exists()


def test_the_least_recently_used_go_first(file: Path) -> None:
    with PointCache(file, GIGABYTES) as cache:
        for begin in range(0, 160, 20):
            cache.put(ENTRIES[begin : begin + 20])
        assert right(cache, ENTRIES[:20]) == 20
    with PointCache(file, GIGABYTES) as cache:  # that these were used is remembered
        for begin in range(160, POINTS, 20):
            cache.put(ENTRIES[begin : begin + 20])
            assert right(cache, ENTRIES[:20]) == 20
        held = [cache.get(key) is not None for key, _ in ENTRIES[20:]]
    assert 0 < sum(held) < 300
    assert held == sorted(held)  # the newest are held, and no older one than a missing one


@pytest.mark.parametrize("batch", [1, 20, POINTS])
def test_the_file_stays_within_its_size(batch: int, file: Path) -> None:
    allowed, logged = GIGABYTES * 1e9, 0
    with PointCache(file, GIGABYTES) as cache:
        for begin in range(0, POINTS, batch):
            cache.put(ENTRIES[begin : begin + batch])
            size = in_use(file)
            assert size <= allowed
            logged = max(logged, log(file).stat().st_size)
    assert file.stat().st_size <= allowed
    assert size > 0.8 * allowed
    assert logged < 12e6
    with PointCache(file, GIGABYTES / 3) as cache:
        cache.put([ENTRIES[0]])
        assert cache.get(ENTRIES[0][0]) == ENTRIES[0][1]
    assert file.stat().st_size <= allowed / 3
    assert in_order(file)


def test_the_log_stays_short_while_others_read(file: Path) -> None:
    body = bytes(20_000)
    with PointCache(file, 1.0) as cache, PointCache(file, 1.0) as other:
        done = threading.Event()

        def read() -> None:
            while not done.is_set():
                other.get(b"0")

        reader = threading.Thread(target=read)
        reader.start()
        sizes = []
        for turn in range(150):
            cache.put((b"%d" % (50 * turn + i), body) for i in range(50))
            sizes.append(log(file).stat().st_size)
        done.set()
        reader.join()
    assert file.stat().st_size > 150e6
    assert max(sizes) < 40e6


def test_threads_share_a_cache(file: Path) -> None:
    wrong: list[bytes] = []
    with PointCache(file, GIGABYTES) as cache:

        def use(seed: int) -> None:
            draw = random.Random(seed)
            for _ in range(30):
                chosen = draw.sample(ENTRIES, 10)
                wrong.extend(k for k, body in chosen if cache.get(k) not in (None, body))
                cache.put(chosen)

        threads = [threading.Thread(target=use, args=(seed,)) for seed in range(4)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        assert right(cache, ENTRIES) > 50
    assert wrong == []
    assert in_order(file)


def start(file: Path, seed: int, turns: int = 1_000_000) -> subprocess.Popen[bytes]:
    arguments = [file, seed, file.with_name("notes"), turns]
    return subprocess.Popen([sys.executable, cache_worker.__file__, *map(str, arguments)])


def test_processes_killed_at_any_moment_leave_no_wrong_value(file: Path) -> None:
    draw = random.Random(5)
    file.parent.mkdir()
    running = [start(file, seed) for seed in range(3)]
    for kill in range(KILLS):
        time.sleep(draw.uniform(0.0, 0.8))
        which = draw.randrange(3)
        running[which].send_signal(signal.SIGKILL)
        running[which].wait()
        running[which] = start(file, 3 + kill)
    time.sleep(0.5)
    for process in running:
        process.kill()
        process.wait()
    with PointCache(file, GIGABYTES) as cache:
        assert right(cache, ENTRIES) > 50
        cache.put(ENTRIES[:50])
        assert right(cache, ENTRIES[:50]) == 50
    assert in_order(file)
    assert file.with_name("notes").read_text() == ""


def test_processes_that_make_one_cache_at_once_agree(file: Path) -> None:
    for turn in range(2):
        place = file.parent / str(turn) / "points.sqlite"
        place.parent.mkdir(parents=True)
        running = [start(place, seed, turns=2) for seed in range(6)]
        assert [process.wait() for process in running] == 6 * [0]
        assert place.with_name("notes").read_text() == ""
        assert in_order(place)


def test_a_fork_opens_the_file_anew(filled: Path) -> None:
    with PointCache(filled, GB) as cache:
        assert right(cache, SOME) == 40

        def use() -> None:
            assert right(cache, SOME) == 40
            cache.put(ENTRIES[40:80])
            os._exit(0)

        child = multiprocessing.get_context("fork").Process(target=use)
        child.start()
        cache.put(ENTRIES[80:120])
        child.join()
        assert child.exitcode == 0
        assert right(cache, ENTRIES) == 120
    assert in_order(filled)


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
    for turn in range(60):
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


def test_clearing_empties_what_another_process_uses(filled: Path) -> None:
    with PointCache(filled, GB) as cache:
        command = [sys.executable, "-m", "octsim", "cache", "clear", "--file", str(filled)]
        subprocess.run(command, check=True, capture_output=True)
        assert right(cache, SOME) == 0
        assert cache.rates("paths") is None
        cache.put(SOME)
        assert right(cache, SOME) == 40
        subprocess.run(command, check=True, capture_output=True)
        assert log(filled).stat().st_size == 0
    assert filled.stat().st_size < 50_000
    assert in_order(filled)


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


def test_a_file_open_twice_in_a_process_stays_locked(filled: Path) -> None:
    # a descriptor of it that is closed would take the locks of SQLite's along
    with PointCache(filled, GB), PointCache(filled, GB):
        describe(filled)
        with pytest.raises(subprocess.CalledProcessError):
            subprocess.run(
                [
                    sys.executable, "-c",
                    "import fcntl, sys; file = open(sys.argv[1], 'r+b');"
                    "fcntl.lockf(file, fcntl.LOCK_EX | fcntl.LOCK_NB, 512, 0x40000000)",
                    str(filled),
                ],
                check=True, capture_output=True,
            )  # fmt: skip
