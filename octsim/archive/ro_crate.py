"""What an archive says of itself to machines: RO-Crate metadata, as data repositories read it."""

import datetime as dt
import json
import os
from collections.abc import Mapping, Sequence
from typing import Any

from octsim.archive.checksums import SUMS
from octsim.archive.contents import CONFIG, Item, Made
from octsim.base.errors import ArchiveError, not_installed
from octsim.config.archive import ArchiveConfig

METADATA = "ro-crate-metadata.json"
_VERSION = "1.2"
_EPOCH = "SOURCE_DATE_EPOCH"
NO_DAY = "1980-01-01"
"""Of publication, where none is given: the day that the zip has of every file."""
_DESCRIPTION = (
    "Simulated optical coherence tomography of a neuron: by ray tracing, from a microscope "
    "objective and a cylinder on a glass slide to the phase slope, the change of phase with "
    "diameter."
)


def title_of(given: ArchiveConfig, run: str) -> str:
    """Give the title of a run's archive."""
    return given.title or f"octsim run {run}"


def description_of(given: ArchiveConfig) -> str:
    """Give the description of a run's archive."""
    return given.description or _DESCRIPTION


def day_of(given: ArchiveConfig) -> str:
    """Give the day of publication; never that of the clock, so that archives are the same bytes.

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


def remarks(given: ArchiveConfig) -> list[str]:
    """Say what a data repository will ask for, a line each."""
    said = []
    if not given.date and not os.environ.get(_EPOCH):
        said.append(f"archive.date: not given, so {NO_DAY} stands as the day of publication")
    if not given.creators:
        said.append("archive.creators: not given, so the archive names nobody as who made the data")
    return said


def metadata(
    run: str,
    given: ArchiveConfig,
    items: Sequence[Item],
    made: Mapping[str, Made],
    measured: Mapping[str, tuple[int, str]],
) -> bytes:
    """Write the metadata of an archive.

    Parameters
    ----------
    run : str
        Name of the run.
    given : ArchiveConfig
        What a user says of it.
    items : sequence of Item
        Files of the archive.
    made : mapping
        How each stage's dataset was made.
    measured : mapping
        Size in bytes and SHA-256 of each file.
    """
    try:
        from rocrate.model.contextentity import ContextEntity
        from rocrate.model.softwareapplication import SoftwareApplication
        from rocrate.rocrate import ROCrate
    except ImportError:
        raise not_installed("rocrate", "archive") from None

    crate = ROCrate(version=_VERSION)
    root = crate.root_dataset
    root["name"], root["description"] = title_of(given, run), description_of(given)
    root["datePublished"] = day_of(given)
    license_ = f"https://spdx.org/licenses/{given.license}"
    named = {"@type": "CreativeWork", "name": given.license, "identifier": given.license}
    root["license"] = crate.add(ContextEntity(crate, license_, named))
    if given.creators:
        root["creator"] = _creators(crate, given)
    files: dict[str, Any] = {}
    for item in sorted(items, key=lambda item: item.name):
        size, digest = measured[item.name]
        said: dict[str, Any] = {
            "name": item.about, "encodingFormat": item.form,
            "contentSize": str(size), "sha256": digest,
        }  # fmt: skip
        if item.variables:
            said["description"], said["variableMeasured"] = item.about, list(item.variables)
        files[item.name] = crate.add_file(dest_path=item.name, properties=said)
    for item in items:
        if item.stages:
            files[item.name]["isBasedOn"] = [files[f"{stage}.nc"] for stage in item.stages]
    said = {"name": "SHA-256 of every file but itself", "encodingFormat": "text/plain"}
    crate.add_file(dest_path=SUMS, properties=said)
    given_to = [files[CONFIG]]
    for version in sorted({one.octsim_version for one in made.values()}):
        said = {"name": "octsim", "softwareVersion": version}
        octsim = crate.add(SoftwareApplication(crate, f"#octsim-{version}", said))
        results = [files[f"{stage}.nc"] for stage in made if made[stage].octsim_version == version]
        said = {"name": f"octsim {version} computes the datasets of the run {run}"}
        action = crate.add_action(octsim, f"#run-{version}", given_to, results, said)
        action["actionStatus"] = {"@id": "http://schema.org/CompletedActionStatus"}
    graph = crate.metadata.generate()
    graph["@graph"].sort(key=lambda entity: str(entity["@id"]))
    return (json.dumps(graph, indent=2, sort_keys=True, ensure_ascii=False) + "\n").encode()


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
        identifier = f"https://orcid.org/{one.orcid}" if one.orcid else f"#creator-{number}"
        person = crate.add(Person(crate, identifier, {"name": one.name}))
        if one.affiliation:
            person["affiliation"] = places[one.affiliation]
        people.append(person)
    return people
