"""Counted rays with effects: what is traced one share after the other is the light of all."""

from typing import Any

import numpy as np
import pytest

from octsim.config.load import load_config
from octsim.instrument.instrument import Instrument
from octsim.schemes import counted_over_band, returned_rays
from octsim.schemes.light import Light, Sampled

EFFECTS: dict[str, dict[str, Any]] = {
    "a pupil": {"objective": {"pupil": {"gaussian": 0.9}}},
    "absorption": {"scene": {"attenuation": {"neuron": "1000 /cm"}}},
    "another index of each colour": {
        "scene": {"refractive_index": {"neuron": {"cauchy": [1.38, 0.004]}}}
    },
}


def light_of(effect: dict[str, Any], rays: int = 60, samples: int = 3) -> Light | Sampled:
    settings = {"tracing": {"scheme": "vogel", "rays": rays}, "spectrum": {"samples": samples}}
    light = Instrument(load_config(settings, effect)).light(1.4, 0.9)
    assert isinstance(light, Light | Sampled)
    return light


@pytest.mark.parametrize("effect", EFFECTS.values(), ids=EFFECTS)
def test_shares_of_rays_add_up_to_the_light_of_all(
    effect: dict[str, Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    whole = light_of(effect)
    monkeypatch.setattr(returned_rays, "rays_at_once", lambda *_: 20)
    shared = light_of(effect)
    if isinstance(whole, Sampled):
        assert isinstance(shared, Sampled)
        np.testing.assert_allclose(shared.values, whole.values, rtol=0, atol=1e-15)
        whole, shared = whole.rays, shared.rays
    assert isinstance(whole, Light)
    assert isinstance(shared, Light)
    assert whole.path.size > 3
    # rays come in the order in which they were traced
    orders = [np.lexsort((one.optical_path_length, one.path)) for one in (shared, whole)]
    for name in Light._fields:
        one, other = getattr(shared, name), getattr(whole, name)
        if np.shape(one)[-1:] == whole.path.shape:
            one, other = one[..., orders[0]], other[..., orders[1]]
        np.testing.assert_array_equal(one, other, name)


@pytest.mark.parametrize("rays", [15, 30])
def test_rays_between_nodes_have_the_field_of_those_traced_at_every_wavenumber(
    rays: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    each = {"glass": [1.48, 0.02], "neuron": [1.36, 0.02], "water": [1.3, 0.02]}
    indices = {name: {"cauchy": given} for name, given in each.items()}
    steep = {"scene": {"refractive_index": indices}}
    one_by_one = light_of(steep, rays, 12)
    monkeypatch.setattr(counted_over_band, "_FEW", 0)
    between = light_of(steep, rays, 12)
    assert isinstance(one_by_one, Sampled)
    assert isinstance(between, Sampled)
    size = np.abs(one_by_one.values).max()
    np.testing.assert_allclose(between.values, one_by_one.values, rtol=0, atol=1e-10 * size)
    assert between.segments != one_by_one.segments
