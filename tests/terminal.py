"""A command on a terminal: what its screen shows at last, and keys that are pressed."""

import contextlib
import fcntl
import os
import pty
import re
import signal
import struct
import subprocess
import termios
import threading
import time
from collections.abc import Callable, Sequence
from pathlib import Path

_COLUMNS = 4000  # of a terminal on which no line is too long
_PARTS = re.compile(r"\x1b\[K|\x1b\[[0-9;?]*[a-zA-Z]|\r|\n|[^\x1b\r\n]+|\x1b")


class Terminal:
    """A command that runs on a terminal, as a person starts it.

    Parameters
    ----------
    command : sequence of str
        What is run.
    folder : path
        Where.
    **environment : str
        Variables that the command has besides this process's.
    """

    def __init__(self, command: Sequence[str], folder: Path, **environment: str) -> None:
        self.pid, self._end = pty.fork()
        if self.pid == 0:
            try:
                for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
                    signal.signal(number, signal.SIG_DFL)  # whatever is ignored here, as by nohup
                os.chdir(folder)
                os.execvpe(command[0], list(command), {**os.environ, **environment})
            finally:
                os._exit(127)
        fcntl.ioctl(self._end, termios.TIOCSWINSZ, struct.pack("HHHH", 50, _COLUMNS, 0, 0))
        self._written = bytearray()
        self.ended = -1
        self._reader = threading.Thread(target=self._read, daemon=True)
        self._reader.start()

    def _read(self) -> None:
        with contextlib.suppress(OSError):  # the command has ended
            while part := os.read(self._end, 65536):
                self._written += part

    def until(self, there: Callable[[], bool]) -> None:
        """Wait for what is to be seen; it is an error if the command ends before."""
        while not there():
            assert self._reader.is_alive() or there(), self.written
            time.sleep(0.02)

    def press_ctrl_c(self) -> None:
        """Have the terminal interrupt whatever runs on it."""
        os.write(self._end, b"\x03")

    def kill(self, number: int) -> None:
        """Send a signal to the command alone."""
        os.kill(self.pid, number)

    def has_ended(self) -> bool:
        """Return whether the command has ended; its status can still be asked for."""
        return os.waitid(os.P_PID, self.pid, os.WEXITED | os.WNOHANG | os.WNOWAIT) is not None

    def status(self) -> int:
        """Return the exit status as a shell tells it, once the command has ended."""
        _, status = os.waitpid(self.pid, 0)
        self._reader.join()
        os.close(self._end)
        code = os.waitstatus_to_exitcode(status)
        self.ended = code if code >= 0 else 128 - code
        return self.ended

    @property
    def written(self) -> str:
        """All that was written, with what moves the cursor."""
        return self._written.decode(errors="replace")

    def screen(self) -> list[str]:
        """Return the lines as they stand at last."""
        lines, column = [""], 0
        for part in _PARTS.findall(self.written):
            if part == "\n":
                lines.append("")
                column = 0
            elif part == "\r":
                column = 0
            elif part == "\x1b[K":
                lines[-1] = lines[-1][:column]
            elif not part.startswith("\x1b"):
                lines[-1] = lines[-1][:column] + part + lines[-1][column + len(part) :]
                column += len(part)
        return [line.rstrip() for line in lines if line.strip()]


def processes_in(folder: Path) -> dict[int, str]:
    """Return the processes that work in a folder, with the command of each."""
    shown = subprocess.run(["ps", "-eo", "pid,args"], capture_output=True, text=True, check=True)
    found = {}
    for line in shown.stdout.splitlines()[1:]:
        process, _, command = line.strip().partition(" ")
        with contextlib.suppress(OSError):
            if Path(f"/proc/{process}/cwd").readlink() == folder:
                found[int(process)] = command
    return found
