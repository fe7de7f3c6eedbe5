"""A store gives back what was put or nothing, whoever shares it, whatever happens to its files."""

import contextlib
import logging
import multiprocessing
import os
import random
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
import store_worker
from store_worker import ENTRIES, GIGABYTES, POINTS, SOME, put, right

from octsim.base.errors import CacheError
from octsim.config.models import Cache
from octsim.instrument.point_store import PointStore, Rate, clear, describe, open_store

KILLS = int(os.environ.get("OCTSIM_KILLS", "4"))
GB = 0.1
CLEAR = [sys.executable, "-m", "octsim", "cache", "clear", "--file"]


@pytest.fixture
def file(tmp_path: Path) -> Path:
    return tmp_path / "cache" / "points"


@pytest.fixture
def filled(file: Path) -> Path:
    store = PointStore(file, GB)
    put(store, SOME)
    store.record("paths", Rate(40, 2.0, 40_000))
    return file


def files_in(folder: Path) -> dict[Path, bytes]:
    return {path: path.read_bytes() for path in folder.rglob("*") if path.is_file()}


def file_of(folder: Path, entry: tuple[bytes, bytes]) -> Path:
    (file,) = (path for path in folder.glob("??/*") if path.read_bytes().endswith(entry[1]))
    return file


def size_of(folder: Path) -> int:
    held = describe(folder)
    assert held is not None
    return held.bytes


def warned(caplog: pytest.LogCaptureFixture) -> list[str]:
    return [record.message.removeprefix("octsim: warning: ") for record in caplog.records]


def test_what_was_put_is_there_again_and_nothing_else_is(file: Path) -> None:
    store = PointStore(file, GB)
    assert right(store, SOME) == 0
    put(store, SOME)
    assert right(store, SOME) == len(SOME)
    store = PointStore(file, GB)
    assert right(store, ENTRIES) == len(SOME)
    store.put(b"empty", b"")
    assert store.get(b"empty") == b""


def test_nothing_is_made_until_something_is_kept(file: Path) -> None:
    store = PointStore(file, GB)
    right(store, SOME)
    store.rates("paths")
    assert describe(file) is None
    assert clear(file) is None
    assert not file.parent.exists()


def test_the_last_put_of_a_key_counts(file: Path) -> None:
    store = PointStore(file, GB)
    for body in (b"one" * 3000, b"two" * 4000, b"three"):
        store.put(b"key", body)
        assert store.get(b"key") == body
    held = describe(file)
    assert held is not None
    assert (held.points, held.bytes) == (1, 4096)


def test_no_gigabytes_are_no_store() -> None:
    assert open_store(Cache(gigabytes=0)) is None


def test_the_least_recently_used_go_first(file: Path) -> None:
    store = PointStore(file, GIGABYTES)
    for number, entry in enumerate(ENTRIES):
        store.put(*entry)
        if number < 160:  # the clock of a disk has ticks of some ms
            os.utime(file_of(file, entry), (number, number))
        if number >= 100:
            assert right(PointStore(file, GIGABYTES), ENTRIES[:20]) == 20
    held = [store.get(key) is not None for key, _ in ENTRIES]
    assert not any(held[20:160])
    assert 60 < sum(held[160:]) < 240
    assert held[-1]


