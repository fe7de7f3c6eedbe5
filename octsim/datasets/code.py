"""The code that a dataset or a figure follows from, as digests: an edit of it makes them anew."""

import hashlib
from collections.abc import Iterator

from octsim.base.provenance import source_digest
from octsim.config.grid import combinations
from octsim.config.models import Config
from octsim.config.scheme import scheme_of
from octsim.datasets.catalog import CATALOG
from octsim.datasets.stage import LIGHT, RAYS, SUMMING, Figure
from octsim.schemes.table import COUNTED_RAYS, LIGHT_PATHS, SCHEMES

NO_RESULT = (
    "octsim.config.archive", "octsim.datasets.catalog", "octsim.datasets.catalog_of_neurons",
    "octsim.datasets.catalog_of_thesis",
    "octsim.datasets.gallery",
    "octsim.datasets.stage",
    "octsim.instrument.point_store", "octsim.instrument.points", "octsim.schemes.cost",
    "octsim.schemes.table",
)  # fmt: skip
"""Modules that no number follows from, though what makes datasets imports them."""


def code_of(stage: str, config: Config) -> str:
    """Digest the sources that make a dataset: its own module's, and those of its schemes."""
    made_by = CATALOG[stage].module, "octsim.datasets.writer", *_schemes(stage, config)
    return source_digest(*made_by, without=NO_RESULT)


def figures_code(*figures: Figure) -> str:
    """Digest the sources that draw some figures, and what their captions say."""
    modules = dict.fromkeys(figure.draw.partition(":")[0] for figure in figures)
    code = source_digest("octsim.figures.draw", *modules, without=NO_RESULT)
    captions = "\n".join(figure.caption for figure in figures)
    return f"{code} {hashlib.sha256(captions.encode()).hexdigest()[:12]}"


def _schemes(stage: str, config: Config) -> Iterator[str]:
    """Return the modules of the schemes that a dataset's numbers are found by."""
    row = CATALOG[stage]
    if row.beside and row.needs_light:
        yield from (scheme.module for scheme in SCHEMES.values())
    elif ("processing" in row.reads and _compares_with_a_model(config)) or RAYS in row.reads:
        yield LIGHT_PATHS.module
    elif {LIGHT, SUMMING} & set(row.reads):
        for at in combinations(config, "tracing.scheme", "tracing.preset"):
            yield scheme_of(at.config).module
        if row.counts_rays:
            yield COUNTED_RAYS.module


def _compares_with_a_model(config: Config) -> bool:
    """Return whether an estimator of some combination looks at modelled spectra."""
    every = combinations(config, "processing.estimator")
    return any(at.config.processing.estimator == "maximum_likelihood" for at in every)
