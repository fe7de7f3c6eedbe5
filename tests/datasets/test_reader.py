"""Parts of a stored dataset, read alone."""

import numpy as np
from gridded import GIVEN, gridded

import octsim
from octsim.config.grid import combinations
from octsim.datasets.reader import Stored


def test_a_part_of_a_combination_is_read_alone() -> None:
    config = gridded({"scene.gap": ["0 nm", "30 nm"]}, GIVEN)
    stored = Stored(octsim.detections(config), "detections", config)
    at = list(combinations(config))[1]
    whole = stored.part(at)
    first, rest = stored.part(at, slice(0, 2)), stored.part(at, slice(2, 5))
    for name in ("amplitude", "focus", "diameter"):
        joined = np.concatenate([first[name].values, rest[name].values])
        np.testing.assert_array_equal(joined, whole[name].values)
    assert first["rays_detected"].sum() == first.sizes["ray"]
