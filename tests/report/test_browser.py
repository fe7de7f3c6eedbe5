"""The page in a browser: drawn, quiet, alone, for everybody; skipped where there is no Chromium."""

import csv
import shutil
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from axe_playwright_python.sync_playwright import Axe
from playwright.sync_api import Browser, Page, sync_playwright

from octsim.datasets.files import read

CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser")
LOOKS: dict[str, dict[str, Any]] = {
    "light": {"viewport": {"width": 1200, "height": 900}},
    "dark": {"viewport": {"width": 1200, "height": 900}, "color_scheme": "dark"},
    "phone": {"viewport": {"width": 390, "height": 844}, "device_scale_factor": 2},
}
CHARTS = ["slope", "spectrum", "ascan", "image", "trace-0"]
# of what has a hue: the pixels of lines, bands and images, not those of axes, grid and text
COLOURED = """canvas => {
    const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
    let count = 0;
    for (let i = 0; i < data.length; i += 4) {
        const most = Math.max(data[i], data[i + 1], data[i + 2]);
        const least = Math.min(data[i], data[i + 1], data[i + 2]);
        count += data[i + 3] > 40 && most - least > 60;
    }
    return count;
}"""

pytestmark = pytest.mark.skipif(CHROMIUM is None, reason="there is no chromium on the path")


class Seen:
    """A page, and what it said and asked for while it was open."""

    def __init__(self, page: Page) -> None:
        self.page = page
        self.said: list[str] = []
        self.asked: list[str] = []
        page.on("console", lambda one: self.said.append(one.text))
        page.on("pageerror", lambda one: self.said.append(str(one)))
        page.on("request", lambda one: self.asked.append(one.url))


@pytest.fixture(scope="module")
def browser() -> Iterator[Browser]:
    with sync_playwright() as playwright:
        launched = playwright.chromium.launch(
            executable_path=CHROMIUM, args=["--no-sandbox", "--disable-gpu"]
        )
        yield launched
        launched.close()


@pytest.fixture(params=LOOKS)
def seen(request: pytest.FixtureRequest, browser: Browser, full: Path) -> Iterator[Seen]:
    context = browser.new_context(**LOOKS[request.param])
    opened = Seen(context.new_page())
    opened.page.goto((full / "report.html").as_uri())
    yield opened
    context.close()


def coloured(page: Page) -> dict[str, int]:
    return {
        name: page.eval_on_selector(f"#{name}-plot canvas", COLOURED)
        for name in CHARTS
        if page.query_selector(f"#{name}-plot canvas")
    }


def test_every_chart_is_drawn_and_nothing_else_is_asked_for(seen: Seen, full: Path) -> None:
    found = coloured(seen.page)
    assert list(found) == CHARTS
    assert len(seen.page.query_selector_all("canvas")) == len(CHARTS)
    assert min(found.values()) > 300, found
    assert seen.said == []
    assert seen.asked == [(full / "report.html").as_uri()]


def test_nobody_meets_a_barrier(seen: Seen) -> None:
    for one in seen.page.query_selector_all("summary"):
        one.click()
    result = Axe().run(seen.page)
    assert result.violations_count == 0, result.generate_report()


def test_nothing_is_wider_than_the_window(seen: Seen) -> None:
    assert seen.page.evaluate(
        "document.documentElement.scrollWidth <= document.documentElement.clientWidth"
    )


def test_the_keyboard_moves_the_diameter_and_its_numbers(seen: Seen, full: Path) -> None:
    slopes = read(full / "phase_slope.nc")
    paths = read(full / "paths.nc")
    page, middle = seen.page, slopes.sizes["diameter"] // 2
    before = page.eval_on_selector("#spectrum-plot canvas", "one => one.toDataURL()")
    page.focus("#diameter")
    for step, key in enumerate(["ArrowRight", "ArrowRight", "ArrowLeft"]):
        page.keyboard.press(key)
        one = slopes.isel(diameter=middle + [1, 2, 1][step])
        assert page.text_content("#chosen") == f"{float(one['diameter']):.4f} µm"
        readout = page.text_content("#readout") or ""
        assert f"Phase slope{float(one['phase_slope']):.3f} mrad/nm" in readout
        share = float(paths["share"].transpose("path", "diameter")[0, middle + [1, 2, 1][step]])
        shown = page.text_content("#paths-body td") or ""
        assert float(shown.removesuffix(" %").replace("−", "-")) == pytest.approx(
            100 * share, rel=5e-3
        )
    assert page.eval_on_selector("#spectrum-plot canvas", "one => one.toDataURL()") != before
    page.keyboard.press("Home")
    assert page.text_content("#chosen") == f"{float(slopes['diameter'][0]):.4f} µm"
    assert seen.said == []


