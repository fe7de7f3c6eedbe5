"""Refractive indices that depend on the wavelength: how they are given, and what is refused."""

import json
import subprocess
import sys
from dataclasses import replace
from math import pi
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest

from octsim.base.errors import ConfigError
from octsim.config.abilities import as_far_as, asked_of_scheme
from octsim.config.checks import impossible as all_impossible
from octsim.config.derive import merge, nested, validated
from octsim.config.dispersion import moved
from octsim.config.known_keys import known_keys
from octsim.config.load import load_config
from octsim.config.models import Config
from octsim.config.scene_checks import impossible_scene
from octsim.config.told import told
from octsim.config.unread import unread_scene
from octsim.optics.materials import Cauchy, Constant, Sellmeier, Table, group_index
from octsim.optics.shipped_materials import SHIPPED
from octsim.schemes.table import COUNTED_RAYS, Ability

CAUCHY = {"cauchy": [1.3815, 0.0040, 0.00012]}
SELLMEIER = {"sellmeier": {"B": [0.5684, 0.1726], "C": [0.005102, 0.01821]}}
COLUMNS = {"wavelength": ["600 nm", "750 nm", "950 nm"], "n": [1.4, 1.39, 1.38]}


def indices(given: dict[str, Any]) -> Config:
    """Return a config with some indices, each key checked, whatever its scheme can do of them."""
    return validated(merge(Config().to_dict(), {"scene": {"refractive_index": given}}))


def of_file(folder: Path, text: str, **given: str) -> Config:
    file = folder / "neuron.csv"
    file.write_text(text, encoding="utf-8")
    return indices({"neuron": {"table": str(file), **given}})


@pytest.mark.parametrize(
    ("given", "material"),
    [
        (1.4, Constant(1.4)),
        (CAUCHY, Cauchy((1.3815, 0.0040, 0.00012))),
        (SELLMEIER, Sellmeier((0.5684, 0.1726), (0.005102, 0.01821))),
        ({"table": COLUMNS}, Table((0.6, 0.75, 0.95), (1.4, 1.39, 1.38))),
        (
            {"table": {"wavelength": [0.6, 1], "n": [1.4, 1], "kappa": [0, 1e-4]}},
            Table((0.6, 1.0), (1.4, 1.0), (0.0, 1e-4)),
        ),
        ("N-BK7", SHIPPED["N-BK7"].material),
    ],
)
def test_an_index_becomes_its_material_and_reads_back(given: Any, material: object) -> None:
    config = indices({"neuron": given})
    assert config.swept_material == config.scene.swept_material == material
    assert Config.model_validate(json.loads(json.dumps(config.to_dict()))) == config
    assert config.dispersive == (material != Constant(1.4))
    assert set(known_keys(config)) >= {"scene.refractive_index.neuron"}


def test_indices_are_those_of_the_middle_of_the_band() -> None:
    config = indices({"neuron": CAUCHY, "water": "water"})
    k = (2 * pi / 0.65 + 2 * pi / 0.9) / 2
    assert config.spectrum.middle == pytest.approx(k, rel=1e-15)
    assert config.host_index == SHIPPED["water"].material.index(config.spectrum.middle).real
    assert (config.objective_index, config.objective_material) == (1.52, Constant(1.52))
    assert config.swept_group_index == group_index(config.swept_material, config.spectrum.middle)
    assert config.swept_group_index > config.swept_index == pytest.approx(1.3889, abs=1e-4)
    assert Config().swept_group_index == Config().swept_index == 1.39
    assert not Config().dispersive


