"""A run that is told to stop, by Ctrl-C or a signal: it ends at once, with one line.

What is killed at any moment goes on where it stopped, so nothing has to be brought to an end.
"""

import atexit
import logging
import os
import signal
import sys
import threading
import time
import warnings
from collections.abc import Callable, Iterable
from types import FrameType
from typing import Any, NoReturn

from octsim.base.say import say

SIGNALS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)
"""Ctrl-C, what `kill` and batch systems send, and a terminal that is closed."""
COMMAND = "OCTSIM_COMMAND"
"""Environment variable with the process of `octsim run`, which says the line itself."""
DEAF = ("/bin/sh", "-c", 'trap \'\' INT; exec "$0" "$@"')
"""Begin of a command that a Ctrl-C in the terminal does not reach: who started it ends it."""
_LOOK = 0.2  # s, between looks at whether `octsim run` is still there
_LONGEST = 1.0  # s that an end by the signal's handler may take


class _Line:
    is_said_here = True


def say_stopped() -> None:
    """Say that a run has stopped."""
    say("stopped; run the same command again to go on")


def on_signals(handler: Callable[[int, FrameType | None], Any]) -> None:
    """Have the signals that stop a run handled, but for those that are to be ignored, as by nohup.

    Nothing is done in a thread that can't have signals, as in a program that runs workflows.
    """
    if threading.current_thread() is threading.main_thread():
        for one in SIGNALS:
            if signal.getsignal(one) is not signal.SIG_IGN:
                signal.signal(one, handler)


def stops_at_signals(processes: Callable[[], Iterable[Any]]) -> None:
    """Have this process end at a signal, or with its `octsim run`, and those it has started before.

    Parameters
    ----------
    processes : callable
        Returns those that it has started, and they have, each with a method `kill`.
    """

    def stop(number: int, _frame: FrameType | None) -> NoReturn:
        logging.disable()  # of jobs that end now nothing is to be said
        for process in processes():
            try:
                process.kill()
            except Exception:  # it has ended by itself
                continue
        _end(number)

    on_signals(stop)
    if command := os.environ.pop(COMMAND, None):
        _Line.is_said_here = False
        threading.Thread(target=_watch, args=(int(command),), daemon=True).start()


def stops_by_cancelling() -> None:
    """Have this process be interrupted at a signal, so that snakemake cancels jobs on a cluster."""

    def stop(number: int, _frame: FrameType | None) -> NoReturn:
        atexit.register(_end, number)  # the last of all
        raise KeyboardInterrupt

    on_signals(stop)


def _end(number: int) -> NoReturn:
    """End this process; folders of temporary files go as in any end."""
    atexit.unregister(_end)
    # this may be in the midst of what takes warnings for errors: each folder would be a traceback
    warnings.simplefilter("ignore")
    atexit._run_exitfuncs()
    if _Line.is_said_here:
        say_stopped()
    sys.stderr.flush()
    os._exit(128 + number)


def _watch(command: int) -> None:
    while os.getppid() == command:
        time.sleep(_LOOK)
    os.kill(os.getpid(), signal.SIGTERM)
    time.sleep(_LONGEST)
    os._exit(128 + signal.SIGTERM)
