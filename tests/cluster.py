"""A private Slurm on this machine, in a folder of its own: started, given, and stopped again."""

import getpass
import os
import secrets
import shutil
import socket
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path
from typing import NamedTuple

from psutil import NoSuchProcess, Process

CORES = 2  # of a node
MEMORY = 4000  # MB that jobs on a node share
SILENCE = 15  # s, until a node that does not answer is held for dead
_PATIENCE = 30.0  # s, until a daemon answers
_PROGRAMS = ("munged", "munge", "slurmctld", "slurmd", "sbatch", "squeue", "sinfo", "scontrol")
_PATH = os.pathsep.join([os.environ.get("PATH", os.defpath), "/usr/local/sbin", "/usr/sbin"])

# No accounting, and no cgroups: both would need a system that is set up for them. Memory is looked
# at each second, and a job that is over its own is killed as out of memory.
_CONFIG = """\
ClusterName=octsim
SlurmctldHost={host}(127.0.0.1)
SlurmctldPort={port}
SlurmUser={user}
SlurmdUser={user}
AuthType=auth/munge
AuthInfo=socket={folder}/munge/socket
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/%n
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/%n.pid
SlurmctldLogFile={folder}/slurmctld.log
SlurmdLogFile={folder}/%n.log
PlugStackConfig={folder}/plugstack.conf
MailProg=/bin/true
MpiDefault=none
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SwitchType=switch/none
ReturnToService=2
SelectType=select/cons_tres
SelectTypeParameters=CR_Core_Memory
SchedulerParameters=batch_sched_delay=0,sched_min_interval=100000
JobAcctGatherType=jobacct_gather/linux
JobAcctGatherFrequency=task=1
JobAcctGatherParams=OverMemoryKill
AccountingStorageType=accounting_storage/none
JobCompType=jobcomp/none
JobRequeue=0
KillWait=2
SlurmdTimeout={silence}
MinJobAge=600
SlurmdParameters=config_overrides
PartitionName=all Nodes=ALL Default=YES MaxTime=INFINITE State=UP
"""
_NODE = (
    "NodeName={name} NodeHostname={host} NodeAddr=127.0.0.1 Port={port} CPUs={cores} "
    "RealMemory={memory} State=UNKNOWN\n"
)
# What a daemon starts stays below its keeper, where its own parent has ended too, and is found.
_KEEPER = """\
import ctypes, os, sys
ctypes.CDLL(None).prctl(36, 1)  # PR_SET_CHILD_SUBREAPER
os.posix_spawn(sys.argv[1], sys.argv[1:], os.environ)
try:
    while os.wait():
        pass
except ChildProcessError:
    pass
"""


class ClusterError(Exception):
    """Slurm can't be started here; its text is one line that says why."""


class Cluster(NamedTuple):
    """A Slurm that runs."""

    environment: Mapping[str, str]
    """In which its commands find it."""
    nodes: Mapping[str, subprocess.Popen[bytes]]
    """By name, what each runs in."""

    def kill(self, node: str) -> None:
        """Let a node die: its daemon and its jobs are killed at once, and nothing tells Slurm."""
        _kill(self.nodes[node])


@contextmanager
def cluster(nodes: int = 1) -> Iterator[Cluster]:
    """Start a Slurm of so many nodes, named node1 and so on, all of them on this machine.

    Nothing outside a temporary folder is read or written, and another Slurm of the machine is left
    alone. All that was started is killed at the end, jobs that still run too.

    Raises
    ------
    ClusterError
        If a program is missing or does not start.
    """
    missing = [name for name in (*_PROGRAMS, "srun") if shutil.which(name, path=_PATH) is None]
    if missing:
        raise ClusterError(f"{missing[0]} is not installed (Debian: slurm-wlm, munge)")
    names = [f"node{number}" for number in range(1, nodes + 1)]
    with ExitStack() as stack:
        # below /tmp itself: a socket's name has 107 characters at most
        folder = Path(stack.enter_context(tempfile.TemporaryDirectory(prefix="octsim-")))
        folder = folder.resolve()
        for part in ("munge", "state", "bin", *names):
            (folder / part).mkdir(mode=0o755)
        folder.chmod(0o755)
        _authenticate(folder, stack)
        environment = _configure(folder, names)
        _start(folder, stack, environment, "slurmctld", "-D")
        running = {
            name: _start(folder, stack, environment, "slurmd", "-D", "-N", name) for name in names
        }
        idle = ["sinfo", "--noheader", "--states=idle", "--format=%D"]
        _wait_for(folder, environment, idle, str(nodes))
        yield Cluster(environment, running)


