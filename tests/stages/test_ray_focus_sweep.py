"""The intensity over the focus by light paths, of a run whose scheme has none."""

import numpy as np

import octsim
from octsim.config.derive import merge
from octsim.stages.focus_law import LawScheme

SMALL = {
    "focus_law": {"diameters": {"num": 3}, "fraction": {"num": 9}},
    "spectrum": {"samples": 40},
}
WAVES = merge(SMALL, {"tracing": {"preset": "exact"}})
PATHS = merge(SMALL, {"tracing": {"preset": "standard"}})


def test_it_is_the_focus_sweep_of_light_paths_to_the_bit() -> None:
    by_rays = octsim.ray_focus_sweep(octsim.load_config(WAVES))
    own = octsim.focus_sweep(octsim.load_config(PATHS))
    for name in ("intensity", "intensity_error", "accuracy_status", "focus"):
        assert np.array_equal(by_rays[name], own[name])


def test_it_is_of_the_scene_that_waves_are_in() -> None:
    beyond = {"scene": {"cylinders": [{"medium": "neuron", "x": "50 nm", "azimuth": "5 deg"}]}}
    by_rays = octsim.ray_focus_sweep(octsim.load_config(WAVES, beyond))
    own = octsim.focus_sweep(octsim.load_config(PATHS, beyond))
    assert np.array_equal(by_rays["intensity"], own["intensity"])


def test_the_focus_law_of_waves_is_that_of_light_paths_and_says_so() -> None:
    config = octsim.load_config(WAVES)
    fits = octsim.gaussian_fits(config, octsim.focus_sweep(config))
    law = octsim.focus_law(config, fits, octsim.ray_focus_sweep(config))
    rays = octsim.load_config(PATHS)
    expected = octsim.focus_law(rays, octsim.gaussian_fits(rays, octsim.focus_sweep(rays)))
    assert LawScheme(int(law["law_scheme"])) == LawScheme["paths"]
    assert float(law["slope"]) == float(expected["slope"])
    assert float(law["intercept"]) == float(expected["intercept"])
