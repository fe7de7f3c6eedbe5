"""The notebooks of the docs run as they are written, and find what they say."""

import re
import warnings
from pathlib import Path
from typing import Any

import matplotlib as mpl
import pytest

DOCS = Path(__file__).parents[2] / "docs"
CELL = re.compile(r"^```\{code-cell\}[^\n]*\n(.*?)^```$", flags=re.DOTALL | re.MULTILINE)


def cells(page: Path) -> list[str]:
    return CELL.findall(page.read_text(encoding="utf-8"))


NOTEBOOKS = {page.stem: page for page in sorted(DOCS.glob("*.md")) if cells(page)}


def ran(name: str, monkeypatch: pytest.MonkeyPatch, folder: Path) -> dict[str, Any]:
    """Run the cells of a notebook in an empty folder, and return what they leave."""
    monkeypatch.chdir(folder)
    mpl.use("Agg")
    left: dict[str, Any] = {}
    with warnings.catch_warnings():
        # of a backend without windows, which a notebook's own is not
        warnings.filterwarnings("ignore", message="FigureCanvasAgg is non-interactive")
        for cell in cells(NOTEBOOKS[name]):
            exec(cell, left)
    return left


def test_there_are_notebooks_and_none_stores_what_it_put_out() -> None:
    assert set(NOTEBOOKS) == {"notebook-slope", "notebook-maxwell", "notebook-lab"}
    for page in NOTEBOOKS.values():
        text = page.read_text(encoding="utf-8")
        assert text.startswith("---\nfile_format: mystnb\n")
        assert "data:image" not in text
    assert not list(DOCS.glob("*.ipynb"))


def test_the_slope_of_a_config_is_near_that_between_plates(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    left = ran("notebook-slope", monkeypatch, tmp_path)
    assert left["found"] == pytest.approx(left["predicted"], rel=0.03)
    assert left["further"] != left["found"]


def test_rays_and_maxwell_come_closer_as_the_aperture_closes(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    left = ran("notebook-maxwell", monkeypatch, tmp_path)
    apart = abs(left["by_rays"] / left["by_waves"] - 1)
    assert apart[0] < apart[-1] < 0.2
    assert abs(left["by_waves"][0] - left["predicted"]) < abs(
        left["by_waves"][-1] - left["predicted"]
    )


def test_a_made_up_swelling_is_found_to_its_noise(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    left = ran("notebook-lab", monkeypatch, tmp_path)
    assert left["scatter"] < 0.05  # nm
    assert left["found"].max() == pytest.approx(left["truth"].max(), abs=0.1)
