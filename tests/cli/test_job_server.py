"""Jobs as forks of one process: what they do and say is theirs, and none outlives who asked."""

import os
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

ASK = """
import sys
from octsim.cli.job_server import ask
print("asked", flush=True)
status = ask({task})
print("status", status, flush=True)
"""
SERVER = """
import sys, time
from octsim.cli import job_server
folder = job_server.start()
print(folder.name + "/jobs", flush=True)
time.sleep(600)
"""


def task(folder: Path) -> dict[str, object]:
    return {
        "name": "focus_law",
        "folder": str(folder / "results" / "tiny"),
        "config": {"run": "tiny"},
        "input": {"focus_sweep": str(folder / "focus_sweep.nc")},
        "output": {"only": "law.nc"},
        "shares": [],
        "log": str(folder / "logs" / "job.log"),
        "threads": 1,
        "share": [1, 1],
        "figures": False,
    }


def asked(what: dict[str, object], **environment: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-c", ASK.format(task=what)],
        env=os.environ | {"OCTSIM_RUN": str(os.getpid())} | environment,
        capture_output=True, text=True, check=False,
    )  # fmt: skip


@pytest.fixture
def server() -> Iterator["subprocess.Popen[str]"]:
    command = [sys.executable, "-c", SERVER]
    environment = os.environ | {"OCTSIM_RUN": str(os.getpid())}
    started = subprocess.Popen(command, env=environment, stdout=subprocess.PIPE, text=True)
    yield started
    started.kill()
    started.communicate()


def test_a_job_is_done_by_the_server_with_the_streams_of_who_asks(
    server: "subprocess.Popen[str]", tmp_path: Path
) -> None:
    assert server.stdout is not None
    socket = server.stdout.readline().strip()
    done = asked(task(tmp_path), OCTSIM_JOB_SERVER=socket)
    # there is no dataset to fit, and the one who asks is told so
    assert "status 1" in done.stdout
    assert "focus_sweep.nc: not there; run the stage focus_sweep first" in done.stderr
    assert "Traceback" not in done.stderr


def test_without_a_server_nobody_does_it(tmp_path: Path) -> None:
    done = asked(task(tmp_path), OCTSIM_JOB_SERVER=str(tmp_path / "none"))
    assert "status None" in done.stdout
    assert "status None" in asked(task(tmp_path)).stdout


def test_the_server_ends_with_who_started_it(
    server: "subprocess.Popen[str]", tmp_path: Path
) -> None:
    assert server.stdout is not None
    socket = server.stdout.readline().strip()
    asked(task(tmp_path), OCTSIM_JOB_SERVER=socket)  # it is at work
    children = Path(f"/proc/{server.pid}/task/{server.pid}/children")
    if not children.exists():
        pytest.skip("needs /proc")
    (process,) = map(int, children.read_text().split())
    server.kill()
    server.wait()
    while _is_there(process):  # it looks once a second
        time.sleep(0.05)


def _is_there(process: int) -> bool:
    try:
        text = Path(f"/proc/{process}/stat").read_text()
    except OSError:
        return False
    return text.rpartition(")")[2].split()[0] != "Z"


def test_jobs_of_a_run_share_compiled_code_where_none_can_be_kept(tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    code = (
        "import os\nfrom octsim.cli import job_server\n"
        "folder = job_server.start()\n"
        "print(os.environ['NUMBA_CACHE_DIR'].startswith(folder.name))\n"
    )
    for place, within in ((tmp_path / "file" / "kept", "True"), (tmp_path / "kept", "False")):
        environment = os.environ | {"NUMBA_CACHE_DIR": str(place)}
        said = subprocess.check_output([sys.executable, "-c", code], env=environment, text=True)
        assert said.strip() == within
