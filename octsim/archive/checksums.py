"""The file SHA256SUMS: what every other file's digest is, as `sha256sum -c` reads it."""

import re
from collections.abc import Mapping

from octsim.archive.safe_names import require_plain
from octsim.base.errors import ArchiveError

SUMS = "SHA256SUMS"
LARGEST = 4_000_000
"""Bytes of a sums file, or of a zip's directory; those of a run have some thousand."""
DAMAGED = "damaged"
"""Stands for the digest of what is not whole, or no plain file."""
_LINE = re.compile(r"([0-9a-f]{64})  ([^\n]+)")


def format_sums(digests: Mapping[str, str]) -> bytes:
    """Return a sums file: a line for each name, in alphabetical order."""
    return "".join(f"{digests[name]}  {name}\n" for name in sorted(digests)).encode("ascii")


def parse_sums(data: bytes) -> dict[str, str]:
    """Return the digests by name of a sums file; only what `format_sums` returns is one.

    Raises
    ------
    ArchiveError
        If it is not, or names what is not a plain path.
    """
    try:
        lines = data.decode("ascii").split("\n")
    except UnicodeDecodeError:
        raise ArchiveError(f"{SUMS} is not text of digests and names") from None
    matches = [_LINE.fullmatch(line) for line in lines[:-1]]
    pairs = [(match[2], match[1]) for match in matches if match]
    if len(pairs) < len(matches):
        number = matches.index(None) + 1
        raise ArchiveError(f"{SUMS}, line {number}: not a digest and a name")
    try:
        require_plain(name for name, _ in pairs)
    except ArchiveError as error:
        raise ArchiveError(f"{SUMS} {error}") from None
    digests = dict(pairs)
    if format_sums(digests) != data or SUMS in digests:
        raise ArchiveError(f"{SUMS} is not as octsim writes it: sorted, whole, without itself")
    return digests


def differences(listed: Mapping[str, str], present: Mapping[str, str]) -> list[str]:
    """Return which files are not as a sums file lists them, a line each.

    Parameters
    ----------
    listed, present : mapping
        Digest by name; `present` without the sums file itself.
    """
    problems = {name: "missing" for name in listed if name not in present}
    problems |= {name: "additional" for name in present if name not in listed}
    problems |= {n: "changed" for n, one in listed.items() if present.get(n, one) != one}
    return [f"{name}: {what}" for name, what in sorted(problems.items())]
