"""Parts of pages that a benchmark writes: what stands between two marks of a name."""

from collections.abc import Sequence
from pathlib import Path


def marks(name: str) -> tuple[str, str]:
    """Return the lines between which a part stands."""
    return f"<!-- {name}: begin -->", f"<!-- {name}: end -->"


def write_part(page: Path, name: str, made: Sequence[str]) -> None:
    """Replace what stands between the marks of a page.

    Raises
    ------
    ValueError
        If the page has no such marks.
    """
    begin, end = marks(name)
    before, found, rest = page.read_text(encoding="utf-8").partition(begin)
    _, ended, after = rest.partition(end)
    if not (found and ended):
        raise ValueError(f"{page}: no lines {begin} and {end}; put them where the part goes")
    partial = page.with_name(f".{page.name}.partial")
    partial.write_text("\n".join([before + begin, *made, end]) + after, encoding="utf-8")
    partial.replace(page)