@pytest.mark.parametrize("share", [12e6, 1e5])
def test_the_size_stays_about_what_is_allowed(
    share: float, file: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("octsim.instrument.point_store._LEAST_SHARE", share)
    allowed, store = GIGABYTES * 1e9, PointStore(file, GIGABYTES)
    sizes = []
    for number in range(3 * POINTS):
        store.put(b"%d" % number, ENTRIES[number % POINTS][1])
        if number % 5 == 0:
            sizes.append(size_of(file))
    assert max(sizes) < 1.15 * allowed
    assert min(sizes[80:]) > 0.6 * allowed
    assert sum(sizes[80:]) / len(sizes[80:]) < 0.95 * allowed
    smaller = PointStore(file, GIGABYTES / 3)
    put(smaller, ENTRIES[:200])
    assert size_of(file) < 1.15 * allowed / 3
    assert right(smaller, ENTRIES[190:200]) == 10


def test_points_of_which_a_store_holds_few_are_kept(file: Path) -> None:
    store, body = PointStore(file, 0.03), bytes(3_000_000)
    for number in range(20):
        store.put(b"%d" % number, body)
        assert store.get(b"%d" % number) == body
        assert size_of(file) < 31e6
    held = [store.get(b"%d" % number) is not None for number in range(20)]
    assert sum(held) > 5
    store.put(b"larger than all", bytes(40_000_000))
    assert [store.get(b"%d" % number) is not None for number in range(20)] == held


def test_threads_share_a_store(file: Path) -> None:
    wrong: list[bytes] = []
    store = PointStore(file, GIGABYTES)

    def use(seed: int) -> None:
        draw = random.Random(seed)
        for _ in range(30):
            chosen = draw.sample(ENTRIES, 10)
            wrong.extend(k for k, body in chosen if store.get(k) not in (None, body))
            put(store, chosen)
            store.record("paths", Rate(1, 0.5, 10))

    threads = [threading.Thread(target=use, args=(seed,)) for seed in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert wrong == []
    assert right(store, ENTRIES) > 50
    assert store.rates("paths") == Rate(120, 60.0, 1200)


def start(file: Path, seed: int, turns: int = 1_000_000) -> subprocess.Popen[bytes]:
    arguments = [file, seed, file.with_name("notes"), turns]
    return subprocess.Popen([sys.executable, store_worker.__file__, *map(str, arguments)])


def wait_for(points: int, file: Path) -> None:
    end = time.monotonic() + 60
    while not ((held := describe(file)) and held.points > points):
        assert time.monotonic() < end
        time.sleep(0.1)


def test_processes_killed_at_any_moment_leave_no_wrong_value(file: Path) -> None:
    draw = random.Random(5)
    file.parent.mkdir()
    running = [start(file, seed) for seed in range(3)]
    wait_for(50, file)
    for kill in range(KILLS):
        time.sleep(draw.uniform(0.0, 1.2))
        which = draw.randrange(3)
        running[which].send_signal(signal.SIGKILL)
        running[which].wait()
        running[which] = start(file, 3 + kill)
    clear(file)
    wait_for(50, file)
    for process in running:
        process.kill()
        process.wait()
    store = PointStore(file, GIGABYTES)
    assert right(store, ENTRIES) > 20
    assert size_of(file) < 1.3 * GIGABYTES * 1e9
    put(store, ENTRIES[:50])
    assert right(store, ENTRIES[:50]) == 50
    assert file.with_name("notes").read_text() == ""


def test_processes_that_make_one_store_at_once_agree(file: Path) -> None:
    file.parent.mkdir()
    running = [start(file, seed, turns=2) for seed in range(6)]
    assert [process.wait() for process in running] == 6 * [0]
    assert file.with_name("notes").read_text() == ""
    assert right(PointStore(file, GIGABYTES), ENTRIES) > 50


def test_a_fork_goes_on_with_the_store(filled: Path) -> None:
    store = PointStore(filled, GB)
    assert right(store, SOME) == 40

    def use() -> None:
        put(store, ENTRIES[40:80])
        os._exit(right(store, ENTRIES) - 80)

    child = multiprocessing.get_context("fork").Process(target=use)
    child.start()
    child.join()
    assert child.exitcode == 0
    put(store, ENTRIES[80:120])
    assert right(store, ENTRIES) == 120


def test_what_a_killed_process_left_of_a_point_is_no_point_and_goes(file: Path) -> None:
    store = PointStore(file, GIGABYTES)
    put(store, SOME)
    whole = file_of(file, SOME[7])
    left = whole.rename(f"{whole}.{8 * 'a1'}~")
    os.utime(left, (0, 0))
    assert right(store, SOME) == 39
    held = describe(file)
    assert held is not None
    assert (held.points, held.bytes) == (39, 40 * 8192)
    put(store, ENTRIES)
    assert not left.exists()
    whole.with_name(left.name).touch()
    clear(file)
    assert list(file.glob("??/*")) == []


def test_clearing_empties_what_another_process_uses(filled: Path) -> None:
    store = PointStore(filled, GB)
    for _ in range(2):
        assert right(store, SOME) == 40
        done = subprocess.run([*CLEAR, str(filled)], check=True, capture_output=True, text=True)
        assert done.stdout == f"{filled}: 0.3 MB freed\n"
        assert right(store, SOME) == 0
        assert store.rates("paths") is None
        put(store, SOME)


@pytest.mark.parametrize("removed", ["", "octsim-points.json"])
def test_a_folder_that_is_removed_meanwhile_is_made_again(removed: str, filled: Path) -> None:
    store = PointStore(filled, GB)
    put(store, SOME)
    if removed:
        (filled / removed).unlink()
    else:
        shutil.rmtree(filled)
        assert right(store, SOME) == 0
    put(store, SOME)
    assert right(PointStore(filled, GB), SOME) == 40


def damaged(file: Path, change: Callable[[bytes], bytes]) -> None:
    file.write_bytes(change(file.read_bytes()))


def test_a_change_of_any_byte_is_a_miss_and_the_point_is_kept_anew(
    file: Path, caplog: pytest.LogCaptureFixture
) -> None:
    store, draw, body = PointStore(file, GB), random.Random(3), bytes(range(200))
    store.put(b"key", body)
    store.put(b"other", body)
    (place,) = (path for path in file.glob("??/*") if store.get(b"key") and _holds(path, store))
    content = place.read_bytes()
    for at in range(len(content)):
        changed = bytearray(content)
        changed[at] ^= 1 << draw.randrange(8)
        place.write_bytes(changed)
        assert store.get(b"key") is None
        place.write_bytes(content[:at])
        assert store.get(b"key") is None
    for other in (content + b"\0", 2 * content, draw.randbytes(len(content)), bytes(len(content))):
        place.write_bytes(other)
        assert store.get(b"key") is None
    assert store.get(b"other") == body
    store.put(b"key", body)
    assert store.get(b"key") == body
    assert warned(caplog) == [f"{file}: a damaged point is left out, and traced anew"]


def _holds(path: Path, store: PointStore) -> bool:
    """Return whether a file is that of the key "key"."""
    away = path.rename(path.with_name("away"))
    missing = store.get(b"key") is None
    away.rename(path)
    return missing


def test_a_point_s_file_in_another_s_place_is_a_miss(filled: Path) -> None:
    shutil.copy(file_of(filled, SOME[1]), file_of(filled, SOME[7]))
    store = PointStore(filled, GB)
    assert store.get(SOME[7][0]) is None
    assert right(store, SOME) == 39


def test_what_is_in_a_point_s_way_stays_and_stops_no_run(
    filled: Path, caplog: pytest.LogCaptureFixture
) -> None:
    way, folder = file_of(filled, SOME[7]), file_of(filled, SOME[8]).parent
    way.unlink()
    way.mkdir()
    (way / "notes").write_text("mine")
    shutil.rmtree(folder)
    folder.write_text("mine too")
    store = PointStore(filled, GB)
    for _ in range(2):
        right(store, SOME)
        put(store, SOME)
    assert (way / "notes").read_text() == "mine"
    assert folder.read_text() == "mine too"
    assert [text.partition(" (")[0] for text in warned(caplog)] == [
        f"{filled}: can't be read", f"{filled}: can't be written"
    ]  # fmt: skip
    describe(filled)
    clear(filled)
    assert folder.read_text() == "mine too"


def test_files_of_others_in_the_folder_are_neither_evicted_nor_cleared(file: Path) -> None:
    store = PointStore(file, GIGABYTES)
    put(store, SOME)
    folder = file_of(file, SOME[0]).parent
    mine = [file / "notes", file / "data" / ("0" * 30), folder / "notes", folder / ("0" * 38)]
    for path in mine:
        path.parent.mkdir(exist_ok=True)
        path.write_text("mine")
        os.utime(path, (0, 0))
    (folder / ("0" * 30)).symlink_to(mine[0])
    store = PointStore(file, GIGABYTES)
    put(store, ENTRIES)
    clear(file)
    assert [path.read_text() for path in mine] == 4 * ["mine"]
    assert (folder / ("0" * 30)).is_symlink()


@pytest.mark.parametrize("what", ["text", "database", "folder", "later"])
def test_what_is_no_store_of_this_octsim_is_refused_and_stays(what: str, filled: Path) -> None:
    if what == "later":
        damaged(filled / "octsim-points.json", lambda text: text.replace(b"2", b"3", 1))
    else:
        shutil.rmtree(filled)
    if what == "folder":
        (filled / "ab").mkdir(parents=True)
        (filled / "notes").write_text("mine")
    elif what == "text":
        filled.write_text(50 * "my notes\n")
    elif what == "database":
        filled.write_bytes(b"SQLite format 3\0".ljust(8192, b"\1"))
    before = files_in(filled.parent)
    says = "later octsim" if what == "later" else "is not a point cache"
    for use in (lambda: PointStore(filled, GB), lambda: describe(filled), lambda: clear(filled)):
        with pytest.raises(CacheError, match=rf"points: .*{says}.*; move it away") as told:
            use()
        assert "\n" not in str(told.value)
    assert files_in(filled.parent) == before


@pytest.mark.parametrize(
    "content", [b"", b"2", b"[]", b'{"version": "x", "allowed": 1e9}', b"\xff"]
)
def test_a_damaged_description_is_written_anew(content: bytes, filled: Path) -> None:
    good = (filled / "octsim-points.json").read_bytes()
    (filled / "octsim-points.json").write_bytes(content)
    held = describe(filled)
    assert held is not None
    assert (held.points, held.allowed) == (40, 0)
    store = PointStore(filled, GB)
    assert right(store, SOME) == 40
    put(store, SOME)
    assert (filled / "octsim-points.json").read_bytes() == good


@contextlib.contextmanager
def unprivileged(folder: Path, mode: int = 0o555) -> Iterator[None]:
    """Take rights on all folders away; from root too, who may do anything."""
    places = [folder, *(path for path in folder.rglob("*") if path.is_dir())]
    for place in reversed(places):
        place.chmod(mode)
    root = os.geteuid() == 0
    if root:
        os.seteuid(65534)
    try:
        yield
    finally:
        if root:
            os.seteuid(0)
        for place in places:
            place.chmod(0o755)


@pytest.fixture
def public() -> Iterator[Path]:
    """Make a folder that others may enter."""
    with tempfile.TemporaryDirectory() as name:
        Path(name).chmod(0o755)
        yield Path(name)


def test_what_cannot_be_written_is_read(public: Path, caplog: pytest.LogCaptureFixture) -> None:
    file = public / "points"
    put(PointStore(file, GB), SOME)
    with unprivileged(file):
        store = PointStore(file, GB)
        for _ in range(2):
            assert right(store, SOME) == 40
            put(store, ENTRIES)
            store.record("paths", Rate(1, 1.0, 1))
        assert right(store, ENTRIES) == 40
        with pytest.raises(CacheError, match=r"points: can't be cleared \("):
            clear(file)
    assert warned(caplog) == [
        f"{file}: can't be written (Permission denied); new points are not kept"
    ]


def test_what_cannot_be_read_stops_no_run(public: Path, caplog: pytest.LogCaptureFixture) -> None:
    file = public / "points"
    put(PointStore(file, GB), SOME)
    with unprivileged(file, 0):
        store = PointStore(file, GB)
        for _ in range(2):
            assert right(store, SOME) == 0
            put(store, SOME)
            assert store.rates("paths") is None
        for use in (describe, clear):
            with pytest.raises(CacheError, match=r"points: can't be .* \(Permission denied\)"):
                use(file)
    assert warned(caplog) == [
        f"{file}: can't be read (Permission denied); what is missing is traced",
        f"{file}: can't be written (Permission denied); new points are not kept",
    ]


@pytest.mark.parametrize("way", ["no right", "a file"])
def test_where_no_folder_can_be_made_a_run_goes_on(
    way: str, public: Path, caplog: pytest.LogCaptureFixture
) -> None:
    file = public / "cache" / "points"
    if way == "a file":
        file.parent.write_text("mine")
    with unprivileged(public):
        store = PointStore(file, GB)
        put(store, SOME)
        assert right(store, SOME) == 0
    reason = "Permission denied" if way == "no right" else "Not a directory"
    assert warned(caplog)[0] == f"{file}: can't be written ({reason}); new points are not kept"
    assert files_in(public) == ({file.parent: b"mine"} if way == "a file" else {})


@contextlib.contextmanager
def longest_file(size: int) -> Iterator[None]:
    """Have every write beyond a size fail, as on a full disk."""
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (size, hard))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))