@pytest.mark.parametrize(
    ("text", "given"),
    [
        ("wavelength (nm),n\n600,1.4\n750,1.39\n950,1.38\n", {}),
        ("wavelength_um;n;note\n0.6;1.4;a\n.75;1.39;b\n0.95;1.38;c\n", {}),
        ("# by us\n\nn\tWavelength [nm]\n1.4\t600\n1.39\t750\n1.38\t950\n", {}),
        ("600, 1.4\n750, 1.39\n950, 1.38\n", {"unit": "nm"}),
        ("\ufeffwavelength,n\n600,1.4\n7.5e2,1.39\n950,1.38\n", {"unit": "nm"}),
        ("wavelength (um),n\n0.6,1.4\n0.75,1.39\n0.95,1.38\n", {"unit": "um"}),
        ("wl,n\n0.6,1.4\n0.75,1.39\n0.95,1.38\n", {}),
        ("Wavelength, nm,Refractive Index\n600,1.4\n750,1.39\n950,1.38\n", {}),
        ('"Wavelength, nm","n_real"\n600,1.4\n750,1.39\n950,1.38\n', {}),
        ("Wavelength, nm\tRefractive Index\n600\t1.4\n750\t1.39\n950\t1.38\n", {}),
        ("lambda/nm n(real)\n600 1.4\n750 1.39\n950 1.38\n", {}),
        ("Wavelength (nm)  Refractive Index\n600   1.4\n750  1.39\n950  1.38\n", {}),
        ('"wavelength (nm)"  "refractive index"\n600 1.4\n750 1.39\n950 1.38\n', {}),
        ("# 'wavelength (nm)' 'n'\n600 1.4\n750 1.39\n950 1.38\n", {}),
        ("wavelength_nm refractive index\n600 1.4\n750 1.39\n950 1.38\n", {}),
        ("# wavelength [nm] n\n600 1.4\n750 1.39\n950 1.38\n", {}),
        ("# of ours\n# wavelength (nm), n\n600 1.4\n750 1.39\n950 1.38\n", {}),
        ("wavelength in nm;n\n600;1,4\n750;1,39\n950;1,38\n", {}),
        ("wl (um);n\n0,6;1,4\n0,75;1,39\n0,95;1,38\n", {}),
        ("0,6 1,4\n0,75 1,39\n0,95 1,38\n", {"unit": "um"}),
        ("600 1.4\n750 1.39\n950 1.38\n", {"unit": "nm"}),
    ],
)
def test_a_table_of_a_file_is_kept_inline(tmp_path: Path, text: str, given: Any) -> None:
    config = of_file(tmp_path, text, **given)
    assert config == indices({"neuron": {"table": COLUMNS}})
    (tmp_path / "neuron.csv").unlink()
    assert validated(config.to_dict()) == config


def test_a_table_of_a_file_may_have_absorption(tmp_path: Path) -> None:
    config = of_file(tmp_path, "wavelength (nm),n,k\n600,1.4,0\n950,1.38,1e-5\n")
    assert config.swept_material.index(2 * pi / 0.95).imag == pytest.approx(1e-5)


@pytest.mark.parametrize(
    "text",
    [
        "wl,n\n0.6,1.4\n0.95,1.38\nwl,k\n0.6,0\n0.95,1e-5\n",
        "wl\tn\n0.6\t1.4\n0.95\t1.38\n\nwl\tk\n0.6\t0\n0.95\t1e-5\n",
        "Wavelength (nm);n;Extinction Coefficient\n600;1,4;0\n950;1,38;1e-5\n",
        "wavelength (nm) n kappa\n600 1.4 0\n950 1.38 1e-5\n",
    ],
)
def test_a_table_of_a_file_may_have_kappa_in_a_second_block(tmp_path: Path, text: str) -> None:
    columns = {"wavelength": [0.6, 0.95], "n": [1.4, 1.38], "kappa": [0, 1e-5]}
    assert of_file(tmp_path, text) == indices({"neuron": {"table": columns}})


def test_a_table_far_from_the_band_is_asked_for_its_unit(tmp_path: Path) -> None:
    config = of_file(tmp_path, "wavelength (um),n\n640,1.4\n920,1.38\n")
    (said,) = impossible_scene(config)
    assert said == (
        f"scene.refractive_index.neuron: {tmp_path / 'neuron.csv'} from 640 um to 920 um given, "
        "but spectrum.wavelength is from 0.65 um to 0.9 um; are these nm, not um? give a "
        "dispersion that spans the band, or a narrower band"
    )
    (said,) = impossible_scene(of_file(tmp_path, "wl (nm),n\n6000,1.4\n9500,1.38\n"))
    assert "are these angstrom, not nm?" in said


