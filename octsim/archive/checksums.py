"""The file SHA256SUMS: what every other file's digest is, as `sha256sum -c` reads it."""

import hashlib
import re
from collections.abc import Iterable, Mapping
from pathlib import Path

from octsim.archive.safe_names import require_plain
from octsim.base.errors import ArchiveError

SUMS = "SHA256SUMS"
LARGEST = 4_000_000
"""Bytes of a sums file; that of a run has some thousand."""
_PIECE = 1 << 20
_LINE = re.compile(r"([0-9a-f]{64})  ([^\n]+)")


def pieces_of(file: Path) -> Iterable[bytes]:
    """Give what a file holds, piece by piece."""
    with file.open("rb") as stream:
        while piece := stream.read(_PIECE):
            yield piece


def digest(pieces: Iterable[bytes]) -> str:
    """Give the SHA-256 of bytes that come in pieces, in lower-case hexadecimal."""
    found = hashlib.sha256()
    for piece in pieces:
        found.update(piece)
    return found.hexdigest()


def written(digests: Mapping[str, str]) -> bytes:
    """Write a sums file: a line for each name, in alphabetical order."""
    return "".join(f"{digests[name]}  {name}\n" for name in sorted(digests)).encode("ascii")


def parsed(data: bytes) -> dict[str, str]:
    """Read a sums file; only what `written` writes is one.

    Raises
    ------
    ArchiveError
        If it is not, or names what is not a plain path.
    """
    try:
        lines = data.decode("ascii").split("\n")
    except UnicodeDecodeError:
        raise ArchiveError(f"{SUMS} is not text of digests and names") from None
    found: list[tuple[str, str]] = []
    for number, line in enumerate(lines[:-1], 1):
        match = _LINE.fullmatch(line)
        if not match:
            raise ArchiveError(f"{SUMS}, line {number}: not a digest and a name")
        found.append((match[2], match[1]))
    try:
        require_plain(name for name, _ in found)
    except ArchiveError as error:
        raise ArchiveError(f"{SUMS} {error}") from None
    digests = dict(found)
    if written(digests) != data or SUMS in digests:
        raise ArchiveError(f"{SUMS} is not as octsim writes it: sorted, whole, without itself")
    return digests


def differences(listed: Mapping[str, str], found: Mapping[str, str]) -> list[str]:
    """Say which files are not as a sums file lists them, one a line.

    Parameters
    ----------
    listed, found : mapping
        Digest by name; `found` without the sums file itself.
    """
    said = {name: "missing" for name in listed if name not in found}
    said |= {name: "additional" for name in found if name not in listed}
    said |= {n: "changed" for n, one in listed.items() if found.get(n, one) != one}
    return [f"{name}: {what}" for name, what in sorted(said.items())]
