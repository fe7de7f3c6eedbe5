"""Scenes: what is refused and warned of, what is told, and which keys are read back."""

import json
import math
import warnings
from math import pi
from typing import Any

import pytest
from gridded import gridded

from octsim.base.errors import ConfigError, OctsimWarning
from octsim.config.checks import plain_remarks
from octsim.config.derive import config_at, merge, nested, part_of
from octsim.config.grid import combinations, value_at
from octsim.config.known_keys import known_keys
from octsim.config.load import load_config
from octsim.config.messages import unit_of
from octsim.config.models import Config
from octsim.config.scene_checks import impossible_scene
from octsim.config.told import told
from octsim.datasets.axes import dimension_name

EXACT = {"tracing": {"preset": "exact"}}
FILM = {"medium": "film", "thickness": "3 um"}
NEURON: dict[str, Any] = {"medium": "neuron"}
FULL: dict[str, Any] = {
    "refractive_index": {"film": 1.4, "myelin": 1.44},
    "attenuation": {"myelin": "100 /cm"},
    "layers": ["glass", FILM, "water"],
    "cylinders": [
        {"medium": "neuron", "gap": "20 nm", "shells": [{"medium": "myelin", "thickness": "9 nm"}]},
        {"medium": "neuron", "diameter": "1 um", "x": "3 um", "elevation": "0.5 deg"},
    ],
}


def scene(given: dict[str, Any]) -> Config:
    """Return a config that has a scene, whatever its scheme can do of it."""
    return Config.model_validate(merge(Config().to_dict(), {"scene": given}))


def impossible(given: dict[str, Any]) -> list[str]:
    return list(impossible_scene(scene(given)))


def test_the_thesis_is_a_neuron_in_water_on_glass() -> None:
    config = load_config()
    thesis = config.scene
    assert thesis.media == {
        "scene.layers.0": "glass", "scene.layers.1": "water", "scene.cylinders.0.medium": "neuron",
    }  # fmt: skip
    assert (thesis.swept, thesis.swept_gap_key) == (("scene.cylinders.0",), "scene.gap")
    indices = config.objective_index, config.host_index, config.swept_index
    assert (*indices, thesis.swept_gap, thesis.floor) == (1.52, 1.33, 1.39, 0.005, 0.0)


def test_a_record_without_the_keys_is_the_same_config() -> None:
    old = Config().to_dict()
    for section, keys in (
        ("scene", ("layers", "cylinders", "attenuation")),
        (
            "objective",
            ("immersion", "pupil", "apodisation", "zernike", "zernike_rays", "focal_shift"),
        ),
        ("detector", ("falloff", "mode_field_diameter", "fibre_na")),
    ):
        for key in keys:
            del old[section][key]
    for section in ("polarisation", "beam", "interferometer"):
        del old[section]
    assert load_config(old) == Config()


def test_a_scene_reads_back_to_the_same_bits() -> None:
    config = scene(FULL)
    assert impossible(FULL) == []
    assert Config.model_validate(json.loads(json.dumps(config.to_dict()))) == config
    assert config.to_dict()["scene"]["layers"][0] == "glass"
    assert config.scene.attenuation.of == {"myelin": 0.01}
    assert config.scene.cylinders[1].elevation == pi / 360


def test_cylinders_lie_in_water_or_in_the_highest_layer() -> None:
    assert scene(FULL).scene.floor == 3.0
    cover = {"layers": ["glass", {"medium": "water", "thickness": "5 um"}, "glass"]}
    assert (scene(cover).scene.host, scene(cover).scene.floor) == (1, 0.0)
    assert scene({"layers": ["water", "glass"]}).scene.host_medium == "glass"


