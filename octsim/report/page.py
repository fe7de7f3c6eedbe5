"""A run as one HTML file, which needs nothing beside it and asks nothing of the network."""

import base64
import hashlib
from importlib.resources import files
from pathlib import Path
from string import Template
from typing import NamedTuple

from octsim.archive.contents import title_of
from octsim.archive.report_file import MADE_FROM, REPORT, datasets_digest
from octsim.archive.run_folder import run_in
from octsim.base.errors import DatasetError
from octsim.base.files import whole
from octsim.config.archive import ArchiveConfig
from octsim.report.about import about
from octsim.report.answer import answer
from octsim.report.charts import charts
from octsim.report.markup import Html, data_script, details, element, escaped, joined, table
from octsim.report.picture import scene
from octsim.report.plots import values_of
from octsim.report.shown import Shown, compared, shown_of
from octsim.report.trust import trust
from octsim.report.words import signed

_ASSETS = files("octsim.report") / "assets"
_SCRIPTS = ("uplot/uPlot.iife.min.js", "charts.js", "page.js")


class Written(NamedTuple):
    """A report that was written."""

    file: Path
    bytes: int
    combination: str
    """What is shown of a grid; empty without one."""

    def __str__(self) -> str:
        shown = f", which shows {self.combination}" if self.combination else ""
        return f"{self.file}: {self.bytes / 1e6:.2f} MB{shown}"


def report(
    folder: Path, file: Path | None = None, combination: int = 1, given: ArchiveConfig | None = None
) -> Written:
    """Write the report of a run; the same datasets give the same bytes.

    Parameters
    ----------
    folder : path
        The run's, ``results/<run>/``.
    file : path, optional
        To write, replaced whole; ``<folder>/report.html`` without one.
    combination : int
        Of a grid, which is shown, from 1.
    given : ArchiveConfig, optional
        Who made the data and under which licence; without it the config's defaults.

    Raises
    ------
    DatasetError
        If there are no datasets that a report shows, or one can't be read.
    FileError
        If the page can't be written; what stood there before is still there.
    """
    run = run_in(folder)
    shown = shown_of(run, combination)
    if not shown.datasets:
        raise DatasetError(
            f"{folder}: no dataset that a report shows, only "
            f"{', '.join(f'{name}.nc' for name in run.datasets)}; run to spectra.nc at least"
        )
    text = page(shown, given or ArchiveConfig(), datasets_digest(run))
    file = file or folder / REPORT
    with whole(file) as temporary:
        temporary.write_text(text, encoding="utf-8")
    return Written(file, len(text.encode()), shown.combination)


def page(shown: Shown, given: ArchiveConfig, digest: str) -> str:
    """Return the page of a run as text.

    Parameters
    ----------
    shown : Shown
        What is shown.
    given : ArchiveConfig
        Who made the data.
    digest : str
        Of the datasets that are shown, by which an archive knows the page as theirs.
    """
    values = values_of(shown)
    scripts = [_asset(name) for name in _SCRIPTS]
    title = given.title or title_of(shown.run.config)
    main = joined(
        _of_grid(shown), answer(shown), trust(shown), scene(shown), charts(values),
        about(shown, given), _licence(),
    )  # fmt: skip
    return Template(_asset("page.html")).substitute(
        title=escaped(title),
        policy=_policy(scripts),
        made_from=MADE_FROM,
        digest=escaped(digest),
        styles=f"{_asset('uplot/uPlot.min.css')}\n{_asset('page.css')}",
        main=main,
        data=data_script("values", values),
        scripts="\n".join(f"<script>{one}</script>" for one in scripts),
    )


def _asset(name: str) -> str:
    return _ASSETS.joinpath(*name.split("/")).read_text("utf-8")


def _policy(scripts: list[str]) -> str:
    """Return the page's content security policy: these scripts, nothing from elsewhere."""
    digests = (base64.b64encode(hashlib.sha256(one.encode()).digest()).decode() for one in scripts)
    allowed = " ".join(f"'sha256-{one}'" for one in digests)
    return (
        f"default-src 'none'; script-src {allowed}; style-src 'unsafe-inline'; img-src data:; "
        "base-uri 'none'; form-action 'none'"
    )


def _of_grid(shown: Shown) -> Html:
    """Say which combination of a grid is shown, and what the others came to."""
    if not shown.combination:
        return Html()
    said = element(
        "p", f"Combination {shown.number} of {shown.combinations} is shown: {shown.combination}. "
        "Another is by ", element("code", "octsim report --combination"), " and its number.",
    )  # fmt: skip
    rows: list[list[object]] = [
        [str(number), name, signed(mean), signed(scatter)]
        for number, name, mean, scatter in compared(shown.run)
    ]
    heads = ["Number", "Combination", "Mean phase slope (mrad/nm)", "Scatter (mrad/nm)"]
    listed = (
        details("The combinations", table("Combinations of the grid", heads, rows)) if rows else ""
    )
    return element("section", element("h2", "One of a grid"), said, listed, id="grid")


def _licence() -> Html:
    text = _asset("uplot/LICENSE")
    return element(
        "section", details(
            "Licence of the charts' library", element("p", "Charts are drawn by uPlot."),
            element("pre", text, tabindex=0, role="region", aria_label="Licence of uPlot"),
        ), id="licences",
    )  # fmt: skip
