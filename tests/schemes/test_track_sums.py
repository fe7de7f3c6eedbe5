"""Fields of counted rays, and what the rougher rule has of them."""

import numpy as np
import pytest

from octsim.config.load import load_config
from octsim.instrument.build import optics_of, scene_of
from octsim.schemes.returned_rays import Spiral
from octsim.schemes.track_sums import fields_of


@pytest.mark.parametrize("rays", [10, 11])
def test_the_rougher_field_is_twice_that_of_every_second_ray_of_each_family(rays: int) -> None:
    config = load_config({"objective": {"pupil": {"gaussian": 0.9}}})
    options = {"rays": rays, "min_amplitude": 0.0}
    spiral = Spiral(optics_of(config), options, scene_of(config, 1.4), 0.9, lengths=False)
    k = np.array([8.0])
    numbers = spiral.at(8.0).numbers[:, np.newaxis]
    # of two families, the second of which counts on, whatever number it begins with
    ray = np.arange(numbers.shape[-1]) % (2 * rays)
    own = [*range(rays), *range(rays)]
    second = np.array([own[one] % 2 == 0 for one in ray.tolist()])
    field, rough = fields_of(spiral, ray, numbers, k)
    expected, _ = fields_of(spiral, ray[second], numbers[..., second], k)
    assert np.abs(field).max() > 0
    np.testing.assert_allclose(rough, 2 * expected, rtol=1e-12)
