"""The code that a dataset or a figure follows from, as digests: an edit of it makes them anew."""

from collections.abc import Iterator

from octsim.base.provenance import source_digest
from octsim.config.grid import combinations
from octsim.config.models import Config
from octsim.config.scheme import scheme_of
from octsim.datasets.catalog import CATALOG, LIGHT, SUMMING, Figure
from octsim.schemes.table import COUNTED_RAYS, SCHEMES

NO_RESULT = ("octsim.config.archive", "octsim.instrument.points", "octsim.instrument.point_store")
"""Modules that no number follows from, though what makes datasets imports them."""


def code_of(stage: str, config: Config) -> str:
    """Digest the sources that make a dataset: its own module's, and those of its schemes."""
    return source_digest(CATALOG[stage].module, *_schemes(stage, config), without=NO_RESULT)


def figures_code(*figures: Figure) -> str:
    """Digest the sources that draw some figures."""
    modules = dict.fromkeys(figure.draw.partition(":")[0] for figure in figures)
    return source_digest("octsim.figures.draw", *modules, without=NO_RESULT)


def _schemes(stage: str, config: Config) -> Iterator[str]:
    """Return the modules of the schemes that a dataset's numbers are found by."""
    row = CATALOG[stage]
    if row.beside:
        yield from (scheme.module for scheme in SCHEMES.values())
    elif {LIGHT, SUMMING} & set(row.reads):
        for at in combinations(config, "tracing.scheme", "tracing.preset"):
            yield scheme_of(at.config).module
        if set(COUNTED_RAYS.keys) <= set(row.reads):
            yield COUNTED_RAYS.module
