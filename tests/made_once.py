"""What tests of several workers read, made by one of them."""

import pickle
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import TypeVar

from filelock import FileLock

Made = TypeVar("Made")


class Once:
    """Makes a thing once in a session, whichever worker asks first.

    Parameters
    ----------
    folder : Path
        That all workers see.
    """

    def __init__(self, folder: Path) -> None:
        self._folder = folder

    def made(self, name: str, make: Callable[[Path], Made]) -> Made:
        """Return what `make` makes in a new folder of that name; the others get a copy.

        Parameters
        ----------
        name : str
            Of the thing.
        make : callable
            Is given the folder; returns what can be pickled.
        """
        kept = self._folder / f"{name}.pickle"
        with FileLock(kept.with_suffix(".lock")):
            if not kept.exists():
                folder, partial = self._folder / name, kept.with_suffix(".partial")
                shutil.rmtree(folder, ignore_errors=True)  # what one that failed has left
                folder.mkdir()
                partial.write_bytes(pickle.dumps(make(folder)))
                partial.replace(kept)
            found: Made = pickle.loads(kept.read_bytes())
        return found
