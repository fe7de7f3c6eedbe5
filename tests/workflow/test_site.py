"""The docs as a site: built without a warning, and nothing in it asks the network."""

import re
import subprocess
import sys
from pathlib import Path

import pytest

import octsim

DOCS = Path(__file__).parents[2] / "docs"
# what a browser fetches by itself, unlike a link
FETCHED = re.compile(
    r"<(?:script|img|iframe|source)\b[^>]*\bsrc=\"(?:https?:)?//"
    r"|<link\b[^>]*\bhref=\"(?:https?:)?//"
)


def build(folder: Path, *options: str) -> Path:
    """Build it as `make site` does, in another folder."""
    built = folder / "_site"  # notebooks are executed beside it
    command = [sys.executable, "-m", "sphinx", "-q", "-W", "--keep-going", *options]
    done = subprocess.run([*command, DOCS, built], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    return built


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Build it but for what notebooks put out; tests of notebooks execute them."""
    unexecuted = ("nb_execution_mode=off", "suppress_warnings=myst-nb.lexer")
    return build(tmp_path_factory.mktemp("site"), *(f"-D{one}" for one in unexecuted))


def test_every_page_is_in_the_site(site: Path) -> None:
    for page in DOCS.glob("*.md"):
        assert (site / f"{page.stem}.html").is_file(), page.name


def test_every_public_name_has_a_page_with_its_example(site: Path) -> None:
    for name in vars(octsim)["__all__"]:
        text = (site / "api" / f"octsim.{name}.html").read_text(encoding="utf-8")
        assert ">Examples<" in text, name
        assert "object&gt;" not in text, name


def test_formulas_are_drawn_without_a_script(site: Path) -> None:
    text = (site / "equations.html").read_text(encoding="utf-8")
    assert text.count("<math ") > 20
    assert "munderover" not in text


@pytest.mark.trial
def test_notebooks_show_what_their_cells_put_out(tmp_path: Path) -> None:
    site = build(tmp_path)
    for name, pictures in {"slope": 2, "maxwell": 2, "lab": 1}.items():
        text = (site / f"notebook-{name}.html").read_text(encoding="utf-8")
        assert text.count("_images/") >= pictures
        assert re.search(r'class="output [^>]*>.*?[0-9.]+ mrad', text, flags=re.DOTALL)
        assert "Traceback" not in text


def test_no_page_fetches_anything_from_elsewhere(site: Path) -> None:
    pages = list(site.rglob("*.html"))
    assert len(pages) > 60
    for page in pages:
        assert not FETCHED.findall(page.read_text(encoding="utf-8")), page.name
    for style in site.rglob("*.css"):
        said = style.read_text(encoding="utf-8")
        assert not re.search(r"url\([\"']?(?:https?:)?//|@import [\"']?(?:https?:)?//", said), style