SHELL = {"medium": "glass", "thickness": "400 nm"}
IMPOSSIBLE: list[tuple[dict[str, Any], str]] = [
    ({"cylinders": [{"medium": "axon"}]}, "scene.cylinders.0.medium: axon given, which has no refractive index;"),
    ({"layers": ["glas", "water"]}, "scene.layers.0: glas given, which has no refractive index; give scene.refractive_index.glas, or one that is known: the nearest is glass"),
    ({"refractive_index": {"myelin": 1.44}}, "scene.refractive_index.myelin: 1.44 given, but nothing in the scene is of myelin"),
    ({"attenuation": {"myelin": "0 /cm"}}, "scene.attenuation.myelin: given, but nothing"),
    ({"layers": ["glass", "glass", "water"]}, "scene.layers.1: glass given, between two other layers; give its thickness"),
    ({"layers": [{"medium": "glass", "thickness": "1 um"}, "water"]}, "scene.layers.0.thickness: given, but the lowest layer has no end"),
    ({"layers": ["glass", {"medium": "glass", "thickness": "swept"}, "water"]}, "scene.layers.1.thickness: swept given beside cylinders"),
    ({"cylinders": []}, "scene: nothing to be swept; just one thing"),
    ({"cylinders": [{"medium": "neuron", "diameter": "1 um"}]}, "scene: nothing to be swept"),
    ({"cylinders": [NEURON, {"medium": "neuron", "x": "9 um"}]}, "scene: scene.cylinders.0, scene.cylinders.1 to be swept"),
    # 2.4 um is the largest diameter of the run, 0.8 um the smallest
    ({"cylinders": [NEURON, {**NEURON, "diameter": "2.4 um", "x": "2.399 um"}]}, "scene.cylinders.1: overlaps scene.cylinders.0: their axes are 2.399 um apart and their radii together 2.4 um"),
    ({"cylinders": [NEURON, {**NEURON, "diameter": "1 um", "x": "50 um", "azimuth": "20 deg"}]}, "scene.cylinders.1: overlaps scene.cylinders.0: their axes are 0.7 um apart"),
    ({"cylinders": [{**NEURON, "shells": [SHELL]}]}, "scene.cylinders.0.shells: 0.4 um thick together, but the radius by focus_law.diameters.start is 0.4 um"),
    ({"layers": ["glass", {"medium": "water", "thickness": "2.4 um"}, "glass"]}, "scene.cylinders.0: reaches 2.405 um above the lower plane"),
]  # fmt: skip


@pytest.mark.parametrize(("given", "line"), IMPOSSIBLE, ids=[line[:50] for _, line in IMPOSSIBLE])
def test_an_impossible_scene_is_refused_in_a_line(given: dict[str, Any], line: str) -> None:
    (only,) = impossible(given)
    assert only.startswith(line)
    with pytest.raises(ConfigError) as raised:
        load_config({"scene": given})
    assert str(raised.value) == only  # and nothing of what the scheme can't do besides


@pytest.mark.parametrize(
    "given",
    [
        {"cylinders": [NEURON, {**NEURON, "diameter": "2.4 um", "x": "2.4 um"}]},
        {
            "cylinders": [
                NEURON,
                {**NEURON, "diameter": "1 um", "gap": "2.41 um", "azimuth": "1 deg"},
            ]
        },
        {"layers": ["glass", {"medium": "water", "thickness": "2.41 um"}, "glass"]},
        {"cylinders": [{**NEURON, "shells": [{"medium": "glass", "thickness": "399 nm"}]}]},
        {"layers": ["glass", {"medium": "neuron", "thickness": "swept"}, "water"], "cylinders": []},
    ],
)
def test_what_touches_or_just_fits_is_possible(given: dict[str, Any]) -> None:
    assert impossible(given) == []