def _authenticate(folder: Path, stack: ExitStack) -> None:
    """Start munged, with a key that nobody else has."""
    munge = folder / "munge"
    (munge / "key").touch(mode=0o600)
    (munge / "key").write_bytes(secrets.token_bytes(128))
    places = {"key": "key", "socket": "socket", "pid": "pid", "log": "log", "seed": "seed"}
    named = [
        f"--{option}{'' if option == 'socket' else '-file'}={munge / name}"
        for option, name in places.items()
    ]
    _start(folder, stack, {"PATH": _PATH}, "munged", "--foreground", "--force", *named)
    command = ["munge", "--no-input", f"--socket={munge / 'socket'}"]
    _wait_for(folder, {"PATH": _PATH}, command, "MUNGE:")


def _configure(folder: Path, names: Sequence[str]) -> dict[str, str]:
    """Give the environment in which Slurm's commands find this folder's."""
    (folder / "plugstack.conf").touch()
    conf = folder / "slurm.conf"
    host = socket.gethostname().split(".")[0]
    with _free_ports(1 + len(names)) as (port, *ports):
        text = _CONFIG.format(
            host=host, port=port, user=getpass.getuser(), folder=folder, silence=SILENCE
        )
        for name, own in zip(names, ports, strict=True):
            text += _NODE.format(name=name, host=host, port=own, cores=CORES, memory=MEMORY)
        conf.write_text(text)
    # SLURM_CONF alone is not enough: snakemake's job steps call srun without any SLURM_ variable
    srun = folder / "bin" / "srun"
    real = shutil.which("srun", path=_PATH)
    srun.write_text(f'#!/bin/sh\nSLURM_CONF={conf} exec {real} "$@"\n')
    srun.chmod(0o755)
    # what a Slurm around these tests has set is not this one's
    mine = {
        name: value
        for name, value in os.environ.items()
        if not name.startswith(("SLURM_", "SBATCH_", "SRUN_", "SQUEUE_", "SINFO_"))
    }
    return {**mine, "PATH": f"{folder / 'bin'}{os.pathsep}{_PATH}", "SLURM_CONF": str(conf)}


@contextmanager
def _free_ports(count: int) -> Iterator[list[int]]:
    with ExitStack() as stack:
        sockets = [stack.enter_context(socket.socket()) for _ in range(count)]
        for one in sockets:
            one.bind(("127.0.0.1", 0))
        yield [one.getsockname()[1] for one in sockets]


def _start(
    folder: Path, stack: ExitStack, environment: Mapping[str, str], daemon: str, *arguments: str
) -> subprocess.Popen[bytes]:
    """Start a daemon in the foreground, to be killed when the stack is left; give its keeper."""
    program = shutil.which(daemon, path=_PATH)
    assert program is not None
    with (folder / f"{daemon}.out").open("ab") as said:
        keeper = subprocess.Popen(
            [sys.executable, "-c", _KEEPER, program, *arguments],
            env=environment, cwd=folder, start_new_session=True,
            stdin=subprocess.DEVNULL, stdout=said, stderr=said,
        )  # fmt: skip
    stack.callback(_kill, keeper)
    return keeper


def _kill(keeper: subprocess.Popen[bytes]) -> None:
    """Kill a daemon and all that came of it, parents first: none is left to tell of an end."""
    while keeper.poll() is None:
        for one in Process(keeper.pid).children(recursive=True):
            with suppress(NoSuchProcess):
                one.kill()
        with suppress(subprocess.TimeoutExpired):
            keeper.wait(0.1)


def _wait_for(
    folder: Path, environment: Mapping[str, str], command: list[str], answer: str
) -> None:
    """Ask until the answer is there, or until patience ends."""
    until = time.monotonic() + _PATIENCE
    while time.monotonic() < until:
        done = subprocess.run(
            command, env=environment, capture_output=True, text=True, check=False, timeout=_PATIENCE
        )
        if done.returncode == 0 and done.stdout.startswith(answer):
            return
        time.sleep(0.1)
    logs = sorted(folder.glob("*.out")) + sorted(folder.glob("*.log"))
    lines = [line for log in logs for line in log.read_text(errors="replace").splitlines()]
    errors = [line for line in lines if "error" in line.lower()] or [done.stderr.strip() or "none"]
    raise ClusterError(f"no answer of {command[0]} in {_PATIENCE:g} s; last error: {errors[-1]}")