def test_arrays_and_sequences_are_lists() -> None:
    wavelength = np.array([0.6, 0.75, 0.95])
    for n in (np.array([1.4, 1.39, 1.38]), (1.4, 1.39, 1.38), pd.Series([1.4, 1.39, 1.38])):
        table = {"wavelength": wavelength, "n": n}
        config = load_config({"scene": {"refractive_index": {"neuron": {"table": table}}}})
        assert config.swept_material == Table((0.6, 0.75, 0.95), (1.4, 1.39, 1.38))
    assert load_config({"tracing": {"rays": np.int64(7)}}).tracing.rays == 7


@pytest.mark.parametrize(
    ("text", "line"),
    [
        (
            "scene: {refractive_index: {neuron: 1,39}}",
            "scene.refractive_index.neuron: 1,39 given; write it with a point, as 1.39",
        ),
        (
            "scene: {cylinders: [{medium: neuron, diameter: 1,5 um}]}",
            "scene.cylinders.0.diameter: 1,5 um given; write it with a point, as 1.5 um",
        ),
        ("scene: {gap: 1,5 nm}", "scene.gap: 1,5 nm given; write it with a point, as 1.5 nm"),
        (
            "scene: {refractive_index: {5: 1.4}}",
            "scene.refractive_index: 5 given as a key; keys are names",
        ),
    ],
)
def test_a_decimal_comma_of_yaml_is_named(tmp_path: Path, text: str, line: str) -> None:
    (tmp_path / "mine.yaml").write_text(text)
    with pytest.raises(ConfigError) as raised:
        load_config(tmp_path / "mine.yaml")
    assert str(raised.value).startswith(line)
    assert "\n" not in str(raised.value)


def test_a_file_is_found_from_the_current_folder(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "mine.csv").write_text("wavelength (nm),n\n600,1.4\n950,1.38\n")
    assert indices({"neuron": {"table": "mine.csv"}}).dispersive


BAD: list[tuple[Any, str]] = [
    ("watr", "neuron: 'watr' given; the nearest material that octsim has is water; it should be a"),
    ("n-bk7", "neuron: 'n-bk7' given; the nearest material that octsim has is N-BK7"),
    ("1.39", "neuron: '1.39' given; it should be a number, written out as digits"),
    (0.9, "neuron: 0.9 given; it should be greater than or equal to 1"),
    (None, "neuron: null given; it should be a number, {cauchy: [A, B, C]}"),
    (True, "neuron: true given; it should be a number, {cauchy: [A, B, C]}"),
    ([1.4, 1.5], "neuron: [1.4, 1.5] given; several values of one key stand in the grid"),
    ({}, "neuron: {} given; it should be a number, {cauchy"),
    ({"couchy": [1.4]}, "neuron: {couchy: [1.4]} given; it should be a number, {cauchy"),
    ({**CAUCHY, **SELLMEIER}, "it should be one of cauchy and sellmeier; leave the others out"),
    ({"cauchy": 1.4}, "neuron.cauchy: 1.4 given; it should be a list"),
    ({"cauchy": []}, "neuron.cauchy: [] given"),
    ({"cauchy": [1.4, "x"]}, "neuron.cauchy.1: 'x' given; it should be a number"),
    ({**CAUCHY, "units": "um"}, "neuron.units: unknown key; the nearest that a dispersion has is unit"),
    ({"sellmeier": [1, 2]}, "neuron.sellmeier: [1, 2] given; it should be a mapping"),
    ({"sellmeier": {"b": [0.9], "c": [0.01]}}, "neuron.sellmeier: {b: [0.9], c: [0.01]} given; b, c can't stand here; write B and C, as {B: [...], C: [...]}"),
    ({"table": {"lambda": [0.6, 0.9], "n": [1.4, 1.4]}}, "lambda can't stand here; its columns are wavelength, n and maybe kappa"),
    ({"table": "none.csv", "unit": "inhc"}, "neuron.unit: 'inhc' given; inhc is not a unit of length that is known; give one, as nm or um"),
    ({"sellmeier": {"B": [1]}}, "neuron.sellmeier.C: missing"),
    ({"sellmeier": {"B": [1], "C": [1, 2]}}, "neuron.sellmeier: {B: [1], C: [1, 2]} given; B has 1 numbers and C 2"),
    ({"table": {"wavelength": ["1 um"], "n": [1.4]}}, "neuron.table.wavelength: [1 um] given; it should have 2 or more, not 1"),
    ({"table": {"wavelength": [1, 0.9], "n": [1.4, 1.4]}}, "0.9 um in row 2 is not above 1.0 um in the one before; sort the rows"),
    ({"table": {"wavelength": [1, "1 um"], "n": [1.4, 1.4]}}, "1.0 um in row 2 is not above 1.0 um"),
    ({"table": {"wavelength": ["1", "2 um"], "n": [1.4, 1.4]}}, "neuron.table.wavelength.0: '1' given; a length needs its unit"),
    ({"table": {**COLUMNS, "n": [1.4, 0.4, 1.4]}}, "neuron.table.n.1: 0.4 given; it should be greater than or equal to 1"),
    ({"table": {**COLUMNS, "n": [1.4, 11, 1.4]}}, "neuron.table.n.1: 11 given; it should be less than or equal to 10"),
    ({"table": {**COLUMNS, "n": [1.4, float("nan"), 1.4]}}, "neuron.table.n.1: nan given"),
    ({"table": {**COLUMNS, "n": [1.4, 1.4]}}, "given; n has 2 numbers and wavelength 3; give each"),
    ({"table": {**COLUMNS, "kappa": [0.1]}}, "given; kappa has 1 numbers and wavelength 3"),
    ({"table": {**COLUMNS, "kappa": [0, -1e-9, 0]}}, "neuron.table.kappa.1: -1e-09 given; it should be greater than or equal to 0"),
    ({"table": "none.csv"}, "neuron: {table: none.csv} given; none.csv can't be read (No such file"),
    ({"table": "none.csv", "unit": "kg"}, "neuron.unit: 'kg' given; kg is not a unit of length that is known; give one"),
    ({"table": 5}, "neuron.table: 5 given; it should be a mapping"),
]  # fmt: skip


