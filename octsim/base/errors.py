"""What octsim says when something is not as it must be: one clear line, for a person."""

import re

LONGEST = 300
"""Letters of a line."""
_LONG_WORD = re.compile(r"\S{45,}")
"""As the path of a file in deep folders; its end tells more than its start."""
_CUT = " ... "


def printable(text: object) -> str:
    r"""Return text with all that is no letter of a line written out, as ``\x1b`` and ``\n``.

    What a file says can't move a terminal's cursor then, nor look like a line of octsim's.
    """
    said = str(text)
    if said.isprintable():
        return said
    return "".join(
        one if one.isprintable() else one.encode("unicode_escape").decode("ascii") for one in said
    )


def one_line(text: object) -> str:
    """Return text as one line that may be printed, cut if it is long: its longest words first."""
    said = printable(_without_middle(str(text), 20_000))  # of megabytes not all is looked at
    if len(said) <= LONGEST:
        return said
    for word in sorted(set(_LONG_WORD.findall(said)), key=len, reverse=True):
        if len(said) > LONGEST:
            said = said.replace(word, f"{word[:8]}...{word[-25:]}")
    return _without_middle(said, LONGEST)  # whose end says what to do


def _without_middle(text: str, most: int) -> str:
    if len(text) <= most:
        return text
    head = 2 * most // 3
    return text[:head] + _CUT + text[len(text) - (most - head - len(_CUT)) :]


class _Said:
    """Something that is said in a line for each argument, whatever these hold."""

    args: tuple[object, ...]

    def __str__(self) -> str:
        return "\n".join(map(one_line, self.args))


class OctsimError(_Said, Exception):
    """Something a user can put right; its text says what, where and how.

    Each argument is a line of it: what is no letter of a line is written out, a long one is cut.

    Examples
    --------
    >>> import octsim
    >>> try:
    ...     octsim.load_config({"scene": {"gapp": "20 nm"}})
    ... except octsim.OctsimError as error:
    ...     print(str(error).split(";")[0])
    scene.gapp: unknown key
    """


class ConfigError(OctsimError):
    """The config cannot be used; a line for each problem.

    Examples
    --------
    >>> import octsim
    >>> try:
    ...     octsim.load_config({"scene": {"gap": 20}})
    ... except octsim.ConfigError as error:
    ...     print(str(error).split(";")[0])
    scene.gap: 20 given
    """


class DatasetError(OctsimError):
    """A stored dataset is missing, damaged or not what it should be.

    Examples
    --------
    >>> import octsim
    >>> try:
    ...     octsim.read("nothing.nc")
    ... except octsim.DatasetError as error:
    ...     print(str(error).split(";")[0])
    nothing.nc: not there
    """


def not_installed(library: str, extra: str) -> OctsimError:
    """Return the error of a library that is missing, as it is one of an extra of the package."""
    return OctsimError(f"{library} is not installed; run: pip install 'octsim[{extra}]'")


class OctsimWarning(_Said, UserWarning):
    """Something that a user should know but that stops nothing.

    Examples
    --------
    >>> import octsim
    >>> import warnings
    >>> with warnings.catch_warnings(record=True) as said:
    ...     warnings.simplefilter("always", octsim.OctsimWarning)
    ...     config = octsim.load_config({"sweep": {"diameters": {"num": 3}}})
    >>> print(str(said[0].message).split(":")[0])
    sweep.diameters
    """


class UncheckedWarning(OctsimWarning):
    """A dataset has no digest of its bytes, so that damage in it can't be seen."""


class FileError(OctsimError):
    """A file can't be written, or is none that can be read.

    Examples
    --------
    >>> import octsim
    >>> try:
    ...     octsim.read_spectra("nothing.npy")
    ... except octsim.FileError as error:
    ...     print(str(error).split(";")[0])
    nothing.npy: can't be read (not there)
    """


class CacheError(OctsimError):
    """A folder is no point cache, or not one that this octsim reads, or can't be cleared.

    Examples
    --------
    >>> import octsim
    >>> from pathlib import Path
    >>> from tempfile import TemporaryDirectory
    >>> from octsim.instrument.point_store import clear
    >>> with TemporaryDirectory() as folder:
    ...     Path(folder, "notes.txt").touch()
    ...     try:
    ...         clear(Path(folder))
    ...     except octsim.CacheError as error:
    ...         print(str(error).removeprefix(f"{folder}: ").split(";")[0])
    is not a point cache of octsim
    """


class ArchiveError(OctsimError):
    """A run can't be packed, or an archive is not what was packed; a line for each problem.

    Examples
    --------
    >>> import octsim
    >>> from pathlib import Path
    >>> from tempfile import TemporaryDirectory
    >>> with TemporaryDirectory() as folder:
    ...     file = Path(folder, "thesis.zip")
    ...     _ = file.write_bytes(b"cut short")
    ...     try:
    ...         octsim.compare(file, file)
    ...     except octsim.ArchiveError as error:
    ...         print(str(error).removeprefix(f"{file}: ").split(" (")[0])
    not a zip that is whole
    """
