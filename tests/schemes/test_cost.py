"""What a point is said to take before it is traced."""

import math
from typing import Any

import numpy as np
import pytest

from octsim.config.derive import by_waves, changed
from octsim.config.load import load_config
from octsim.config.scheme import point_cost, rate_name
from octsim.instrument.instrument import Instrument
from octsim.schemes.cost import of_waves


@pytest.mark.parametrize(("accuracy", "diameter"), [(1e-2, 0.5), (1e-2, 2.0), (1e-4, 1.0)])
def test_waves_are_kept_in_about_as_many_bytes_as_said(accuracy: float, diameter: float) -> None:
    config = changed(by_waves(load_config()), {"tracing": {"accuracy": accuracy}})
    light = Instrument(config).light(diameter, 0.581 * diameter + 0.069)
    size = sum(part.nbytes for part in light if isinstance(part, np.ndarray))
    assert of_waves({"accuracy": accuracy}, diameter).size == pytest.approx(size, rel=0.5)


def test_waves_take_more_by_diameter_and_by_digits_and_never_without_end() -> None:
    at = [of_waves({"accuracy": 1e-4}, diameter) for diameter in (0.01, 1, 2, 4)]
    assert (np.diff([cost.seconds for cost in at]) > 0).all()
    assert (np.diff([cost.memory for cost in at]) > 0).all()
    assert of_waves({"accuracy": 1e-6}, 2).seconds > at[2].seconds
    assert math.isfinite(of_waves({"accuracy": 1e-8}, 1000).seconds)


def test_what_a_scene_has_more_takes_more_time() -> None:
    def seconds(scheme: str, scene: dict[str, Any]) -> float:
        return point_cost(load_config({"scene": scene, "tracing": {"scheme": scheme}})).seconds

    neighbour = {"medium": "neuron", "diameter": "1 um", "x": "3 um"}
    farther = neighbour | {"x": "5 um"}
    scenes: dict[str, dict[str, Any]] = {
        "two": {"cylinders": [{"medium": "neuron"}, neighbour]},
        "two far apart": {"cylinders": [{"medium": "neuron"}, farther]},
        "cover": {"layers": ["glass", {"medium": "water", "thickness": "5 um"}, "glass"]},
        "tilted": {"cylinders": [{"medium": "neuron", "elevation": "1 deg"}]},
    }
    by_waves = {
        name: seconds("fullwave", scenes[name]) for name in ("two", "two far apart", "cover")
    }
    plain = seconds("fullwave", {})
    assert 10 * plain < by_waves["two"] < by_waves["two far apart"] < 300 * plain
    assert 10 * plain < by_waves["cover"] < 100 * plain
    plain = seconds("paths", {})
    for name, scene in scenes.items():
        assert 2 * plain < seconds("paths", scene) < 100 * plain, name
    # the trees of counted rays tell of themselves
    assert seconds("vogel", scenes["tilted"]) == seconds("vogel", {})


def test_points_of_scenes_that_take_longer_have_a_rate_of_their_own() -> None:
    tilted = {"cylinders": [{"medium": "neuron", "elevation": "1 deg"}]}
    plain = load_config({"tracing": {"scheme": "paths"}})
    assert rate_name(plain) == "paths 0.0001"
    assert rate_name(changed(plain, {"scene": tilted})) == "paths 0.0001 times 32"
