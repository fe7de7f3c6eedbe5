"""What a dataset records of its making: version of octsim, sources, libraries."""

from collections.abc import Mapping
from typing import Any, NamedTuple

from octsim.base.errors import one_line
from octsim.datasets.versions import recorded_environment


class Origin(NamedTuple):
    """What a dataset was made with."""

    octsim_version: str
    """Empty if it is not recorded."""
    schema_version: int
    source_digest: str
    """Empty if it is not recorded."""
    environment: Mapping[str, str] | None
    """Versions of libraries, processor and system; None of a file of octsim 0.1.0."""


def origin_of(attributes: Mapping[str, Any]) -> Origin:
    """Return what a dataset's attributes, as they stand in its file, record."""
    return Origin(
        one_line(attributes.get("octsim_version", "")),
        int(attributes.get("schema_version", 0)),
        one_line(attributes.get("source_digest", "")),
        recorded_environment(attributes),
    )
