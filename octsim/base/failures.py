"""What libraries raise of damaged and hostile files, in one line of this package."""

from collections.abc import Iterator
from contextlib import contextmanager

from octsim.base.errors import FileError, OctsimError
from octsim.base.files import reason

_LONGEST = 120


@contextmanager
def said_in_a_line(
    name: str, remedy: str, kind: type[OctsimError] = FileError, *, of_memory: bool = False
) -> Iterator[None]:
    """Say in one line that something can't be read, whatever a library raises.

    Parameters
    ----------
    name : str
        The file, and what in it is read.
    remedy : str
        What to do.
    kind : type, optional
        Of the error.
    of_memory : bool
        Whether the file alone decides how much memory is asked for, so that too much is its fault.

    Raises
    ------
    OctsimError
        Of that kind, if anything is raised but what the package says itself.
    """
    try:
        yield
    except OctsimError:
        raise
    except MemoryError:
        if of_memory:
            raise kind(f"{name}: takes more memory than there is; {remedy}") from None
        raise
    # a damaged file makes its library raise what it never says it does: a KeyError, a struct.error
    except Exception as error:
        raise kind(f"{name}: can't be read ({shortly(error)}); {remedy}") from error


def shortly(error: BaseException) -> str:
    """Return what a library says, as a part of a line."""
    said = reason(error)
    return said if len(said) <= _LONGEST else f"{said[: _LONGEST - 3]}..."