@pytest.mark.parametrize(
    ("given", "line"),
    [
        # effects.md: at a gap of 5 nm and 2 deg at 0.13 um from the axis, d = 1.4 um
        (
            {
                "cylinders": [
                    NEURON,
                    {**NEURON, "diameter": "1.4 um", "x": "9 um", "elevation": "2 deg"},
                ]
            },
            "scene.cylinders.1.elevation: 2 deg, so the cylinder meets the plane below it 0.13 um",
        ),
        (
            {"cylinders": [{**NEURON, "shells": 2 * [{"medium": "glass", "thickness": "5 nm"}]}]},
            "tracing.max_intersections: 11, but light that returns from the far side of "
            "scene.cylinders.0 meets 13 surfaces; raise it",
        ),
    ],
)
def test_what_of_a_scene_is_likely_not_meant_is_said(given: dict[str, Any], line: str) -> None:
    (said,) = [one for one in plain_remarks(scene(given)) if "scene.cylinders" in one]
    assert line in said


def test_light_beyond_the_critical_angle_is_warned_of_by_the_thesiss_split_alone() -> None:
    steep = {"objective": {"numerical_aperture": 1.4}}
    with pytest.warns(OctsimWarning, match=r"1.4 is above the index of water, 1.33, with polaris"):
        load_config(steep)
    # which waves are refused of, whatever their polarisation
    with pytest.raises(ConfigError, match="no light that decays in water"):
        load_config(steep, EXACT)


def test_keys_in_vain_are_said() -> None:
    for given, line in (
        ({"gap": "7 nm", "cylinders": [{**NEURON, "gap": "9 nm"}]}, "scene.gap: 7 nm given, but"),
        (
            {"refractive_index": {"axon": 1.4, "neuron": 1.38}, "cylinders": [{"medium": "axon"}]},
            "scene.refractive_index.neuron: 1.38 given, but nothing in the scene is of neuron",
        ),
    ):
        with pytest.warns(OctsimWarning, match=line) as caught:
            load_config({"scene": given})
        assert len(caught) == 1


def test_the_scene_is_told_where_it_is_not_the_thesiss_by_rays() -> None:
    assert told(load_config()) == told(load_config({"sweep": {"diameters": {"num": 31}}})) == []
    plain = "scene: neuron (n 1.39) of swept diameter, 5 nm above glass (n 1.52), in water (n 1.33)"
    assert told(load_config(EXACT)) == [plain]
    assert told(scene(FULL)) == [
        "scene: neuron (n 1.39) of swept diameter (scene.cylinders.0), 20 nm above film (n 1.4), "
        "shell of myelin (n 1.44), 9 nm thick and neuron (n 1.39) of 1 um, at x = 3 um, elevation "
        "0.5 deg, 5 nm above film (n 1.4), in water (n 1.33); layers: glass (n 1.52), film (n 1.4) "
        "of 3 um, water (n 1.33)"
    ]
    plate = {"layers": ["glass", {"medium": "water", "thickness": "swept"}, "glass"]}
    assert told(scene({**plate, "cylinders": []})) == [
        "scene: water (n 1.33) of swept thickness between glass (n 1.52) and glass (n 1.52)"
    ]
    (line,) = told(gridded({"scene.gap": ["1 nm", "2 nm"]}))
    assert line.endswith(
        "1 nm above glass (n 1.52), in water (n 1.33) (the first of a grid over scene.gap)"
    )


def test_keys_in_lists_have_dotted_paths() -> None:
    config = scene(FULL)
    data = config.to_dict()
    assert part_of(data, "scene.cylinders.1.x") == "3.0 um"
    assert part_of(data, "scene.cylinders.2.x") is part_of(data, "scene.cylinders.x") is None
    assert value_at(config, "scene.cylinders.0.shells.0.thickness") == 0.009
    assert value_at(config, "scene.cylinders.2.x") is None
    assert value_at(config, "scene.refractive_index.film") == 1.4
    known = set(known_keys(config))
    assert {
        "scene.cylinders.1.x",
        "scene.layers.1.thickness",
        "scene.refractive_index.film",
    } < known
    assert "scene.cylinders.1.x" not in set(known_keys())
    for key in ("scene.cylinders.1.x", "scene.layers.1.thickness", "scene.cylinders.0.gap"):
        moved = config_at(data, {key: "4 um"})
        assert value_at(moved, key) == 4.0
        back = part_of(data, key)
        assert Config.model_validate(merge(moved.to_dict(), nested(key, back))) == config


