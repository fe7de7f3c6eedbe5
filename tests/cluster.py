"""A private Slurm of one node, in a folder of its own: started, given, and stopped again."""

import getpass
import os
import secrets
import shutil
import signal
import socket
import subprocess
import tempfile
import time
from collections.abc import Iterator, Mapping
from contextlib import ExitStack, contextmanager
from pathlib import Path

CORES = 2
MEMORY = 4000  # MB that jobs share
_PATIENCE = 30.0  # s, until a daemon answers
_PROGRAMS = ("munged", "munge", "slurmctld", "slurmd", "sbatch", "squeue", "sinfo", "scontrol")
_PATH = os.pathsep.join([os.environ.get("PATH", os.defpath), "/usr/local/sbin", "/usr/sbin"])

# No accounting, and no cgroups: both would need a system that is set up for them. Memory is looked
# at each second, and a job that is over its own is killed as out of memory.
_CONFIG = """\
ClusterName=octsim
SlurmctldHost={host}(127.0.0.1)
SlurmctldPort={ports[0]}
SlurmdPort={ports[1]}
SlurmUser={user}
SlurmdUser={user}
AuthType=auth/munge
AuthInfo=socket={folder}/munge/socket
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/slurmd.pid
SlurmctldLogFile={folder}/slurmctld.log
SlurmdLogFile={folder}/slurmd.log
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
MinJobAge=600
SlurmdParameters=config_overrides
NodeName={host} NodeAddr=127.0.0.1 CPUs={cores} RealMemory={memory} State=UNKNOWN
PartitionName=all Nodes={host} Default=YES MaxTime=INFINITE State=UP
"""


class ClusterError(Exception):
    """Slurm can't be started here; its text is one line that says why."""


@contextmanager
def cluster() -> Iterator[Mapping[str, str]]:
    """Start a Slurm of one node; give the environment in which its commands find it.

    Nothing outside a temporary folder is read or written, and another Slurm of the machine is left
    alone. All that was started is stopped at the end, jobs that still run too.

    Raises
    ------
    ClusterError
        If a program is missing or does not start.
    """
    missing = [name for name in (*_PROGRAMS, "srun") if shutil.which(name, path=_PATH) is None]
    if missing:
        raise ClusterError(f"{missing[0]} is not installed (Debian: slurm-wlm, munge)")
    with ExitStack() as stack:
        # below /tmp itself: a socket's name has 107 characters at most
        folder = Path(stack.enter_context(tempfile.TemporaryDirectory(prefix="octsim-")))
        folder = folder.resolve()
        for part in ("munge", "state", "spool", "bin"):
            (folder / part).mkdir(mode=0o755)
        folder.chmod(0o755)
        _authenticate(folder, stack)
        environment = _configure(folder)
        with _free_ports() as ports:
            text = _CONFIG.format(
                host=socket.gethostname().split(".")[0], ports=ports, user=getpass.getuser(),
                folder=folder, cores=CORES, memory=MEMORY,
            )  # fmt: skip
            (folder / "slurm.conf").write_text(text)
        for daemon in ("slurmctld", "slurmd"):
            _start(folder, stack, environment, daemon, "-D")
        stack.callback(_end_jobs, environment)
        _wait_for(folder, environment, ["sinfo", "--noheader", "--format=%T"], "idle")
        yield environment


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


def _configure(folder: Path) -> dict[str, str]:
    """Give the environment in which Slurm's commands find this folder's."""
    (folder / "plugstack.conf").touch()
    conf = folder / "slurm.conf"
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
def _free_ports() -> Iterator[list[int]]:
    with ExitStack() as stack:
        sockets = [stack.enter_context(socket.socket()) for _ in range(2)]
        for one in sockets:
            one.bind(("127.0.0.1", 0))
        yield [one.getsockname()[1] for one in sockets]


def _start(
    folder: Path, stack: ExitStack, environment: Mapping[str, str], daemon: str, *arguments: str
) -> None:
    """Start a daemon in the foreground, to be stopped when the stack is left."""
    program = shutil.which(daemon, path=_PATH)
    assert program is not None
    with (folder / f"{daemon}.out").open("wb") as said:
        started = subprocess.Popen(
            [program, *arguments], env=environment, cwd=folder, start_new_session=True,
            stdin=subprocess.DEVNULL, stdout=said, stderr=said,
        )  # fmt: skip

    def stop() -> None:
        started.terminate()
        try:
            started.wait(10)
        except subprocess.TimeoutExpired:
            started.send_signal(signal.SIGKILL)
            started.wait()

    stack.callback(stop)


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


def _end_jobs(environment: Mapping[str, str]) -> None:
    """End jobs that still run, before the daemons that could end them."""
    every = ["scancel", "--signal=KILL", "--full", f"--user={getpass.getuser()}"]
    for command in (every, [one for one in every if "signal" not in one and one != "--full"]):
        subprocess.run(command, env=environment, capture_output=True, check=False, timeout=30)
    until = time.monotonic() + 10
    while time.monotonic() < until:
        left = subprocess.run(
            ["squeue", "--noheader"], env=environment, capture_output=True, check=False, timeout=30
        )
        if not left.stdout.strip():
            return
        time.sleep(0.1)
