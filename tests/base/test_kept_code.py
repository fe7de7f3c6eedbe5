"""Compiled code lies where it can be written, below all that it follows from, and is made once."""

import importlib
import os
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import pytest

from octsim.base import code_folder
from octsim.base.code_folder import can_write, folder_for, nowhere, places, remove_unused

KERNEL = """
from numba.extending import register_jitable
from octsim.base.compiled import compiled

@register_jitable
def half(x):
    return x / 2

@compiled()
def double(x):
    return half(4 * x)
"""
WORK = "import kernel; print(kernel.double(21.0), sum(kernel.double.stats.cache_hits.values()))"


@pytest.fixture(autouse=True)
def anew() -> None:
    can_write.cache_clear()


def run(folder: Path, kept: Path, code: str = WORK, **environment: str) -> "subprocess.Popen[str]":
    (folder / "kernel.py").write_text(KERNEL, encoding="utf-8")
    # Python's own code of a file goes by its time and size, too
    plain = {"PYTHONDONTWRITEBYTECODE": "1", "PYTHONPATH": str(folder)}
    own = {"NUMBA_CACHE_DIR": str(kept), **plain, **environment}
    return subprocess.Popen(
        [sys.executable, "-c", code], env=os.environ | own, text=True,
        stdout=subprocess.PIPE, stderr=subprocess.PIPE,
    )  # fmt: skip


def said(process: "subprocess.Popen[str]") -> tuple[str, str]:
    out, err = process.communicate()
    assert process.returncode == 0, err
    return out.strip(), err


def test_a_named_folder_is_the_only_place(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))
    assert places() == (tmp_path,)


