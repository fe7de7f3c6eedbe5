"""How a process ends at a signal: with one line, its status, and what it has started."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from octsim.cli.job_server import is_alive

LINE = "octsim: stopped; run the same command again to go on"
CANCELLING = """
import sys, time
from octsim.cli.stopped import stops_by_cancelling
stops_by_cancelling()
try:
    print("begun", flush=True)
    time.sleep(600)
except KeyboardInterrupt:
    print("cancelled", file=sys.stderr)
    sys.exit(1)
"""
AT_ONCE = """
import subprocess, sys, tempfile, time
from octsim.cli.stopped import stops_at_signals
temporary = tempfile.TemporaryDirectory()
started = subprocess.Popen(["sleep", "600"])
stops_at_signals(lambda: [started])
print(started.pid, temporary.name, flush=True)
try:
    time.sleep(600)
except BaseException:
    print("not reached")
"""

WHOLE = """
import os, signal, sys
from octsim.cli.run import _Running
status = _Running([sys.executable, "-c", ""], [], "").ended()
os.kill(os.getpid(), int(sys.argv[1]))
# a handler of its own would be taken away before the process has ended
print(signal.getsignal(int(sys.argv[1])) is signal.SIG_IGN)
sys.exit(status)
"""


def begun(code: str, **environment: str) -> tuple["subprocess.Popen[str]", str]:
    process = subprocess.Popen(
        [sys.executable, "-c", code], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
        env=os.environ | environment,
    )  # fmt: skip
    assert process.stdout is not None
    return process, process.stdout.readline().strip()


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_on_a_cluster_jobs_are_cancelled_and_the_line_comes_last(number: signal.Signals) -> None:
    process, _ = begun(CANCELLING)
    process.send_signal(number)
    _, said = process.communicate()
    assert said.splitlines() == ["cancelled", LINE]
    assert process.returncode == 128 + number


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
def test_elsewhere_all_ends_at_once_and_temporary_folders_go(number: signal.Signals) -> None:
    process, words = begun(AT_ONCE)
    started, temporary = words.split()
    process.send_signal(number)
    out, said = process.communicate()
    assert (out, said.splitlines()) == ("", [LINE])
    assert process.returncode == 128 + number
    assert not Path(temporary).exists()
    while is_alive(int(started)):  # it is killed, and taken from the list soon after
        time.sleep(0.02)


def test_where_warnings_are_errors_the_line_stands_alone_too() -> None:
    process, words = begun(f"import warnings; warnings.simplefilter('error'){AT_ONCE}")
    process.send_signal(signal.SIGTERM)
    _, said = process.communicate()
    assert said.splitlines() == [LINE]
    assert not Path(words.split()[1]).exists()


def test_a_process_whose_octsim_run_has_gone_ends_in_silence() -> None:
    process, _ = begun(AT_ONCE, OCTSIM_COMMAND=str(os.getppid()))
    _, said = process.communicate()
    assert (process.returncode, said) == (128 + signal.SIGTERM, "")


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
def test_a_run_that_is_whole_ends_as_one_whatever_signal_comes_late(number: signal.Signals) -> None:
    done = subprocess.run(
        [sys.executable, "-c", WHOLE, str(int(number))], capture_output=True, text=True, check=False
    )
    assert (done.returncode, done.stdout, done.stderr) == (0, "True\n", "")
