"""What two runs were made from, and with: which keys of the config and which versions differ."""

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any, NamedTuple

import xarray as xr

from octsim.archive.origin import origin_of
from octsim.config.grid import as_text
from octsim.config.models import Config

NOT_RECORDED = "not recorded"


class Change(NamedTuple):
    """Something that is not the same in two runs, as text."""

    what: str
    first: str
    second: str


def config_changes(first: Config, second: Config) -> tuple[Change, ...]:
    """Return the dotted keys in which two configs differ, but for those that no result depends on.

    Ranges are told apart by their ends and their number; lengths have their unit.
    """
    return tuple(_changes(first.to_record(), second.to_record()))


def _changes(one: Mapping[str, Any], other: Mapping[str, Any], above: str = "") -> Iterator[Change]:
    for key in dict.fromkeys((*one, *other)):
        first, second = one.get(key), other.get(key)
        if first == second:
            continue
        if isinstance(first, Mapping) and isinstance(second, Mapping):
            yield from _changes(first, second, f"{above}{key}.")
        else:
            yield Change(f"{above}{key}", as_text(first), as_text(second))


def version_changes(first: Mapping[str, Path], second: Mapping[str, Path]) -> tuple[Change, ...]:
    """Return what datasets that are in both runs were not computed with alike.

    That is the version of octsim, the schema of the file, the digest of each dataset's sources, and
    each library, processor or system of the recorded environment. What differs in some of the
    datasets only is told with their names.

    Parameters
    ----------
    first, second : mapping
        Files by stage.
    """
    stages = [stage for stage in first if stage in second]
    stages_of: dict[Change, list[str]] = {}
    for stage in stages:
        one, other = (_versions(stage, files[stage]) for files in (first, second))
        if not (one.keys() & _LIBRARIES and other.keys() & _LIBRARIES):
            one, other = _joined(one), _joined(other)
        for key in dict.fromkeys((*one, *other)):
            change = Change(key, one.get(key, NOT_RECORDED), other.get(key, NOT_RECORDED))
            if change.first != change.second:
                stages_of.setdefault(change, []).append(stage)
    return tuple(
        change
        if change.what.startswith(_SOURCES) or of == stages
        else change._replace(what=f"{change.what} ({', '.join(of)})")
        for change, of in stages_of.items()
    )


_SOURCES = "sources of "
_LIBRARIES = frozenset({"python", "numpy"})
"""In every recorded environment."""
_OF_FILE = ("octsim", "schema")


def _versions(stage: str, file: Path) -> dict[str, str]:
    # as it stands in the file, and not as it is read
    with xr.open_dataset(file, engine="netcdf4", decode_cf=False) as dataset:
        origin = origin_of(dataset.attrs)
    own = {
        "octsim": origin.octsim_version or NOT_RECORDED,
        "schema": str(origin.schema_version),
        f"{_SOURCES}{stage}": origin.source_digest or NOT_RECORDED,
    }
    return own | dict(origin.environment or {})


def _joined(versions: Mapping[str, str]) -> dict[str, str]:
    """Put all libraries in one, where the other run has recorded none of them."""
    own = {key: value for key, value in versions.items() if key in _OF_FILE or _SOURCES in key}
    libraries = [f"{key} {value}" for key, value in versions.items() if key not in own]
    return own | {"libraries": ", ".join(libraries) or NOT_RECORDED}
