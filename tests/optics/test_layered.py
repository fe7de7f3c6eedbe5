"""Scenes of layers: what their planes are named."""

import pytest

from octsim.optics.layered import plates
from octsim.optics.materials import Constant
from octsim.optics.scene import Region


@pytest.mark.parametrize("number", [1, 2, 9, 10, 13])
def test_planes_have_names_of_their_own_however_many_there_are(number: int) -> None:
    regions = [Region(f"layer {i}", Constant(1.3 + 0.01 * i)) for i in range(number + 1)]
    scene = plates(regions, [0.1 * i for i in range(number)])
    # letters that say neither R nor T nor the cylinder's C, and then numbers
    expected = [*"PQSUVWXYZ", "P10", "P11", "P12", "P13"][:number]
    assert list(scene.surface_names) == expected
    assert [plane.below for plane in scene.surfaces] == regions[:-1]  # type: ignore[union-attr]
