"""Grids that a command has looked at, handed to its run's processes: each would take as long."""

import hashlib
import json
import os
from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, NamedTuple

FOLDER = "OCTSIM_LOOKED"
"""Environment variable with the folder of a command's own, where it is kept what was looked at."""


def keep_beside_runs() -> TemporaryDirectory[str] | None:
    """Make the folder in ``.snakemake``, which every node of a run sees; it goes at the end.

    Returns
    -------
    TemporaryDirectory or None
        None where nothing can be written here, and nothing is kept.
    """
    try:
        folder = Path(".snakemake").absolute()
        folder.mkdir(exist_ok=True)
        kept = TemporaryDirectory(prefix="looked-", dir=folder)
    except OSError:
        return None
    os.environ[FOLDER] = kept.name
    return kept


class Handed(NamedTuple):
    """What was found of a config, that is a whole and possible."""

    config: Mapping[str, Any]
    """Plain data of the checked config, with the values of its grid listed."""
    said: list[str]
    """What is to be warned of."""


def hand(given: Mapping[str, Any], found: Handed) -> None:
    """Keep what was found of a config for this command's run, if that asks for it."""
    if file := _file(given):
        with suppress(OSError, TypeError, ValueError):  # they find it themselves then
            partial = file.with_suffix(f".{os.getpid()}")
            partial.write_text(json.dumps(found), encoding="utf-8")
            partial.replace(file)


def handed(given: Mapping[str, Any]) -> Handed | None:
    """Return what a command has found of the same config, if one has started this process."""
    if file := _file(given):
        with suppress(OSError, TypeError, ValueError):
            return Handed(*json.loads(file.read_bytes()))
    return None


def _file(given: Mapping[str, Any]) -> Path | None:
    folder = os.environ.get(FOLDER)
    if not folder:
        return None
    try:
        text = json.dumps(given, sort_keys=True, allow_nan=False)
    except (TypeError, ValueError):  # what YAML alone can say
        return None
    return Path(folder, f"{hashlib.sha256(text.encode()).hexdigest()}.json")
