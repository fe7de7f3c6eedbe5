"""A cache gives back what was put, whoever uses it at the same time and whoever is killed."""

import fcntl
import multiprocessing
import os
import random
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from pathlib import Path

import cache_worker
import pytest
from cache_worker import ENTRIES, GIGABYTES, POINTS, SOME, in_order, in_use, log, right

from octsim.instrument.cache import PointCache, describe, opened
from octsim.instrument.cachetables import Rate

KILLS = int(os.environ.get("OCTSIM_KILLS", "4"))
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


READER = """
import contextlib, sqlite3, sys
with contextlib.closing(sqlite3.connect(sys.argv[1])) as connection:
    while True:
        connection.execute("SELECT sum(size) FROM points").fetchall()
"""


def test_the_log_stays_short_while_others_always_read(file: Path) -> None:
    body, sizes = bytes(20_000), []
    with PointCache(file, 1.0) as cache:
        cache.put([(b"0", body)])
        readers = [subprocess.Popen([sys.executable, "-c", READER, str(file)]) for _ in range(3)]
        time.sleep(0.5)
        for turn in range(60):
            cache.put((b"%d" % (50 * turn + i), body) for i in range(50))
            sizes.append(log(file).stat().st_size)
        for reader in readers:
            assert reader.poll() is None
            reader.kill()
            reader.wait()
    assert file.stat().st_size > 60e6
    assert max(sizes) < 25e6


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
    entries = 0
    while entries <= 50:  # however slow the machine is
        time.sleep(0.05)
        with PointCache(file, GIGABYTES) as cache:
            entries = right(cache, ENTRIES)
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
    fork = multiprocessing.get_context("fork")
    used, locked = fork.Event(), fork.Event()
    with PointCache(filled, GB) as cache:
        assert right(cache, SOME) == 40

        def use() -> None:
            assert right(cache, SOME) == 40
            cache.put(ENTRIES[40:80])
            used.set()
            locked.wait(30)
            os._exit(right(cache, ENTRIES) - 120)

        child = fork.Process(target=use)
        child.start()
        cache.put(ENTRIES[80:120])
        used.wait(30)
    # with this side's locks gone, the child has some of its own
    with filled.open("r+b") as stream, pytest.raises(BlockingIOError):
        fcntl.lockf(stream, fcntl.LOCK_EX | fcntl.LOCK_NB, 512, 0x40000000)
    locked.set()
    child.join()
    assert child.exitcode == 0
    assert in_order(filled)


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