@pytest.mark.parametrize("size", [0, 20, 5_000])
def test_a_full_disk_is_said_once_and_reads_go_on(
    size: int, filled: Path, caplog: pytest.LogCaptureFixture
) -> None:
    before = files_in(filled)
    with longest_file(size):
        store = PointStore(filled, GB)
        for _ in range(3):
            put(store, ENTRIES)
            store.record("paths", Rate(1, 1.0, 1))
            assert right(store, ENTRIES) == 40
    assert len(warned(caplog)) == 1
    assert f"{filled}: can't be written (" in caplog.text
    assert files_in(filled) == before
    store = PointStore(filled, GB)
    put(store, ENTRIES)
    assert right(store, ENTRIES) == POINTS


@pytest.mark.parametrize("size", [0, 20, 5_000])
def test_a_disk_that_is_full_from_the_start_leaves_no_half_file(
    size: int, file: Path, caplog: pytest.LogCaptureFixture
) -> None:
    with longest_file(size):
        store = PointStore(file, GB)
        put(store, SOME)
        assert right(store, SOME) == 0
    assert len(warned(caplog)) == 1
    assert "points: can't be written (" in caplog.text
    assert [path.name for path in files_in(file)] == (["octsim-points.json"] if size > 100 else [])
    store = PointStore(file, GB)
    put(store, SOME)
    assert right(store, SOME) == 40


