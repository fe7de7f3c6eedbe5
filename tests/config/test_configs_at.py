"""A combination's config is the one that checking all of it gives, whatever keys vary."""

import random
from collections.abc import Callable
from typing import Any

import pytest
from pydantic import ValidationError

from octsim.base.errors import ConfigError
from octsim.config.checks import _WITH_RANGES
from octsim.config.configs_at import ConfigsAt
from octsim.config.derive import config_at, part_of
from octsim.config.grid import combinations
from octsim.config.load import load_config
from octsim.config.models import Config
from octsim.config.ranges import Range

RICH: dict[str, Any] = {
    "scene": {
        "refractive_index": {"glass": {"cauchy": [1.5, 0.004, 0]}, "myelin": 1.44, "oil": 1.5},
        "layers": ["glass", {"medium": "oil", "thickness": "1 um"}, "water"],
        "cylinders": [
            {"medium": "neuron", "shells": [{"medium": "myelin", "thickness": "50 nm"}]},
            {"medium": "neuron", "diameter": "1 um", "x": "5 um"},
        ],
        "attenuation": {"neuron": "10 /cm"},
    },
    "objective": {"zernike": {"spherical": "5 nm"}, "pupil": {"gaussian": 0.8}},
    "tracing": {"scheme": "fullwave"},
    "spectrum": {
        "pixels": {"wavelength": [round(0.6 + 0.001 * i, 3) for i in range(350)]},
        "source": {"gaussian": {"centre": "770 nm", "fwhm": "90 nm"}},
    },
}
VALUES: dict[str, list[Any]] = {
    "scene.gap": ["1 nm", "0.02 um"],
    "scene.refractive_index.neuron": [1.38, {"cauchy": [1.37, 0.003, 0]}],
    "scene.refractive_index": [{"neuron": 1.4}],
    "scene.cylinders.1.x": ["6 um"],
    "scene.layers.1.thickness": ["2 um"],
    "scene.attenuation.neuron": ["20 /cm"],
    "objective.zernike.vertical_astigmatism": ["1 nm", "1 s"],
    "objective.zernike": [{"coma y": "2 nm"}, "none"],
    "objective.numerical_aperture": [1.0],
    "objective": [{"magnification": 30}],
    "spectrum.wavelength.min": ["650 nm", "660 nm"],
    "spectrum.source.gaussian.fwhm": ["80 nm"],
    "tracing.preset": ["draft", "exact"],
    "tracing.accuracy": [1e-3],
    "sweep.diameters.num": [9],
    "sweep.diameters": [{"start": "1 um", "stop": "2 um", "step": "0.25 um"}],
    "processing.window": ["hann"],
}


def outcome(made: Callable[[], Config]) -> Config | str:
    """Return a config, or why there is none."""
    try:
        found = made()
    except ValidationError as error:
        return str(error)
    assert found == Config.model_validate(found.to_dict())
    return found


@pytest.mark.parametrize("overlay", [{}, RICH], ids=["plain", "rich"])
def test_a_config_is_that_of_which_all_is_checked(overlay: dict[str, Any]) -> None:
    base = load_config(overlay).to_dict()
    configs, draw = ConfigsAt(base), random.Random(1)
    there = [
        key for key in VALUES if part_of(base, key.rpartition(".")[0]) is not None or "." not in key
    ]
    drawn = [{key: value} for key in there for value in VALUES[key]]
    for _ in range(150):
        keys = draw.sample(there, 3)
        apart = not any(f"{a}.".startswith(f"{b}.") for a in keys for b in keys if a != b)
        drawn += [{key: draw.choice(VALUES[key]) for key in keys}] if apart else []
    assert len(drawn) > 100
    outcomes = set()
    for values in drawn:
        found = outcome(lambda: configs.at(values))  # noqa: B023 (called at once)
        whole = outcome(lambda: config_at(base, values))  # noqa: B023
        assert found == whole, values
        outcomes.add(type(whole))
    assert outcomes == {Config, str}  # some are refused, by the same words


def test_pixels_are_those_of_each_band() -> None:
    grid = {"spectrum.wavelength.min": ["650 nm", "660 nm"]}
    found = [at.config.spectrum for at in combinations(load_config(RICH, {"grid": grid}))]
    assert [one.samples for one in found] == [len(one.wavenumbers()) for one in found]
    assert found[0].samples > found[1].samples


def test_what_no_key_is_in_is_the_same_object_in_all() -> None:
    configs = ConfigsAt(load_config(RICH).to_dict())
    one, other = (configs.at({"scene.gap": gap}).scene for gap in ("1 nm", "2 nm"))
    for part in ("refractive_index", "layers", "cylinders", "attenuation"):
        assert getattr(one, part) is getattr(other, part)
    first, second = (
        configs.at({"scene.gap": gap, "scene.refractive_index.neuron": index}).scene
        for index in [1.38]
        for gap in ("1 nm", "2 nm")
    )
    assert first.refractive_index is second.refractive_index
    assert first.refractive_index.of["neuron"] != one.refractive_index.of["neuron"]


@pytest.mark.parametrize("section", ["objective", "sweep", "tracing", "detector", "spectrum"])
@pytest.mark.parametrize("given", [5, None, "x", [1]])
def test_a_section_that_is_no_mapping_is_a_line(section: str, given: object) -> None:
    with pytest.raises(ConfigError, match=rf"^grid\.{section}: "):
        load_config({"grid": {section: [given, {}]}})


def test_every_range_is_in_a_section_that_is_looked_at_for_them() -> None:
    def holds(part: object) -> bool:
        if isinstance(part, Range):
            return True
        fields = getattr(type(part), "model_fields", {})
        return any(holds(getattr(part, name)) for name in fields)

    for config in (Config(), load_config(RICH)):
        found = {name for name in Config.model_fields if holds(getattr(config, name))}
        assert found <= set(_WITH_RANGES)
    assert "focus_scan" in found
