"""Examples of experiments in the literature, in reduced form: each gives what its physics says."""

import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr
import yaml

import octsim

ROOT = Path(__file__).parents[1]
EXAMPLES = ROOT / "config" / "examples"
PAGE = (ROOT / "docs" / "examples.md").read_text(encoding="utf-8")
CITED = (
    "crayfish_nerve",
    "lobster_nerve",
    "squid_axon",
    "cultured_neurite",
    "myelinated_axon",
)
OF_THE_EXPERIMENT = {"objective", "spectrum", "scene", "sweep", "expansion", "action_potential"}
"""Sections that a paper could say something of."""


def made(example: str, *datasets: str, **reduced: Any) -> dict[str, xr.Dataset]:
    """Return datasets of an example with fewer points."""
    return octsim.run(octsim.load_config(EXAMPLES / f"{example}.yaml", reduced), *datasets)


def diameters(start: str, stop: str, num: int) -> dict[str, Any]:
    return {"diameters": {"start": start, "stop": stop, "num": num}}


@pytest.mark.parametrize("file", sorted(EXAMPLES.glob("*.yaml")), ids=lambda file: file.stem)
def test_an_example_is_a_run_of_its_file_s_name(file: Path) -> None:
    assert octsim.load_config(file).run == file.stem


@pytest.mark.parametrize("example", CITED)
def test_an_example_is_cited_alike_in_its_head_and_on_the_page(example: str) -> None:
    head = (EXAMPLES / f"{example}.yaml").read_text(encoding="utf-8").split("run:")[0]
    cited = " ".join(head.replace("#", " ").split())
    (title,) = re.findall(r'"([^"]+)"', cited)
    (place,) = re.findall(r'," ([^,]+, [\d, -]+ \(\d{4}\))\.', cited.replace('", ', '," '))
    said = " ".join(PAGE.split())
    assert title.rstrip(",") in said
    assert place in said
    assert f"(../config/examples/{example}.yaml)" in PAGE


@pytest.mark.parametrize("example", CITED)
def test_each_number_of_an_experiment_is_the_paper_s_or_assumed(example: str) -> None:
    lines = (EXAMPLES / f"{example}.yaml").read_text(encoding="utf-8").splitlines()
    section, counted = "", 0
    for line in lines:
        value, _, comment = line.partition("#")
        if key := re.match(r"\w+", value):
            section = key[0]
        if section in OF_THE_EXPERIMENT and re.search(r"\d", value):
            assert re.search("assumed|paper", comment), line
            counted += 1
    assert counted > 5
    assert yaml.safe_load("\n".join(lines))["run"] == example


def test_a_crayfish_s_fibre_moves_the_phase_as_a_plate_of_its_thickness() -> None:
    """By Maxwell's equations, at an aperture where directions differ little."""
    slope = made("crayfish_nerve", "phase_slope", sweep=diameters("14 um", "14.2 um", 3))
    found = slope["phase_slope"]["phase_slope"].values
    # a cone of light is along the axis by the mean of cos θ, half a per cent less than 1
    axial = float(slope["phase_slope"]["predicted_phase_slope"])
    assert np.all(found < axial)
    np.testing.assert_allclose(found, axial, rtol=0.02)


def test_five_nanometres_of_a_lobster_s_nerve_are_as_many_of_saline() -> None:
    slope = made("lobster_nerve", "phase_slope", sweep={"diameters": {"num": 6}})
    per_nm = slope["phase_slope"]["phase_slope"].values
    # n (k_min + k_max) of saline, from the config's own numbers
    axial = 1.33 * 2 * np.pi * (1 / 1500 + 1 / 1600) * 1000
    np.testing.assert_allclose(5 * per_nm, 5 * axial, rtol=1e-3)


def test_a_squid_s_axon_is_as_deep_as_it_is_thick() -> None:
    """The far wall shows at n d of axoplasm, and moves the phase with it."""
    run = made("squid_axon", "phase_slope", sweep=diameters("300 um", "300.2 um", 5))
    slope = run["phase_slope"]
    np.testing.assert_allclose(slope["phase_slope"], slope["predicted_phase_slope"], rtol=2e-3)
    seen = run["fourier"]["magnitude"].isel(diameter=0)
    depth = float(seen["depth"][int(np.argmax(seen.values))])
    step = float(seen["depth"][1])
    assert depth == pytest.approx(1.37 * 300, abs=step)


def test_a_neurite_that_shrinks_moves_the_phase_the_other_way() -> None:
    """From -0.7 to 0.9 nm, as in the paper, at a focus that is held."""
    sweep = {
        "diameters": ["1.4993 um", "1.5 um", "1.5009 um"],
        "focus": {"slope": 0, "intercept": "940.5 nm"},
    }
    run = made("cultured_neurite", "fourier", sweep=sweep, spectrum={"samples": 120})
    shrunk, rest, swollen = run["fourier"]["estimated_phase"].values
    # at NA 0.8 light goes aslant, and its way is shorter in phase than along the axis
    axial = 1.38 * 2 * np.pi * (1 / 650 + 1 / 900)
    assert 0.9 * axial * 0.9 < swollen - rest < axial * 0.9
    assert (shrunk - rest) / (swollen - rest) == pytest.approx(-0.7 / 0.9, rel=0.01)


def test_a_myelinated_axon_s_period_over_the_wavenumber_falls_with_its_diameter() -> None:
    """As in the paper, where it is a hyperbola: the optical depth grows with the diameter."""
    run = made("myelinated_axon", "phase_slope", sweep=diameters("1.2 um", "1.6 um", 6))
    intensity = run["spectra"]["intensity"]
    wavenumber = intensity["wavenumber"].values
    fringes = (intensity - intensity.mean("wavenumber")) * np.hanning(wavenumber.size)
    length = 1 << 15
    transform = np.abs(np.fft.rfft(fringes.values, length))
    depth = np.arange(length // 2 + 1) * np.pi / (length * (wavenumber[1] - wavenumber[0]))
    period = np.pi / depth[transform.argmax(axis=1)]
    assert np.all(np.diff(period) < 0)
    # what is added is axon, while the shell stays as it is
    slope = run["phase_slope"]
    axial = 1.38 * 2 * np.pi * (1 / 400 + 1 / 700) * 1000
    assert float(slope["mean_phase_slope"]) == pytest.approx(axial, rel=0.05)