def test_costs_add_up(filled: Path) -> None:
    store = PointStore(filled, GB)
    store.record("paths", Rate(2, 0.5, 3_000))
    assert store.rates("paths") == Rate(42, 2.5, 43_000)
    assert store.rates("vogel") is None
    for _ in range(3000):
        store.record("vogel", Rate(1, 0.25, 10))
    assert store.rates("vogel") == Rate(3000, 750.0, 30_000)
    assert store.rates("paths") == Rate(42, 2.5, 43_000)
    assert (filled / "octsim-rates.jsonl").stat().st_size < 70_000


def test_damaged_costs_are_left_out(filled: Path) -> None:
    rates, store = filled / "octsim-rates.jsonl", PointStore(filled, GB)
    for line in (
        b'["paths", 1, 1.0', b'["paths", -1, 1.0, 1]', b'["paths", 1, NaN, 1]', b"\xff\0", b"7",
        b'["paths", 1e999, 1.0, 1]', b'["paths", 1, 1.0, 1%s]' % (400 * b"0"), b'[[], 1, 1.0, 1]',
        b'["paths", 1, null, 1]',
    ):  # fmt: skip
        with rates.open("ab") as stream:
            stream.write(b"\n" + line)
        store.record("paths", Rate(1, 1.0, 1_000))
    assert store.rates("paths") == Rate(49, 11.0, 49_000)
    damaged(rates, lambda content: bytes(byte ^ 255 for byte in content))
    assert store.rates("paths") is None


@pytest.fixture(autouse=True)
def _warnings(caplog: pytest.LogCaptureFixture) -> None:
    caplog.set_level(logging.WARNING)