@pytest.mark.parametrize(("given", "line"), BAD, ids=[line[:60] for _, line in BAD])
def test_a_bad_index_is_refused_in_one_line(given: Any, line: str) -> None:
    with pytest.raises(ConfigError) as raised:
        indices({"neuron": given})
    said = str(raised.value)
    assert said.startswith("scene.refractive_index.neuron")
    assert line in said
    assert "\n" not in said


FILES: list[tuple[str, dict[str, str], str]] = [
    ("", {}, "holds nothing; write a first row as 'wavelength (nm),n'"),
    ("wavelength (nm),n\n", {}, "it should have 2 or more, not 0"),
    ("wavelength,n\n600,1.4\n950,1.4\n", {}, "does not say the unit of its wavelengths"),
    ("600,1.4\n950,1.4\n", {}, "does not say the unit of its wavelengths; write a first row as"),
    ("600\n950\n", {"unit": "nm"}, "has 1 cells in its first row, and no headings"),
    (
        "wavelength (nm),x\n600,1.4\n",
        {},
        "has no column of n by its first row, 'wavelength (nm)', 'x'; write a first row as",
    ),
    (
        "600, 1,4\n950, 1,3\n",
        {"unit": "nm"},
        "has whole numbers alone beside its wavelengths; with decimal commas write semicolons between",
    ),
    (
        "freq;n\n600;1,4\n",
        {},
        "has no column of wavelength by its first row, 'freq', 'n'; write a first row",
    ),
    (
        "wavelength (nm),n\n600,1,40\n950,1,38\n",
        {},
        "row 2: 3 cells, but 2 columns; with decimal commas write semicolons",
    ),
    ("wl,n\n600,1.4\n950,1.4\n", {}, "does not say the unit of its wavelengths"),
    (
        "wl,n\n.6,1.4\n.9,1.4\nwl,k\n.6,0\n.8,0\n",
        {},
        "holds kappa twice, or at other wavelengths than n",
    ),
    (
        "wavelength (um),n\n600,1.4\n1200,1.4\n",
        {},
        "row 3: wavelength 1200 um: it should be less than or equal to 1000 um, and the unit is um; are these nm?",
    ),
    (
        "wavelength,n\n600,1.4\n950,1.4\n",
        {"unit": "inch"},
        "row 2: wavelength 1.524e+07 um: it should be less than or equal to 1000 um, and the unit is inch; are these nm?",
    ),
    ("wavelength (nm),n,N\n600,1.4\n", {}, "has two columns of n; leave one of them out"),
    ("wavelength (kg),n\n600,1.4\n", {}, "'kg' is not a unit of length"),
    ("wavelength (nm),n\n600,1.4\n950,1.4\n", {"unit": "um"}, "unit: um is given, but"),
    ("wavelength (nm),n\n600,1.4\n950\n", {}, "row 3: '' is no n; each row has a number of each"),
    ("wavelength (nm),n\n600,1.4\n950,one\n", {}, "row 3: 'one' is no n"),
    ("wavelength (nm),n\n600,1.4\n\n950,0.4\n", {}, "row 4: n 0.4: it should be greater than or"),
    ("wavelength (nm),n,k\n600,1.4,0\n950,1.4,-1\n", {}, "row 3: kappa -1: it should be greater"),
    ("wavelength (nm),n\n950,1.4\n600,1.4\n", {}, "0.6 um in row 2 is not above 0.95 um"),
    ("wavelength (nm),n\n600,1.4\n600,1.4\n", {}, "0.6 um in row 2 is not above 0.6 um"),
]