def test_else_it_is_the_packages_own_or_the_users(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.delenv("NUMBA_CACHE_DIR", raising=False)
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    own, users = places()
    assert own.name == "__pycache__"
    assert users == tmp_path / "octsim"
    monkeypatch.setattr(sys, "pycache_prefix", str(tmp_path / "prefix"))
    assert tmp_path / "prefix" in places()[0].parents


def test_the_first_place_that_can_be_written_is_taken(tmp_path: Path) -> None:
    file = tmp_path / "file"
    file.touch()  # a file can't be a folder, for root either
    assert folder_for("abc", (file, tmp_path / "new")) == tmp_path / "new" / "numba-abc"
    assert folder_for("abc", (file, file / "below")) is None
    assert "NUMBA_CACHE_DIR" in nowhere((file,))


def test_a_place_that_can_only_be_read_serves_what_it_holds(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    image, users = tmp_path / "image", tmp_path / "users"
    (image / "numba-abc").mkdir(parents=True)
    (image / "numba-abc" / "double.nbi").touch()
    cannot: Callable[[Path], bool] = image.__ne__
    monkeypatch.setattr(code_folder, "can_write", cannot)
    assert folder_for("abc", (image, users)) == image / "numba-abc"
    assert folder_for("other", (image, users)) == users / "numba-other"


def test_only_code_that_nobody_uses_is_removed(tmp_path: Path) -> None:
    old, new, other = tmp_path / "numba-old", tmp_path / "numba-new", tmp_path / "other"
    for folder in (old, new, other):
        folder.mkdir()
        (folder / "code").touch()
    for folder in (old, other):
        os.utime(folder, (0, time.time() - 40 * 24 * 3600))
    remove_unused(tmp_path)
    assert not old.exists()
    assert new.exists()
    assert other.exists()


def test_code_is_read_again_and_only_said_when_it_is_made(tmp_path: Path) -> None:
    kept = tmp_path / "kept"
    first, again = (said(run(tmp_path, kept)) for _ in range(2))
    assert first[0] == "42.0 0"
    assert "octsim: compiling" in first[1]
    assert again == ("42.0 1", "")


def test_two_processes_compile_once(tmp_path: Path) -> None:
    kept = tmp_path / "kept"
    slow = (
        "import time, numba.core.event as e\n"
        "class Slow(e.Listener):\n"
        "    def on_start(self, event): time.sleep(3)\n"
        "    def on_end(self, event): pass\n"
        "e.register('numba:compile', Slow())\n"
    )
    both = [run(tmp_path, kept, slow + WORK) for _ in range(2)]
    found = [said(one) for one in both]
    assert sorted(out for out, _ in found) == ["42.0 0", "42.0 1"]
    assert len(list(kept.rglob("*.nbc"))) == 1
    assert sum("octsim: compiling" in err for _, err in found) == 1


def test_threads_that_wait_for_a_compilation_do_not_disturb_it(tmp_path: Path) -> None:
    threads = (
        "import kernel\n"
        "from concurrent.futures import ThreadPoolExecutor\n"
        "print(set(ThreadPoolExecutor(8).map(kernel.double, 64 * [21.0])))\n"
    )
    assert said(run(tmp_path, tmp_path / "kept", threads))[0] == "{42.0}"


def test_a_killed_process_holds_up_nobody(tmp_path: Path) -> None:
    kept = tmp_path / "kept"
    stop = (
        "import os, signal, numba.core.event as e\n"
        "class Stop(e.Listener):\n"
        "    def on_start(self, event): os.kill(os.getpid(), signal.SIGKILL)\n"
        "    def on_end(self, event): pass\n"
        "e.register('numba:compile', Stop())\n"
    )
    killed = run(tmp_path, kept, stop + WORK)
    killed.communicate()
    assert killed.returncode < 0
    assert said(run(tmp_path, kept))[0] == "42.0 0"


@pytest.mark.parametrize("kind", ["nbi", "nbc"])
def test_damaged_files_are_compiled_anew(tmp_path: Path, kind: str) -> None:
    kept = tmp_path / "kept"
    said(run(tmp_path, kept))
    (file,) = kept.rglob(f"*.{kind}")
    file.write_bytes(file.read_bytes()[: file.stat().st_size // 2])
    assert said(run(tmp_path, kept))[0] == "42.0 0"
    assert said(run(tmp_path, kept))[0] == "42.0 1"


def test_without_a_place_it_is_compiled_and_said(tmp_path: Path) -> None:
    file = tmp_path / "file"
    file.touch()
    for _ in range(2):
        out, err = said(run(tmp_path, file / "kept"))
        assert out == "42.0 0"
        assert err.count("NUMBA_CACHE_DIR") == 1


def test_a_user_without_a_home_gets_no_folder_in_the_present_one(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.delenv("NUMBA_CACHE_DIR", raising=False)
    monkeypatch.setattr(code_folder, "user_cache_path", lambda _: Path("~/.cache/octsim"))
    assert len(places()) == 1


def test_a_full_disk_is_said_and_put_up_with(tmp_path: Path) -> None:
    full = (
        "from numba.core.caching import IndexDataCacheFile as files\n"
        "def fail(*a): raise OSError(28, 'No space left on device')\n"
        "files._save_data = fail\n"
    )
    out, err = said(run(tmp_path, tmp_path / "kept", full + WORK))
    assert out == "42.0 0"
    assert "can't be kept" in err
    assert "No space left" in err
    assert said(run(tmp_path, tmp_path / "kept"))[0] == "42.0 0"


def test_a_failed_compilation_holds_up_nobody(tmp_path: Path) -> None:
    fails = "import kernel\ntry: kernel.double('a', 2)\nexcept Exception: pass\n"
    assert said(run(tmp_path, tmp_path / "kept", fails + WORK))[0] == "42.0 0"


def test_a_file_system_without_locks_does(tmp_path: Path) -> None:
    none = (
        "import octsim.base.kept_code as k\n"
        "def acquire(*a, **k): raise NotImplementedError\n"
        "k.FileLock.acquire = acquire\n"
    )
    kept = tmp_path / "kept"
    assert said(run(tmp_path, kept, none + WORK))[0] == "42.0 0"
    assert said(run(tmp_path, kept, none + WORK))[0] == "42.0 1"


def test_the_compiler_can_be_left_out(tmp_path: Path) -> None:
    code = "import kernel; print(kernel.double(21.0))"
    assert said(run(tmp_path, tmp_path / "kept", code, NUMBA_DISABLE_JIT="1")) == ("42.0", "")


def test_an_update_never_runs_the_old_code(tmp_path: Path) -> None:
    """Also where a file keeps its time and size, which is all that numba looks at."""
    kept = tmp_path / "kept"
    said(run(tmp_path, kept))
    kernel = tmp_path / "kernel.py"
    before = kernel.stat()
    code = (
        "import pathlib, os\n"
        f"p = pathlib.Path({str(kernel)!r})\n"
        "p.write_text(p.read_text().replace('4 * x', '6 * x'))\n"
        f"os.utime(p, ns=({before.st_atime_ns}, {before.st_mtime_ns}))\n"
    )
    assert said(run(tmp_path, kept, code + WORK))[0] == "63.0 0"


def test_what_compiles_as_a_whole_fits_this_numba() -> None:
    assert importlib.import_module("octsim.base.compile_whole").FITS


SHARED = """
from numba.core.event import Listener, register
from numba.extending import register_jitable
from octsim.base.compiled import compiled

@register_jitable
def half(x):
    return max(x, 0.0) / 2

@register_jitable(forceinline=True)
def inlined(x):
    return half(x) + 1

@register_jitable
def called(x):
    return half(x) + 2

@compiled()
def double(x):
    return inlined(x) + called(x) + half(4 * x)

@compiled(fastmath=True)
def again(x):
    return inlined(x) + called(x)

names = []

class Names(Listener):
    def on_start(self, event):
        names.append(event.data["dispatcher"].py_func.__name__)
    def on_end(self, event):
        pass

register("numba:compile", Names())
print(double(2.0), names.count("half"), again(2.0), names.count("half"))
"""


def test_a_part_is_compiled_once_for_all_callers_of_the_same_arithmetic(tmp_path: Path) -> None:
    (tmp_path / "shared.py").write_text(SHARED, encoding="utf-8")
    assert said(run(tmp_path, tmp_path / "kept", "import shared"))[0] == "9.0 1 5.0 2"


MADE = """
import numpy as np
from octsim.base.compiled import compiled

def make(part, count):
    @compiled()
    def filled(x):
        one = np.full(count, part(x))
        return (one, one.astype(np.int64)) if count > 2 else (one, one)
    return filled
"""


def test_functions_that_processes_made_apart_of_one_code_work_together(tmp_path: Path) -> None:
    kept, head = tmp_path / "kept", "from made import make; import parts; "
    (tmp_path / "made.py").write_text(MADE, encoding="utf-8")
    parts, makes = "from numba.extending import register_jitable\n", []
    for name, count in (("twice", 2), ("thrice", 3)):
        parts += f"@register_jitable\ndef {name}(x):\n    return {count} * x\n"
        makes.append(f"print(*make(parts.{name}, {count})(2.0))")
    (tmp_path / "parts.py").write_text(parts, encoding="utf-8")
    alone = [said(run(tmp_path, kept, head + code))[0] for code in makes]
    assert alone == ["[4. 4.] [4. 4.]", "[6. 6. 6.] [6 6 6]"]
    for both in (makes, makes[::-1]):
        found = said(run(tmp_path, kept, head + "; ".join(both)))[0]
        assert sorted(found.split("\n")) == alone