def test_a_grid_varies_keys_in_lists() -> None:
    grid = {
        "scene.cylinders.0.x": ["0 um", "100 nm"],
        "scene.cylinders.0.azimuth": {"start": "0 deg", "stop": "90 deg", "num": 3},
    }
    config = gridded(grid, EXACT)
    found = [at.config.scene.cylinders[0] for at in combinations(config)]
    assert [one.x for one in found] == [0.0, 0.0, 0.0, 0.1, 0.1, 0.1]
    assert [one.azimuth for one in found[:3]] == pytest.approx([0, pi / 4, pi / 2])
    assert load_config(config.to_dict()) == config
    assert dimension_name("scene.cylinders.0.x") == "cylinders_0_x"
    assert (unit_of("scene.cylinders.0.x"), unit_of("scene.cylinders.0.azimuth")) == ("um", "rad")
    assert dimension_name("scene.gap") == "gap"


def test_a_grid_over_a_place_that_a_list_lacks_is_refused() -> None:
    with pytest.raises(ConfigError, match=r"grid\.scene\.cylinders\.1\.x: unknown key"):
        gridded({"scene.cylinders.1.x": ["0 um", "1 um"]}, EXACT)
    lifted = {"scene.cylinders.0.elevation": ["0 deg", "1 deg"]}
    with pytest.raises(
        ConfigError, match=r"scene\.cylinders\.0\.elevation: 1 deg given, but tracing"
    ):
        gridded(lifted, EXACT)


def test_media_of_other_names_are_as_good(recwarn: pytest.WarningsRecorder) -> None:
    named = {"refractive_index": {"axon": 1.39}, "cylinders": [{"medium": "axon"}]}
    assert load_config({"scene": named}).swept_index == 1.39
    assert not recwarn.list
    warnings.simplefilter("error")
    assert load_config({"scene": {"attenuation": {"neuron": "0 /cm"}}}).swept_index == 1.39


@pytest.mark.parametrize(
    ("scene", "line"),
    [
        (
            {"cylinders": [{"medium": "neuron", "shells": [{"medium": "glass", "thickness": "-5 nm"}]}]},
            r"scene\.cylinders\.0\.shells\.0\.thickness",
        ),
        (
            {"cylinders": [{"medium": "neuron"}, {"medium": "neuron", "diameter": "1.1 um", "x": "1.5 um"}]},
            r"scene\.cylinders\.1: overlaps scene\.cylinders\.0",
        ),
        (
            {"layers": ["glass", {"medium": "film", "thickness": "1 um"}, "water"]},
            r"scene\.layers\.1: film given, which has no refractive index",
        ),
        (
            {"layers": ["water", "water"], "cylinders": [{"medium": "neuron", "elevation": "1 deg"}]},
            r"scene\.cylinders\.0\.elevation: given, but below it is nothing but water",
        ),
    ],
)  # fmt: skip
def test_bodies_that_cannot_be_are_refused_in_a_line(scene: dict[str, Any], line: str) -> None:
    with pytest.raises(ConfigError, match=line):
        load_config({"scene": scene})


@pytest.mark.parametrize("diameter", [0.7, 1.1, 1.3, 1.7])
def test_bodies_may_touch_whatever_the_rounding_of_their_lengths(diameter: float) -> None:
    # two of one gap to the plane's height touch where (r1 + r2)² = x² + (r1 - r2)²
    x = 2 * math.sqrt(1.2 * diameter / 2)
    beside = {"medium": "neuron", "diameter": f"{diameter!r} um", "x": f"{x!r} um"}
    between = ["glass", {"medium": "water", "thickness": "2.405 um"}, "glass"]
    config = load_config(
        {"scene": {"cylinders": [{"medium": "neuron"}, beside], "layers": between}}
    )
    assert [one.x for one in config.scene.cylinders] == [0.0, x]
