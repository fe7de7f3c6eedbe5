"""The rays of a picture are detected ones of the strongest light paths, spread out."""

import numpy as np
import pytest

from octsim.config.load import load_config
from octsim.instrument.build import detector_of
from octsim.instrument.drawn_rays import drawn_rays


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
