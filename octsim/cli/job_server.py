"""Jobs as forks of one process that has the libraries: importing them takes longer than most jobs.

    python -m octsim.cli.job_server DESCRIPTOR PARENT

Each connection to the socket brings a task, and the standard streams of who asks; a fork does it
and sends back its exit status. The server ends with the process that has started it. Where there is
none, as on the nodes of a cluster, a job is done where it is asked for.
"""

import contextlib
import json
import os
import signal
import socket
import subprocess
import sys
import tempfile
import threading
import time
import traceback
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from octsim.base.say import say
from octsim.base.surroundings import settled
from octsim.cli.stopped import DEAF

PYTHON = sys.executable
SOCKET = "OCTSIM_JOB_SERVER"
"""Environment variable with the path of the socket."""
_LOOK = 1.0  # s, between looks at whether the parent is still there
_STREAMS = (1, 2)
_HEAD = 16  # bytes, with the length of the task that follows
_BEGUN = b"!"
_LOADED = (
    "matplotlib.backends.backend_agg", "scipy.optimize", "scipy.signal", "octsim.archive.pack",
    "octsim.figures.draw", "octsim.instrument.point_store", "octsim.stages.job",
)  # fmt: skip


def start() -> "tempfile.TemporaryDirectory[str] | None":
    """Start a server, and return the folder of its socket, which the caller has to keep.

    None where there can be none, as the folder of temporary files has too long a name for a socket.
    """
    from octsim.base.code_folder import VARIABLE, places, writable

    folder = tempfile.TemporaryDirectory(prefix="octsim-", ignore_cleanup_errors=True)
    path = f"{folder.name}/jobs"
    with socket.socket(socket.AF_UNIX) as listener:
        try:
            listener.bind(path)
        except OSError:
            return None
        if writable(places()) is None:  # then the jobs of this run share what they compile
            os.environ[VARIABLE] = f"{folder.name}/compiled"
        listener.listen(64)  # from now on who asks is heard
        command = [*DEAF, PYTHON, "-m", "octsim.cli.job_server"]
        subprocess.Popen(
            [*command, str(listener.fileno()), str(os.getpid())],
            pass_fds=[listener.fileno()], stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL,
            # there is no matplotlibrc in the folder of the socket, as there may be in the user's
            stderr=subprocess.DEVNULL, cwd=folder.name, env=settled(os.environ),
        )  # fmt: skip
    os.environ[SOCKET] = path
    return folder


def ask(task: Mapping[str, Any]) -> int | None:
    """Have a task done by the server; return its exit status, or None if no server has begun it."""
    status = b""
    with socket.socket(socket.AF_UNIX) as connection:
        try:
            connection.connect(os.environ.get(SOCKET, ""))
            whole = {**task, "folder_of_the_process": str(Path.cwd())}
            text = json.dumps(whole, default=str).encode()  # YAML reads a day as one
            socket.send_fds(connection, [f"{len(text):{_HEAD}}".encode()], _STREAMS)
            connection.sendall(text)
            begun = connection.recv(1)
        except OSError:
            begun = b""
        if not begun:
            return None
        with contextlib.suppress(OSError):
            status = connection.recv(1)
    time.sleep(
        0 if status else _LOOK
    )  # for who ends this process too, as a run that is stopped does
    if not status and is_alive(int(os.environ["OCTSIM_RUN"])):
        say("the job was killed; is there memory enough for it?")
    return status[0] if status else 1


def is_alive(process: int) -> bool:
    """Return whether there is a process of a number."""
    try:
        os.kill(process, 0)
    except ProcessLookupError:
        return False
    return True


def serve(listener: socket.socket, parent: int) -> None:
    """Fork a process for each task, until the parent is gone."""
    signal.signal(signal.SIGCHLD, signal.SIG_IGN)  # nobody waits for the forks
    listener.settimeout(_LOOK)
    _load()
    while os.getppid() == parent:
        with contextlib.suppress(TimeoutError):
            connection, _ = listener.accept()
            with connection, contextlib.suppress(OSError):  # no more processes: not begun
                if os.fork() == 0:
                    listener.close()
                    _do(connection)


def _load() -> None:
    """Import what jobs need; what can't be imported is said by the job that needs it."""
    from octsim.base.named import named
    from octsim.datasets.catalog import CATALOG

    of_stages = (row.module for row in CATALOG.values() if not row.beside)
    for module in (*_LOADED, *of_stages):
        with contextlib.suppress(Exception):
            __import__(module)
    named("octsim.base.provenance:environment")()


def _do(connection: socket.socket) -> None:
    """Do a task in a fork, and end it."""
    signal.signal(signal.SIGCHLD, signal.SIG_DFL)
    status = 1
    try:
        head, streams, _, _ = socket.recv_fds(connection, _HEAD, len(_STREAMS))
        for given, own in zip(streams, _STREAMS, strict=True):
            os.dup2(given, own)
            os.close(given)
        with connection.makefile("rb") as stream:
            task = json.loads(stream.read(int(head)))
        connection.sendall(_BEGUN)
        os.chdir(task.pop("folder_of_the_process"))
        threading.Thread(target=_end_with, args=(connection,), daemon=True).start()
        from octsim.cli.job import Task, do

        status = do(Task(**task))
    except BaseException:
        traceback.print_exc()
    finally:
        for said in (sys.stdout, sys.stderr):
            with contextlib.suppress(OSError):
                said.flush()
        with contextlib.suppress(OSError):
            connection.sendall(bytes([status]))
        os._exit(status)


def _end_with(connection: socket.socket) -> None:
    """End this process when who asked is gone."""
    with contextlib.suppress(OSError):
        connection.recv(1)
    os._exit(1)


if __name__ == "__main__":
    with socket.socket(fileno=int(sys.argv[1])) as given:
        serve(given, int(sys.argv[2]))
