"""What a report says of itself: config, versions, warnings, and how to cite."""

from collections.abc import Iterator
from importlib.metadata import version

import yaml

from octsim.archive.compare_origins import config_changes
from octsim.archive.contents import title_of
from octsim.archive.origin import origin_of
from octsim.config.archive import ArchiveConfig
from octsim.config.grid import remarks
from octsim.config.models import Config
from octsim.config.told import told
from octsim.datasets.catalog import CATALOG
from octsim.report.markup import Html, details, element, joined, table
from octsim.report.shown import Shown

_LETTERS = 200
"""Of a value of the config in a table: one may be the wavelengths of thousands of pixels."""


def about(shown: Shown, given: ArchiveConfig) -> Html:
    """Return the sections on config, versions, warnings and citation.

    Parameters
    ----------
    shown : Shown
        The run.
    given : ArchiveConfig
        Who made the data, under which licence.
    """
    return joined(_warnings(shown), _config(shown), _versions(shown), _cite(shown, given))


def _shortened(text: str) -> str:
    return text if len(text) <= _LETTERS else f"{text[: _LETTERS - 1]}…"


def _said(shown: Shown) -> Iterator[str]:
    """Return what a user should know of a run, a line each, as its jobs said it."""
    yield from remarks(shown.config)
    for name, dataset in shown.datasets.items():
        yield from CATALOG[name].doubts_of(dataset)


def _warnings(shown: Shown) -> Html:
    lines = [element("li", line) for line in dict.fromkeys(_said(shown))]
    listed = element("ul", *lines, class_="doubts") if lines else element("p", "There are none.")
    return element("section", element("h2", "Warnings"), listed, id="warnings")


def _config(shown: Shown) -> Html:
    text = yaml.safe_dump(shown.run.config.to_record(), sort_keys=False, allow_unicode=True)
    changes = config_changes(Config(), shown.run.config)
    rows: list[list[object]] = [
        [one.what, _shortened(one.first), _shortened(one.second)] for one in changes
    ]
    differs = (
        table("Keys that differ from the default, the thesis", ["Key", "Default", "Here"], rows)
        if rows
        else element("p", "Every key has its default: this is the thesis.")
    )
    told_lines = [element("p", f"{line}.") for line in told(shown.config)]
    whole = element("pre", text, id="config-text", tabindex=0, role="region", aria_label="Config")
    button = element("button", "config.yaml", type="button", data_file="config.yaml", class_="save")
    return element(
        "section", element("h2", "Config"), *told_lines, differs,
        details("The whole config", whole), element("p", button, class_="saves"), id="config",
    )  # fmt: skip


def _versions(shown: Shown) -> Html:
    origins = {name: origin_of(dataset.attrs) for name, dataset in shown.datasets.items()}
    titles = {name: str(one.attrs.get("title", "")) for name, one in shown.datasets.items()}
    rows: list[list[object]] = [
        [f"{name}.nc", titles[name], one.octsim_version, one.source_digest]
        for name, one in origins.items()
    ]
    made = table(
        "Datasets shown here", ["File", "What it holds", "octsim", "Digest of its code"], rows
    )
    environments = list(dict.fromkeys(
        ", ".join(f"{key} {value}" for key, value in (one.environment or {}).items())
        for one in origins.values()
    ))  # fmt: skip
    said = [element("p", f"Computed with {one}.") for one in environments if one]
    page = element("p", f"This page was made by octsim {version('octsim')}.")
    return element("section", element("h2", "Versions"), made, *said, page, id="versions")


def _cite(shown: Shown, given: ArchiveConfig) -> Html:
    title, year = title_of(shown.run.config), (given.date or "")[:4]
    people = "; ".join(one.name for one in given.creators)
    versions = sorted({origin_of(one.attrs).octsim_version for one in shown.datasets.values()})
    software = (
        f"The octsim developers. octsim: ray tracing of optical coherence tomography of a neuron, "
        f"version {' and '.join(versions) or version('octsim')}. MIT licence."
    )
    data = ". ".join(filter(None, (people, year, given.title or title, "Data set", given.license)))
    lacking = (
        [] if given.creators else [element(
            "p", "Give ", element("code", "archive.creators"),
            " in the config to have the data cited with the names of those who made it.",
        )]
    )  # fmt: skip
    return element(
        "section", element("h2", "How to cite"), element("p", software),
        element("p", f"{data}."), *lacking, id="cite",
    )  # fmt: skip