@pytest.mark.parametrize(("text", "given", "line"), FILES, ids=[line[:50] for *_, line in FILES])
def test_a_bad_file_is_refused_in_one_line(
    tmp_path: Path, text: str, given: dict[str, str], line: str
) -> None:
    with pytest.raises(ConfigError) as raised:
        of_file(tmp_path, text, **given)
    said = str(raised.value)
    assert line in said
    assert "neuron.csv" in said
    assert "\n" not in said


OF_BAND: list[tuple[Any, str]] = [
    ({"table": {"wavelength": [0.66, 1], "n": [1.4, 1.4]}}, "a table from 0.66 um to 1 um given, but spectrum.wavelength is from 0.65 um to 0.9 um; give"),
    ({"table": {"wavelength": [0.6, 0.8], "n": [1.4, 1.4]}}, "a table from 0.6 um to 0.8 um given, but"),
    ({"cauchy": [0.9, 0.01]}, "{cauchy: [0.9, 0.01]} given, whose index is 0.912346 at 0.9 um, in the band; it should be from 1 to 10"),
    ({"cauchy": [9.99, 0.01]}, "whose index is 10.0"),
    ({"sellmeier": {"B": [1.0], "C": [0.5625]}}, "whose index is nan at"),
    # a resonance that is narrower than any sampling
    ({"sellmeier": {"B": [0.8, 1e-18], "C": [0.01, 0.5625]}}, "whose index is nan at 0.75 um, in the band"),
]  # fmt: skip


@pytest.mark.parametrize(("given", "line"), OF_BAND, ids=[line[:60] for _, line in OF_BAND])
def test_an_index_that_is_none_in_the_band_is_refused(given: Any, line: str) -> None:
    config = indices({"neuron": given})
    (said,) = impossible_scene(config)
    assert said.startswith("scene.refractive_index.neuron: ")
    assert line in said
    assert said in list(all_impossible(config))


def test_a_table_that_just_spans_the_band_is_possible() -> None:
    exact = {"wavelength": ["650 nm", "900 nm"], "n": [1.4, 1.39]}
    assert list(impossible_scene(indices({"neuron": {"table": exact}}))) == []


def test_a_band_beyond_what_a_shipped_material_is_known_for_is_refused() -> None:
    band = {"spectrum": {"wavelength": {"max": "1.2 um"}}}
    config = validated(merge(indices({"water": "water"}).to_dict(), band))
    (said,) = impossible_scene(config)
    assert "water: water given, which is known from 0.182 um to 1.129 um" in said


