"""The metadata of an archive: a Process Run Crate, and a word where its library is missing."""

import json
import re
import sys
from collections.abc import Callable
from typing import Any

import pytest

from octsim.archive.contents import CONFIG, Item
from octsim.archive.origin import Origin
from octsim.archive.ro_crate import PROFILE, metadata
from octsim.base.errors import OctsimError
from octsim.config.load import load_config
from octsim.config.models import Config

DIGESTS = {"spectra.nc": "a" * 64, "phase_slope.nc": "b" * 64, CONFIG: "c" * 64}
GIVEN = {"archive": {"creators": [{"name": "Ada Ray", "orcid": "0000-0002-1825-0097"}]}}
Graph = dict[str, dict[str, Any]]


def told(config: Config, versions: tuple[str, str] = ("0.3.0", "0.3.0")) -> dict[str, Any]:
    """Return the metadata of two datasets, made by octsim of some versions."""
    items = [
        Item(name, "a dataset", b"", "application/x-netcdf", origin=Origin(version, 2, "d", None))
        for name, version in zip(("spectra.nc", "phase_slope.nc"), versions, strict=True)
    ]
    items.append(Item(CONFIG, "config of the run", b"", "application/yaml"))
    said: dict[str, Any] = json.loads(metadata(config, items, dict.fromkeys(DIGESTS, 1), DIGESTS))
    return said


def graph_of(said: dict[str, Any]) -> Graph:
    return {one["@id"]: one for one in said["@graph"]}


def listed(value: Any) -> list[Any]:
    return value if isinstance(value, list) else [value]


def of_type(graph: Graph, kind: str) -> list[dict[str, Any]]:
    return [one for one in graph.values() if kind in listed(one["@type"])]


def refers(graph: Graph, value: Any, *kinds: str) -> bool:
    """Whether a value is references, each to an entity of one of some types."""
    return bool(listed(value)) and all(
        any(kind in listed(graph[one["@id"]]["@type"]) for kind in kinds) for one in listed(value)
    )


REQUIRED: dict[tuple[str, str], Callable[[Graph, Any], object]] = {
    # what the profile asks of each property, MUST first: (type, property): check
    ("Dataset", "conformsTo"): lambda graph, value: (
        value == {"@id": PROFILE} and refers(graph, value, "CreativeWork")
    ),
    ("SoftwareApplication", "@id"): lambda _, value: bool(value),
    ("CreateAction", "@id"): lambda _, value: re.fullmatch(r"urn:uuid:[0-9a-f-]{36}", value),
    ("CreateAction", "instrument"): lambda graph, value: refers(
        graph, value, "SoftwareApplication"
    ),
    # SHOULD
    ("Dataset", "mentions"): lambda graph, value: refers(graph, value, "CreateAction"),
    ("SoftwareApplication", "name"): lambda _, value: value == "octsim",
    ("SoftwareApplication", "softwareVersion"): lambda _, value: re.match(r"\d+\.\d+", value),
    ("CreateAction", "name"): lambda _, value: "computes the datasets" in value,
    ("CreateAction", "description"): lambda _, value: value == f"octsim run {CONFIG}",
    ("CreateAction", "agent"): lambda graph, value: refers(graph, value, "Person", "Organization"),
    ("CreateAction", "object"): lambda graph, value: refers(graph, value, "File"),
    ("CreateAction", "result"): lambda graph, value: refers(graph, value, "File"),
    # MAY
    ("CreateAction", "actionStatus"): lambda _, value: (
        value == {"@id": "http://schema.org/CompletedActionStatus"}
    ),
}


@pytest.mark.parametrize(("kind", "key"), REQUIRED, ids=lambda one: str(one))
@pytest.mark.parametrize("versions", [("0.3.0", "0.3.0"), ("0.3.0", "0.2.0")])
def test_what_the_profile_asks_for_is_there(kind: str, key: str, versions: tuple[str, str]) -> None:
    graph = graph_of(told(load_config(GIVEN), versions))
    entities = of_type(graph, kind)
    assert len(entities) == (1 if kind == "Dataset" else len(set(versions)))
    for one in entities:
        assert REQUIRED[kind, key](graph, one[key]), one


def test_the_crate_is_of_the_version_that_the_profile_extends() -> None:
    said = told(Config())
    graph = graph_of(said)
    assert graph["ro-crate-metadata.json"]["conformsTo"] == {"@id": "https://w3id.org/ro/crate/1.1"}
    context, terms = said["@context"]
    assert context == "https://w3id.org/ro/crate/1.1/context"
    assert terms == {"sha256": "http://schema.org/sha256"}
    assert graph[PROFILE]["version"] == PROFILE.rpartition("/")[2]


def test_each_dataset_is_the_result_of_the_version_that_made_it() -> None:
    graph = graph_of(told(Config(), ("0.3.0", "0.2.0")))
    made = {
        graph[one["instrument"]["@id"]]["softwareVersion"]: listed(one["result"])
        for one in of_type(graph, "CreateAction")
    }
    assert made == {"0.3.0": [{"@id": "spectra.nc"}], "0.2.0": [{"@id": "phase_slope.nc"}]}


def test_nobody_is_named_as_agent_where_nobody_is_given() -> None:
    for one in of_type(graph_of(told(Config())), "CreateAction"):
        assert "agent" not in one


def test_an_execution_is_told_by_its_results(monkeypatch: pytest.MonkeyPatch) -> None:
    def execution() -> str:
        (one,) = of_type(graph_of(told(Config())), "CreateAction")
        return str(one["@id"])

    first = execution()
    assert execution() == first
    monkeypatch.setitem(DIGESTS, "spectra.nc", "e" * 64)
    assert execution() != first


def test_a_lack_of_rocrate_is_one_line_with_the_remedy(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "rocrate.rocrate", None)
    with pytest.raises(OctsimError) as caught:
        metadata(Config(), [], {}, {})
    remedy = "pip install 'octsim[archive]'"
    assert str(caught.value) == f"rocrate is not installed; run: {remedy}"
