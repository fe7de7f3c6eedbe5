"""The report of a run: one file, of any run, that asks nothing of anybody."""

import re
import shutil
from html.parser import HTMLParser
from pathlib import Path

import pytest
import xarray as xr
from gridded import GRIDS, gridded, run_of_grid
from made_runs import every_stage
from report_runs import SMALL, written

from octsim.base.errors import DatasetError, FileError
from octsim.config.archive import ArchiveConfig, Creator
from octsim.config.load import load_config
from octsim.datasets.files import read, write
from octsim.report.page import report

BAD = "</script><script>alert(1)</script><img src=x onerror=alert(2)>"
SCRIPTS = 3


class Page(HTMLParser):
    """Collects what a test asks of a page."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.elements: list[str] = []
        self.links: list[str] = []
        self.ids: list[str] = []
        self.text = ""
        self._quiet = False
        self.feed(text)
        self.close()

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.elements.append(tag)
        given = dict(attrs)
        self._quiet = tag in ("script", "style")
        for name in ("src", "href", "xlink:href", "action", "srcset", "data", "poster"):
            if given.get(name) is not None:
                self.links.append(str(given[name]))
        if "id" in given:
            self.ids.append(str(given["id"]))

    def handle_endtag(self, tag: str) -> None:
        self._quiet = self._quiet and tag not in ("script", "style")

    def handle_data(self, data: str) -> None:
        self.text += "" if self._quiet else data


def page_of(folder: Path, combination: int = 1) -> Page:
    return Page(report(folder, combination=combination).file.read_text("utf-8"))


@pytest.fixture
def folder(plain: Path, tmp_path: Path) -> Path:
    return Path(shutil.copytree(plain, tmp_path / "whole"))


def test_a_page_has_its_parts_in_the_order_of_what_a_reader_asks(full: Path) -> None:
    page = Page((full / "report.html").read_text("utf-8"))
    parts = ["answer", "trust", "scene", "slope", "spectra", "trace", "warnings", "config",
             "versions", "cite"]  # fmt: skip
    assert [one for one in page.ids if one in parts] == parts
    assert "svg" in page.elements


def test_a_page_asks_nothing_of_the_network(full: Path) -> None:
    file = full / "report.html"
    text = file.read_text("utf-8")
    assert file.stat().st_size < 1.5e6
    links = Page(text).links
    assert links
    assert all(link.startswith(("#", "data:")) for link in links)
    assert not re.search(r"@import|url\(\s*[\"']?(?!#|data:)", text)
    (policy,) = re.findall(r'Content-Security-Policy" content="([^"]*)"', text)
    assert policy.startswith("default-src 'none';")
    assert policy.count("sha256-") == SCRIPTS


def test_the_scene_is_drawn_in_the_colours_of_the_page(full: Path) -> None:
    text = (full / "report.html").read_text("utf-8")
    drawn = text[text.index("<svg") : text.index("</svg>")]
    assert "currentColor" in drawn
    # a background of its own, or ink that is black in the dark
    assert not [one for one in ("#ffffff", "#000000", "#333333") if one in drawn]
    assert ">PT CR PT: " in drawn


def test_the_number_is_the_calibration_s_with_its_error_and_its_diameter(full: Path) -> None:
    table = read(full / "calibration.nc").isel(diameter=4)
    text = Page((full / "report.html").read_text("utf-8")).text
    slope = float(table["fixed_focus_phase_slope"])
    number = re.search(r"([\d.]+) ± ([\d.]+) mrad/nm", text)
    assert number is not None
    places = len(number[1].partition(".")[2])
    assert number[1] == f"{slope:.{places}f}"
    error = float(table["fixed_focus_phase_slope_standard_error"])
    assert float(number[2]) == pytest.approx(error, rel=0.05)
    assert f"at the diameter d = {float(table['diameter']):.4g} µm" in text


def test_without_a_calibration_it_is_the_mean_and_the_command_for_one_is_said(
    plain: Path, stages: dict[str, xr.Dataset]
) -> None:
    text = Page((plain / "report.html").read_text("utf-8")).text
    mean = float(stages["phase_slope"]["mean_phase_slope"])
    number = re.search(r"([\d.]+) ± [\d.]+ mrad/nm", text)
    assert number is not None
    assert float(number[1]) == pytest.approx(mean, abs=0.06)
    for target in ("calibration", "effects", "validity"):
        assert f"snakemake {target} --cores 2 --configfile config.yaml" in text


def test_what_is_measured_of_trust_is_told_and_no_command_is(full: Path) -> None:
    text = Page((full / "report.html").read_text("utf-8")).text
    assert "snakemake" not in text.partition("The scene, to scale")[0]
    assert "falloff cosine" in text
    assert str(read(full / "effects.nc").attrs["sentence"])[1:] in text


def test_the_same_run_is_the_same_bytes(folder: Path, tmp_path: Path) -> None:
    first = report(folder).file.read_bytes()
    assert report(folder, tmp_path / "again.html").file.read_bytes() == first


def test_what_datasets_hold_can_t_become_a_script(folder: Path) -> None:
    spectra = read(folder / "spectra.nc")
    spectra.attrs["title"] = BAD
    write(spectra, folder / "spectra.nc")
    paths = read(folder / "paths.nc")
    write(paths.assign_coords(path=[BAD] * paths.sizes["path"]), folder / "paths.nc")
    given = ArchiveConfig(title=BAD, creators=(Creator(name=BAD),))
    text = report(folder, given=given).file.read_text("utf-8")
    page = Page(text)
    assert page.elements.count("script") == SCRIPTS + 1
    assert "img" not in page.elements
    assert BAD in page.text
    assert "<script>alert" not in text


@pytest.mark.parametrize("number", [1, 3])
def test_of_a_grid_one_combination_is_shown_and_which_is_said(number: int, tmp_path: Path) -> None:
    config, datasets = run_of_grid("waves")
    written(datasets, tmp_path)
    made = report(tmp_path, combination=number)
    page = Page(made.file.read_text("utf-8"))
    scheme = ["vogel", "vogel", "fullwave", "fullwave"][number - 1]
    assert made.combination == f"tracing.scheme = {scheme}, scene.gap = 0.0 um"
    assert f"Combination {number} of 4 is shown: {made.combination}" in page.text
    assert ("Maxwell's equations" if scheme == "fullwave" else "counted rays") in page.text
    assert {"slope-plot", "image-plot", "paths-body"} <= set(page.ids)
    means = datasets["phase_slope"]["mean_phase_slope"].values.ravel()
    for mean in means:
        assert f"{mean:.3f}" in page.text
    assert config.grid.varied


@pytest.mark.parametrize("name", ["sizes", "zip"])
def test_the_last_combination_of_any_grid_is_shown_too(name: str, tmp_path: Path) -> None:
    config, datasets = run_of_grid(name)
    written(datasets, tmp_path)
    with pytest.raises(DatasetError) as refused:
        report(tmp_path, combination=99)
    last = int(str(refused.value).rpartition(" ")[2])
    assert str(refused.value) == (
        f"--combination: 99 given, but the run has a grid of {last} combinations; give 1 to {last}"
    )
    assert gridded(GRIDS[name]).grid.varied.keys() == config.grid.varied.keys()
    assert "slope-plot" in page_of(tmp_path, combination=last).ids


def test_a_run_without_a_fringe_says_that_there_is_no_slope(tmp_path: Path) -> None:
    config = load_config(SMALL, {"scene": {"refractive_index": {"neuron": 1.33}}})
    datasets = every_stage(config)
    assert datasets["phase_slope"]["phase_slope"].isnull().all()
    page = page_of(written(datasets, tmp_path))
    assert "No phase slope" in page.text
    assert "A phase is read from 0 of 5 spectra" in page.text


@pytest.mark.parametrize("missing", ["spectra", "phase_slope", "paths", "fourier", "focus_law"])
def test_a_dataset_that_is_missing_is_left_out(missing: str, folder: Path) -> None:
    (folder / f"{missing}.nc").unlink()
    page = page_of(folder)
    ids = {"spectra": "image-plot", "phase_slope": "slope-plot", "paths": "paths-body"}
    assert ids.get(missing, "nothing") not in page.ids
    assert ("slope-plot" in page.ids) == (missing != "phase_slope")


def test_what_has_nothing_to_show_is_refused_in_a_line(folder: Path, tmp_path: Path) -> None:
    for file in folder.iterdir():
        if file.name not in ("focus_scan.nc", "focus_sweep.nc"):
            file.unlink()
    with pytest.raises(DatasetError, match=r"no dataset that a report shows, only focus_scan\.nc"):
        report(folder)
    (tmp_path / "empty").mkdir()
    for nothing in ("empty", "none"):
        with pytest.raises(DatasetError, match="no datasets; give a folder as results/thesis"):
            report(tmp_path / nothing)
    assert not list(tmp_path.rglob("*.html"))


def test_a_page_that_can_t_be_written_leaves_what_was_there(plain: Path, tmp_path: Path) -> None:
    (tmp_path / "there").mkdir()
    with pytest.raises(FileError, match="can't be written"):
        report(plain, tmp_path / "there")
    assert not list(tmp_path.glob(".*"))


def test_a_run_without_a_grid_has_no_second_combination(plain: Path) -> None:
    with pytest.raises(DatasetError, match="2 given, but the run has no grid; give 1 to 1"):
        report(plain, combination=2)
