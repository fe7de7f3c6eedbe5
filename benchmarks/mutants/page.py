"""The part of docs/mutants.md that says which changes the tests noticed."""

from collections import Counter
from collections.abc import Mapping, Sequence
from fnmatch import fnmatch
from pathlib import Path

import yaml
from mutants.changes import Change

REASONS = Path(__file__).with_name("reasons.yaml")

SAME, COMPILED = "the same: ", "compiled: "
"""Reasons of changes that change nothing, and of those that a test notices when it is compiled."""


def reasons(kind: str = "") -> dict[str, str]:
    """Return why no test notices changes, by their names: all reasons, or those of a kind."""
    told: dict[str, str] = yaml.safe_load(REASONS.read_text(encoding="utf-8")) or {}
    return {name: why for name, why in told.items() if why.startswith(kind)}


def lines(
    rooms: Mapping[str, Sequence[str]],
    drawn: Sequence[Change],
    noticed: Mapping[str, str],
    seed: str,
    times: tuple[float, float],
) -> list[str]:
    """Return the part's lines: how many changes tests noticed, by room, and each that none did.

    Parameters
    ----------
    rooms : mapping
        Patterns of the files of each room.
    drawn : sequence of Change
        All that were to be tried.
    noticed : mapping
        By the name of each that was tried, the test that noticed it; empty where none did.
    seed : str
        Of the draw.
    times : tuple of float
        Processor time, s, that one test may take, and that those of a change may.
    """
    told, same = reasons(), reasons(SAME)
    tried = [one for one in drawn if one.name in noticed]
    unnoticed = [one for one in tried if not noticed[one.name]]
    rows, whole = [], Counter[str]()
    for room, patterns in rooms.items():
        of = [one for one in tried if any(fnmatch(one.module, p) for p in patterns)]
        counts = Counter(
            "noticed" if noticed[one.name] else "same" if one.name in same else "not" for one in of
        )
        whole += counts
        rows.append(_row(room, counts))
    rows.append(_row("all", whole))
    found = [
        f"Of the first {len(drawn)} changes that the seed `{seed}` draws {len(tried)} were "
        f"tried, by up to {times[1]:g} s of tests each, of tests that take up to {times[0]:g} s.",
        "",
        "| | changes | noticed | the same | not noticed | share noticed, but for the same |",
        "| --- | --- | --- | --- | --- | --- |",
        *rows,
        "",
        "Those that no test noticed:",
        "",
    ]
    for one in unnoticed:
        why = told.get(one.name, "not looked into")
        found.append(f"- `{one.module}`, line {one.line}: `{one.was}` to `{one.now}`: {why}")
    return found


def _row(room: str, counts: Mapping[str, int]) -> str:
    every, noticed, same = sum(counts.values()), counts.get("noticed", 0), counts.get("same", 0)
    share = f"{noticed / (every - same):.0%}" if every > same else ""
    return f"| {room} | {every} | {noticed} | {same} | {counts.get('not', 0)} | {share} |"