def test_the_aperture_is_below_the_least_index_of_the_band() -> None:
    glass = {"table": {"wavelength": [0.6, 0.775, 1.0], "n": [1.6, 1.3, 1.0]}}
    said = "\n".join(all_impossible(indices({"glass": glass})))
    assert "it must be below the index of glass, scene.refractive_index.glass = 1." in said


def test_a_dispersion_is_asked_of_a_scheme_and_dropped_where_it_can_t() -> None:
    absorbing = {"table": {**COLUMNS, "kappa": [0, 1e-5, 0]}}
    config = indices({"neuron": absorbing, "water": CAUCHY, "glass": 1.5})
    asked = {(one.ability, one.key): one.given for one in asked_of_scheme(config)}
    assert asked == {
        (Ability.DISPERSION, "scene.refractive_index.water"): "{cauchy: [1.3815, 0.004, 0.00012]}",
        (Ability.DISPERSION, "scene.refractive_index.neuron"): "a table from 0.6 um to 0.95 um",
        (Ability.ATTENUATION, "scene.refractive_index.neuron.table.kappa"): "above zero",
    }
    plain = as_far_as(replace(COUNTED_RAYS, honours=frozenset()), config)
    assert not plain.dispersive
    assert plain.scene.refractive_index.water == config.host_index
    assert plain.swept_index == config.swept_index
    clear = as_far_as(replace(COUNTED_RAYS, honours=frozenset({Ability.DISPERSION})), config)
    assert clear.swept_material == Table((0.6, 0.75, 0.95), (1.4, 1.39, 1.38))
    every = replace(COUNTED_RAYS, honours=frozenset(Ability))
    assert as_far_as(every, config) == config


def test_a_dispersion_that_nothing_is_of_is_said_to_be_in_vain() -> None:
    config = indices({"axon": 1.4})
    config = validated(merge(config.to_dict(), {"scene": {"cylinders": [{"medium": "axon"}]}}))
    assert unread_scene(config, {"scene.refractive_index.water.cauchy": [1.3]}) == []
    (said,) = unread_scene(config, {"scene.refractive_index.neuron.cauchy": [1.3]})
    assert said.endswith("nothing in the scene is of neuron; leave it out, or name it in "
                         "scene.layers or scene.cylinders")  # fmt: skip


def test_a_run_is_told_what_is_dispersive_and_where_it_is_from() -> None:
    said = told(indices({"neuron": CAUCHY, "glass": "N-BK7", "water": "water"}))
    assert said[0] == (
        "scene: neuron (n 1.389 at 755 nm, dispersive) of swept diameter, 5 nm above glass (n "
        "1.512 at 755 nm, dispersive), in water (n 1.329 at 755 nm, dispersive)"
    )
    assert said[1].startswith("scene.refractive_index.glass: N-BK7 is by Schott's data sheet")
    assert "relative to air" in said[1]
    assert said[2].startswith("scene.refractive_index.water: water is by Daimon and Masumura")
    assert len(said) == 3


@pytest.mark.parametrize("given", [1.39, CAUCHY, SELLMEIER, {"table": COLUMNS}, "cytoplasm"])
def test_an_index_is_moved_as_dispersive_as_it_is(given: Any) -> None:
    config = indices({"neuron": given})
    k, n = config.spectrum.middle, config.swept_index + 0.01
    of = dict(config.scene.refractive_index)["neuron"]
    overlay = nested("scene.refractive_index.neuron", moved(of, n, k))
    other = validated(merge(config.to_dict(), overlay))
    assert other.swept_index == pytest.approx(n, abs=1e-12)
    for at in (2 * pi / 0.9, 2 * pi / 0.65):
        by = other.swept_material.index(at) - config.swept_material.index(at)
        assert by == pytest.approx(0.01, abs=1e-4)


def test_reading_a_dispersion_imports_no_scipy() -> None:
    read = (
        "import sys; from octsim.config.models import Config; "
        f"Config.model_validate({{'scene': {{'refractive_index': {{'neuron': {CAUCHY}, "
        f"'water': {{'table': {COLUMNS}}}}}}}}}); "
        "sys.exit('scipy' in sys.modules or 'numpy' in sys.modules)"
    )
    assert subprocess.run([sys.executable, "-c", read], check=False).returncode == 0
