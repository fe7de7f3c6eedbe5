"""What an archive says of itself to machines: RO-Crate metadata, as data repositories read it."""

import datetime as dt
import json
import os
import uuid
from collections.abc import Mapping, Sequence
from operator import attrgetter
from typing import Any

from octsim.archive.checksums import SUMS
from octsim.archive.contents import CONFIG, ORCID, Item, description_of, origins_of, title_of
from octsim.base.errors import ArchiveError, not_installed
from octsim.config.archive import ArchiveConfig
from octsim.config.models import Config

_VERSION = "1.1"
"""Of RO-Crate: that which the profile extends."""
PROFILE = "https://w3id.org/ro/wfrun/process/0.5"
"""What the metadata conform to besides: Process Run Crate, of programs and what they made."""
_TERMS = {"sha256": "http://schema.org/sha256"}
"""Of schema.org, that RO-Crate 1.1 does not name yet."""
_EPOCH = "SOURCE_DATE_EPOCH"
NO_DAY = "1980-01-01"
"""Of publication, where none is given: the day that the zip has of every file."""


def _day_of(given: ArchiveConfig) -> str:
    """Return the day of publication; never that of the clock, so that archives are the same bytes.

    Raises
    ------
    ArchiveError
        If SOURCE_DATE_EPOCH is asked and is not a number of seconds.
    """
    seconds = os.environ.get(_EPOCH)
    if given.date or not seconds:
        return given.date or NO_DAY
    try:
        return dt.datetime.fromtimestamp(int(seconds), dt.UTC).date().isoformat()
    except (ValueError, OverflowError, OSError):
        raise ArchiveError(
            f"{_EPOCH}: {seconds!r} given; it should be whole seconds since 1970"
        ) from None


def unanswered(given: ArchiveConfig) -> list[str]:
    """Return what a data repository will ask for and is not given, a line each."""
    lines = []
    if not given.date and not os.environ.get(_EPOCH):
        lines.append(f"archive.date: not given, so {NO_DAY} stands as the day of publication")
    if not given.creators:
        lines.append(
            "archive.creators: not given, so the archive names nobody as who made the data"
        )
    return lines


def metadata(
    config: Config, items: Sequence[Item], sizes: Mapping[str, int], digests: Mapping[str, str]
) -> bytes:
    """Return the metadata of an archive.

    Parameters
    ----------
    config : Config
        The config that is archived, with what a user says of the archive.
    items : sequence of Item
        Files of the archive, but for the metadata and the sums.
    sizes, digests : mapping
        Bytes, and SHA-256, by name.

    Raises
    ------
    ArchiveError
        If SOURCE_DATE_EPOCH is needed and is not a number of seconds.
    OctsimError
        If rocrate is not installed.
    """
    try:
        from rocrate.model.contextentity import ContextEntity
        from rocrate.model.softwareapplication import SoftwareApplication
        from rocrate.rocrate import ROCrate
    except ImportError:
        raise not_installed("rocrate", "archive") from None

    crate = ROCrate(version=_VERSION)
    crate.metadata.extra_terms = dict(_TERMS)
    root = crate.root_dataset
    profile = {"@type": "CreativeWork", "name": "Process Run Crate", "version": "0.5"}
    root["conformsTo"] = crate.add(ContextEntity(crate, PROFILE, profile))
    given = config.archive
    root["name"], root["description"] = title_of(config), description_of(given)
    root["datePublished"] = _day_of(given)
    license_ = f"https://spdx.org/licenses/{given.license}"
    named = {"@type": "CreativeWork", "name": given.license, "identifier": given.license}
    root["license"] = crate.add(ContextEntity(crate, license_, named))
    people = _creators(crate, given)
    if people:
        root["creator"] = people
    files: dict[str, Any] = {}
    for item in sorted(items, key=attrgetter("name")):
        properties: dict[str, Any] = {
            "name": item.about,
            "encodingFormat": item.form,
            "contentSize": str(sizes[item.name]),
            "sha256": digests[item.name],
        }
        if item.variables:
            properties |= {"description": item.about, "variableMeasured": list(item.variables)}
        files[item.name] = crate.add_file(dest_path=item.name, properties=properties)
    for item in items:
        if item.stages:
            files[item.name]["isBasedOn"] = [files[f"{stage}.nc"] for stage in item.stages]
    sums = {"name": "SHA-256 of every file but itself", "encodingFormat": "text/plain"}
    crate.add_file(dest_path=SUMS, properties=sums)
    made_by: dict[str, list[Any]] = {}
    for stage, origin in origins_of(items).items():
        made_by.setdefault(origin.octsim_version, []).append(files[f"{stage}.nc"])
    actions = []
    for version, datasets in sorted(made_by.items()):
        program = {"name": "octsim", "softwareVersion": version}
        octsim = crate.add(SoftwareApplication(crate, f"#octsim-{version}", program))
        about = {
            "name": f"octsim {version} computes the datasets of the run {config.run}",
            "description": f"octsim run {CONFIG}",
        }
        made = [digests[one.id] for one in datasets]
        action = crate.add_action(octsim, _execution(made), [files[CONFIG]], datasets, about)
        action["actionStatus"] = {"@id": "http://schema.org/CompletedActionStatus"}
        if people:
            action["agent"] = people
        actions.append(action)
    if actions:
        root["mentions"] = actions
    graph = crate.metadata.generate()
    graph["@graph"].sort(key=lambda entity: str(entity["@id"]))
    return (json.dumps(graph, indent=2, sort_keys=True, ensure_ascii=False) + "\n").encode()


def _execution(digests: Sequence[str]) -> str:
    """Return what identifies an execution: its results do, so that an archive is the same bytes."""
    return uuid.uuid5(uuid.NAMESPACE_URL, f"{PROFILE}#{' '.join(sorted(digests))}").urn


def _creators(crate: Any, given: ArchiveConfig) -> list[Any]:
    """Add who made the data, and where they work; those without an ORCID iD are numbered."""
    from rocrate.model.contextentity import ContextEntity
    from rocrate.model.person import Person

    names = dict.fromkeys(one.affiliation for one in given.creators if one.affiliation)
    places = {
        name: crate.add(
            ContextEntity(crate, f"#organization-{number}", {"@type": "Organization", "name": name})
        )
        for number, name in enumerate(names, 1)
    }
    people = []
    for number, one in enumerate(given.creators, 1):
        identifier = f"{ORCID}{one.orcid}" if one.orcid else f"#creator-{number}"
        person = crate.add(Person(crate, identifier, {"name": one.name}))
        if one.affiliation:
            person["affiliation"] = places[one.affiliation]
        people.append(person)
    return people
