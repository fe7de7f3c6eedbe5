"""The rays of a picture are detected ones of the strongest light paths, spread out."""

import numpy as np
import pytest

from octsim.config.load import load_config
from octsim.instrument.build import detector_of
from octsim.instrument.drawn_rays import drawn_rays, lit_aperture


@pytest.mark.parametrize("scheme", ["vogel", "paths", "fullwave"])
def test_rays_of_the_strongest_paths_return_to_the_focus(scheme: str) -> None:
    config = load_config({"tracing": {"scheme": scheme}})
    focus = 0.8824
    drawn = drawn_rays(config, 1.4, focus, -1.0, paths=3)
    assert {path.name for path in drawn} == {"PT CT CR CT PT", "PT CR PT", "PR"}
    assert [path.field for path in drawn] == sorted((path.field for path in drawn), reverse=True)
    for path in drawn:
        assert np.isfinite(path.places).all()
        before, end = path.places[:, -2], path.places[:, -1]
        back = before + (focus - before[:, 2:]) / (end - before)[:, 2:] * (end - before)
        assert (np.hypot(back[:, 0], back[:, 1]) < detector_of(config).radius).all()
    far = drawn[0].places[:, 0, 0]
    assert far.min() < -0.2
    assert far.max() > 0.2


def test_paths_of_a_general_scene_have_names_that_read() -> None:
    shells = [{"medium": "myelin", "thickness": "0.2 um"}]
    scene = {
        "refractive_index": {"myelin": 1.44},
        "cylinders": [{"medium": "neuron", "shells": shells}],
    }
    drawn = drawn_rays(load_config({"scene": scene}), 1.4, 0.8824, -1.0, paths=2)
    assert "glass T myelin R glass T" in {path.name for path in drawn}
    for path in drawn:
        assert path.places.shape[1] == len(path.name.split()) // 2 + 2


@pytest.mark.parametrize("scheme", ["vogel", "fullwave"])
def test_each_point_of_the_aperture_has_the_path_that_its_ray_comes_back_on(scheme: str) -> None:
    config = load_config({"tracing": {"scheme": scheme}})
    lit = lit_aperture(config, 1.4, 0.8824)
    assert lit.names == [one.name for one in drawn_rays(config, 1.4, 0.8824, -1.0)]
    radius = np.hypot(lit.x, lit.y)
    assert radius.max() == pytest.approx(1)
    # on a cylinder along y, light comes back from where it heads for the axis
    back = lit.path >= 0
    assert 0 < back.sum() < 0.2 * back.size
    assert np.abs(lit.y[back]).max() < 0.15
    # the far side is reached from all over x, the plane reflects what is near the axis
    far, plane = (lit.path == lit.names.index(name) for name in ("PT CT CR CT PT", "PR"))
    assert np.abs(lit.x[far]).max() > 0.4
    assert radius[plane].max() < 0.2


def test_at_a_focus_on_the_glass_the_whole_aperture_comes_back_from_it() -> None:
    lit = lit_aperture(load_config({}), 1.4, 0.0)
    assert (lit.path == lit.names.index("PR")).mean() > 0.95
