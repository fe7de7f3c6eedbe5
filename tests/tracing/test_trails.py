"""Trails are what Snell's law and reflection make of rays, from surface to surface."""

import numpy as np
import pytest

from octsim.optics.beam import Beam
from octsim.optics.materials import Constant
from octsim.optics.scene import neuron_on_glass
from octsim.tracing.faces import faces_at
from octsim.tracing.trails import trails

GLASS, WATER, NEURON, GAP, DIAMETER = 1.52, 1.33, 1.39, 0.005, 1.4
FAR_SIDE, NEAR_SIDE, PLANE = 0b1_01_11_10_11_01, 0b1_01_10_01, 0b1_00
INDICES = {
    PLANE: (GLASS, GLASS),
    NEAR_SIDE: (GLASS, WATER, WATER, GLASS),
    FAR_SIDE: (GLASS, WATER, NEURON, NEURON, WATER, GLASS),
}


@pytest.mark.parametrize("code", INDICES)
def test_trails_obey_snell_s_law_where_they_meet_a_surface(code: int) -> None:
    scene = neuron_on_glass(Constant(GLASS), Constant(WATER), Constant(NEURON), GAP, DIAMETER)
    vx, vy = np.linspace(-0.3, 0.4, 6), np.linspace(0.02, -0.1, 6)
    number = np.arange(6)
    beam = Beam(vx, vy, np.sqrt(1 - vx**2 - vy**2), np.ones(6), number)
    found = trails(faces_at(scene, 8.0), code, beam, 0.9, -1.0)
    assert found.shape == (6, len(INDICES[code]) + 1, 3)
    assert np.isfinite(found).all()
    assert found[:, 0, 2] == pytest.approx(-1.0)
    assert found[:, -1, 2] == pytest.approx(-1.0)
    step = np.diff(found, axis=1)
    along = step / np.linalg.norm(step, axis=-1, keepdims=True)
    # as launched: aimed at the focus
    assert along[:, 0] == pytest.approx(np.stack([vx, vy, beam.vz], axis=-1))
    for meeting, (before, after) in enumerate(zip(INDICES[code], INDICES[code][1:], strict=False)):
        at = found[:, meeting + 1]
        on_plane = np.abs(at[:, 2]).max() < 1e-12
        out = at - [0, 0, GAP + DIAMETER / 2]
        normal = np.tile([0.0, 0.0, 1.0], (6, 1)) if on_plane else out * [1, 0, 1]
        if not on_plane:
            assert np.hypot(out[:, 0], out[:, 2]) == pytest.approx(DIAMETER / 2)
        normal /= np.linalg.norm(normal, axis=-1, keepdims=True)
        tangents = [
            n * np.cross(normal, way)
            for n, way in ((before, along[:, meeting]), (after, along[:, meeting + 1]))
        ]
        assert tangents[0] == pytest.approx(tangents[1], abs=1e-12)


def test_a_ray_that_does_not_take_a_path_has_no_trail() -> None:
    scene = neuron_on_glass(Constant(GLASS), Constant(WATER), Constant(NEURON), GAP, DIAMETER)
    beam = Beam(np.array([0.0]), np.array([0.7]), np.array([0.714]), np.ones(1), np.arange(1))
    away = trails(faces_at(scene, 8.0), NEAR_SIDE, beam._replace(vx=np.array([0.7])), -5.0, -6.0)
    assert np.isnan(away).all()
