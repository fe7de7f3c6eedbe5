"""What a user's environment holds for other programs: octsim's own processes go without.

Variables of Python's, a matplotlibrc, modules in the current folder or on PYTHONPATH, as clusters
and notebooks have them, would each change what is imported, said or drawn.
"""

import contextlib
import os
import sys
import warnings
from collections.abc import Mapping
from importlib.machinery import PathFinder
from io import TextIOWrapper

from octsim.base.carried import PACKAGE

_KEPT = ("PYTHONDONTWRITEBYTECODE", "PYTHONPYCACHEPREFIX", "PYTHONUNBUFFERED")
"""Of Python's variables: where bytecode goes, and when a line is shown, changes no result."""
_OF_NUMBA = (
    "NUMBA_CACHE_DIR",
    "NUMBA_CPU_NAME",
    "NUMBA_CPU_FEATURES",
    "NUMBA_DISABLE_JIT",
    "NUMBA_OPT",
)
"""Of numba's variables: those that kept code is told apart by, and where it lies."""
_OWN = {
    "MATPLOTLIBRC": os.devnull,
    "MPLBACKEND": "agg",
    "PYTHONSAFEPATH": "1",  # the current folder holds data, not libraries
    "PYTHONUTF8": "1",
}


def settle() -> None:
    """Make this process one of octsim's own, and those that it starts."""
    settle_imports()
    settle_words()
    environment = settled(os.environ)
    os.environ.clear()
    os.environ.update(environment)


def settle_imports() -> None:
    """Look for modules on PYTHONPATH and in the current folder last, after what is installed.

    What only they have is still found. The package itself stays the one that is loaded.
    """
    theirs = {"", *os.environ.get("PYTHONPATH", "").split(os.pathsep)}
    with contextlib.suppress(OSError):  # the current folder may have been removed
        theirs = {*theirs, *map(os.path.abspath, theirs)}
    sys.path.sort(key=lambda place: place in theirs)
    found = PathFinder.find_spec(PACKAGE.name, sys.path)
    if found is None or found.origin != str(PACKAGE / "__init__.py"):
        sys.path.insert(0, str(PACKAGE.parent))


def settle_words() -> None:
    """Take warnings as Python does by itself, and say any text whatever the locale."""
    if sys.warnoptions:
        warnings.resetwarnings()
        for unasked in (DeprecationWarning, PendingDeprecationWarning, ResourceWarning):
            warnings.simplefilter("ignore", unasked)
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")


def settled(environment: Mapping[str, str]) -> dict[str, str]:
    """Return the environment of a process of octsim's own, from that of a user.

    It looks for modules in the order in which this process does.
    """
    kept = {
        name: value
        for name, value in environment.items()
        if name in _KEPT + _OF_NUMBA or not name.startswith(("PYTHON", "NUMBA_"))
    }
    return kept | _OWN | {"PYTHONPATH": os.pathsep.join(filter(None, sys.path))}