@pytest.mark.parametrize("name", ["slope", "image"])
def test_a_click_in_a_chart_chooses_the_diameter_there(name: str, seen: Seen, full: Path) -> None:
    last = float(read(full / "phase_slope.nc")["diameter"][-1])
    over = seen.page.locator(f"#{name}-plot .u-over")
    box = over.bounding_box()
    assert box is not None
    place = {"x": box["width"] - 2, "y": 2}
    over.click(position=place)  # type: ignore[arg-type]
    assert seen.page.text_content("#chosen") == f"{last:.4f} µm"


def test_files_hold_the_datasets_values(seen: Seen, full: Path, tmp_path: Path) -> None:
    def downloaded(name: str) -> Path:
        with seen.page.expect_download() as started:
            seen.page.click(f'button[data-file="{name}"]')
        assert started.value.suggested_filename == name
        started.value.save_as(tmp_path / name)
        return tmp_path / name

    def table(name: str) -> np.ndarray[Any, Any]:
        with downloaded(name).open(encoding="utf-8", newline="") as stream:
            heads, *rows = csv.reader(stream)
        assert {len(row) for row in rows} == {len(heads)}
        return np.array([[float(cell or "nan") for cell in row] for row in rows]).T

    slopes, spectra = read(full / "phase_slope.nc"), read(full / "spectra.nc")
    names = ("diameter", "phase_slope", "ideal_phase_slope", "exact_phase_slope")
    np.testing.assert_array_equal(table("phase_slope.csv"), [slopes[name] for name in names])
    k, *found = table("spectra.csv")
    np.testing.assert_array_equal(k, spectra["wavenumber"])
    np.testing.assert_allclose(found, spectra["intensity"], rtol=1e-6)
    middle = spectra["intensity"].values[spectra.sizes["diameter"] // 2]
    np.testing.assert_allclose(table("spectrum.csv")[1], middle, rtol=1e-6)
    assert table("a_scan.csv")[1].max() == 0
    shares = read(full / "paths.nc")["share"].transpose("path", "diameter").values
    np.testing.assert_allclose(table("light_paths.csv")[1], shares[0], rtol=1e-6)
    np.testing.assert_array_equal(table("trace_0.csv")[1], read(full / "expansion.nc")["expansion"])
    assert "run: looked" in downloaded("config.yaml").read_text("utf-8")


def test_a_page_is_printed_in_the_colours_of_paper(browser: Browser, full: Path) -> None:
    context = browser.new_context(**LOOKS["dark"])
    page = context.new_page()
    page.goto((full / "report.html").as_uri())
    # of the slope's line, by day and by night
    look = """([x, y, z]) => {
        const canvas = document.querySelector("#spectrum-plot canvas");
        const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
        let count = 0;
        for (let i = 0; i < data.length; i += 4)
            count += data[i] === x && data[i + 1] === y && data[i + 2] === z && data[i + 3] === 255;
        return count;
    }"""
    paper, night = [0x00, 0x72, 0xB2], [0x6C, 0xBD, 0xF0]
    assert page.evaluate(look, paper) == 0 < page.evaluate(look, night)
    page.evaluate("window.dispatchEvent(new Event('beforeprint'))")
    assert page.evaluate(look, night) == 0 < page.evaluate(look, paper)
    page.evaluate("window.dispatchEvent(new Event('afterprint'))")
    assert page.evaluate(look, paper) == 0 < page.evaluate(look, night)
    context.close()
