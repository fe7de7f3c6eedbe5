"""The file of a run's report: its name, and which datasets it says that it was made from."""

import hashlib
import re
from pathlib import Path
from typing import TYPE_CHECKING

from octsim.base.carried import PACKAGE
from octsim.base.files import digest_of
from octsim.base.provenance import source_digest

if TYPE_CHECKING:
    # the workflow asks for the code of a report, and needs no datasets for that
    from octsim.archive.run_folder import Run

REPORT = "report.html"
"""Name of a run's report, in the run's folder and in its archive."""
MADE_FROM = "octsim-datasets"
"""Name of the page's metadata that holds the digest of what it was made from."""
SHOWN = (
    "gaussian_fits", "focus_law", "spectra", "paths", "fourier", "phase_slope", "validity",
    "calibration", "effects", "expansion",
)  # fmt: skip
"""Datasets that a report shows, as far as they are there."""
_HEAD = 20_000  # letters in which the metadata stands
_RECORDED = re.compile(rf'<meta name="{MADE_FROM}" content="([0-9a-f]{{64}})">')


def report_code() -> str:
    """Digest what makes a report: its modules, and what they put into the page as it is."""
    assets = sorted(file for file in (PACKAGE / "report" / "assets").rglob("*") if file.is_file())
    lines = [source_digest("octsim.report.page"), *map(digest_of, assets)]
    return hashlib.sha256("\n".join(lines).encode()).hexdigest()[:12]


def datasets_digest(run: "Run") -> str:
    """Return a digest of the datasets of a run that its report shows: of what is in their files."""
    shown = (name for name in SHOWN if name in run.datasets)
    lines = "".join(f"{name} {digest_of(run.datasets[name])}\n" for name in shown)
    return hashlib.sha256(lines.encode()).hexdigest()


def is_report_of(file: Path, run: "Run") -> bool:
    """Return whether a file is a report that was made from a run's datasets as they are now."""
    with file.open(encoding="utf-8", errors="replace") as stream:
        found = _RECORDED.search(stream.read(_HEAD))
    return found is not None and found[1] == datasets_digest(run)
