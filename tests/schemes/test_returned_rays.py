"""A spiral of rays is traced in shares, of which what comes back can be held."""

from typing import Any

import numpy as np
import pytest

from octsim.config.load import load_config
from octsim.instrument.build import optics_of, scene_of
from octsim.schemes.returned_rays import Spiral

RAYS = 60_000
SHELLS = {"scene": {"cylinders": [{"medium": "neuron", "shells": [
    {"medium": "glass", "thickness": "20 nm"}, {"medium": "water", "thickness": "20 nm"},
]}]}}  # fmt: skip
WAIST = {"beam": {"waist": "0.1 um", "wavelength": "755 nm"}}


def shares_of(nodes: int, overlay: dict[str, Any]) -> int:
    """Return how many shares a spiral is traced in, which have each ray once."""
    config = load_config(SHELLS, {"tracing": {"max_intersections": 12}}, overlay)
    options = {"rays": RAYS, "min_amplitude": 0.0}
    spiral = Spiral(optics_of(config), options, scene_of(config, 1.4), 0.9, lengths=False)
    shares = [one for one in spiral.shares(nodes) if one is not None]
    np.testing.assert_array_equal(np.sort(np.concatenate(shares)), np.arange(RAYS))
    return len(shares)


@pytest.mark.parametrize(("nodes", "overlay", "times"), [(9, {}, 9), (1, WAIST, 2), (9, WAIST, 18)])
def test_there_are_as_many_times_the_shares_as_wavenumbers_and_families_are_held(
    nodes: int, overlay: dict[str, Any], times: int
) -> None:
    plain = shares_of(1, {})
    assert plain > 3
    assert times * (plain - 1) < shares_of(nodes, overlay) <= times * plain
