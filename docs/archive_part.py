"""What the thesis's archive comes to: a part of docs/archives.md, written from a run of it."""

import re
import shutil
import tempfile
from pathlib import Path

from octsim.archive.pack import pack
from octsim.archive.run_folder import FIGURES, run_in
from octsim.config.models import Config
from octsim.datasets.gallery import figures_of
from octsim.datasets.keys import stages_of

_PART = re.compile(r"(<!-- size: begin -->\n).*?(<!-- size: end -->)", flags=re.DOTALL)


def archive_part(page: str, results: Path) -> str:
    """Return the page with the size of a run's archive, without what targets beside it made.

    Raises
    ------
    ValueError
        If the page has no place for it.
    """
    config = run_in(results).config
    with tempfile.TemporaryDirectory() as place:
        alone = Path(place) / results.name
        (alone / FIGURES).mkdir(parents=True)
        for stage in stages_of(config):
            shutil.copy(results / f"{stage}.nc", alone)
        for name in figures_of(config):
            for file in (results / FIGURES).glob(f"{name}.*"):
                shutil.copy(file, alone / FIGURES)
        if (report := results / "report.html").exists():
            shutil.copy(report, alone)
        packed = pack(alone, Config.model_validate(config.to_dict()))
    size = f"{packed.bytes / 1e6:.1f} MB, of {packed.files} files"
    said = f"The thesis's, without targets beside it, is {size}.\n"
    text, parts = _PART.subn(lambda found: f"{found[1]}{said}{found[2]}", page)
    if not parts:
        raise ValueError("docs/archives.md: no lines that begin and end the size; put them back")
    return text
