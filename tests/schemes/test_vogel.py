"""Counted rays: what their light says of its own error."""

import numpy as np
import pytest

from octsim.config.load import load_config
from octsim.instrument.instrument import Instrument
from octsim.schemes.light import Light

# with an effect rays are traced and weighed elsewhere
OF_BOTH_WAYS: dict[str, dict[str, object]] = {
    "the thesis's": {},
    "with an effect": {"objective": {"pupil": {"gaussian": 0.9}}},
}


def light_of(rays: int, effect: dict[str, object]) -> Light:
    config = load_config({"tracing": {"rays": rays}, "spectrum": {"samples": 40}}, effect)
    light = Instrument(config).light(1.4, 0.9)
    assert isinstance(light, Light)
    return light


@pytest.mark.parametrize("effect", OF_BOTH_WAYS.values(), ids=OF_BOTH_WAYS)
def test_the_rougher_rule_is_every_second_ray_with_the_weight_of_two(
    effect: dict[str, object],
) -> None:
    light = light_of(2000, effect)
    counted = light.rough_amplitude != 0
    assert 0.3 < counted.mean() < 0.7
    assert np.array_equal(light.rough_amplitude[counted], 2 * light.amplitude[counted])
    # so that both are sums of the same light
    both = np.abs(light.rough_amplitude).sum(), np.abs(light.amplitude).sum()
    assert both[0] == pytest.approx(both[1], rel=0.1)
