"""Outlines are where surfaces are cut by the plane y = 0."""

import numpy as np
import pytest

from octsim.optics.materials import Constant
from octsim.optics.outlines import outlines
from octsim.optics.scene import Cylinder, Plane, Region, Scene

GLASS, WATER, AXON = (
    Region(name, Constant(n)) for name, n in (("glass", 1.5), ("water", 1.3), ("axon", 1.4))
)


@pytest.mark.parametrize("azimuth", [0.0, 0.4, -1.0])
@pytest.mark.parametrize("elevation", [0.0, 0.1])
def test_a_cylinder_s_line_is_a_radius_from_its_axis_and_ends_at_the_plane(
    azimuth: float, elevation: float
) -> None:
    cylinder = Cylinder("axon", 0.3, 0.705, 0.7, AXON, WATER, azimuth, elevation)
    scene = Scene(GLASS, (Plane("glass", 0.0, GLASS, WATER), cylinder))
    (plane, level), (name, (x, z)) = outlines(scene, -2.0, 3.0)
    assert (plane, name) == ("glass", "axon")
    assert level.tolist() == [[-2.0, 3.0], [0.0, 0.0]]
    there = np.stack([x - 0.3, 0 * x, z - 0.705], axis=-1)
    known = np.isfinite(z)
    away = np.linalg.norm(np.cross(there, cylinder.axis), axis=-1)
    assert away[known] == pytest.approx(0.7)
    assert (z[known] >= 0).all()
    if elevation == 0:
        assert known.all()
        assert z.min() == pytest.approx(0.005)
