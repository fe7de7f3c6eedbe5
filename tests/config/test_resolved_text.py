"""A resolved config as text is the config again, and says what the thesis has."""

from typing import Any

import pytest
import yaml

from octsim.config.load import load_config
from octsim.config.models import Config
from octsim.config.resolved_text import resolved_lines

SCENE = {
    "scene": {"layers": ["glass", {"medium": "film", "thickness": "2 um"}, "water"],
              "refractive_index": {"film": 1.4}, "attenuation": {"neuron": "10 /cm"}},
}  # fmt: skip


@pytest.mark.parametrize(
    "overlay",
    [
        SCENE,
        {"expansion": {"outliers": "off"}, "tracing": {"scheme": "paths", "accuracy": 1e-7}},
        {"objective": {"zernike": {"spherical": "10 nm"}, "pupil": {"fibre": "5 um"}}},
        {"grid": {"scene.gap": ["0 nm", "5 nm"], "detector.core_diameter": ["4 um"]}},
    ],
)  # fmt: skip
def test_the_text_is_read_back_to_the_same_config(overlay: dict[str, Any]) -> None:
    config = load_config(overlay)
    assert load_config(yaml.safe_load("\n".join(resolved_lines(config)))) == config


def test_a_key_that_is_set_has_what_the_thesis_has_beside_it() -> None:
    lines = resolved_lines(load_config({"sweep": {"diameters": {"stop": "3 um"}}}))
    assert "    stop: 3.0 um  # thesis: 2.0 um" in lines
    assert sum("# thesis" in line for line in lines) == 1
    assert not any("#" in line for line in resolved_lines(Config()))
