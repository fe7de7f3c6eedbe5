"""Light through an immersion's slide beside the same slide as a layer that is traced."""

from typing import Any

import numpy as np
import pytest

import octsim
from octsim.config.derive import merge

THICK, OIL = 30.0, 1.45
SLIDE = {"medium": "glass", "thickness": f"{THICK} um"}


def scan(overlay: dict[str, Any], start: float, stop: float) -> tuple[Any, Any]:
    config = merge(
        {
            "tracing": {"scheme": "paths", "accuracy": 1e-4},
            "objective": {"numerical_aperture": 0.9},
            "scene": {"refractive_index": {"oil": OIL}},
            "sweep": {"diameters": {"start": "1.4 um", "stop": "1.5 um", "num": 2}},
            "focus_scan": {
                "diameter": "1.4 um",
                "focus": {"start": f"{start} um", "stop": f"{stop} um", "num": 61},
            },
        },
        overlay,
    )
    found = octsim.focus_scan(octsim.load_config(config))
    return found.focus.to_numpy(), found.intensity.to_numpy()


@pytest.mark.filterwarnings("ignore::octsim.base.errors.OctsimWarning")
def test_the_aberration_of_a_slide_is_that_of_rays_through_it() -> None:
    by_terms = {"objective": {"immersion": "oil"}, "scene": {"layers": [SLIDE, "water"]}}
    traced = {"scene": {"layers": ["oil", SLIDE, "water"]}}
    focus, intensity = scan(by_terms, -0.15, 0.45)
    other_focus, other = scan(traced, 28.1, 28.7)
    assert intensity.max() == pytest.approx(other.max(), rel=0.02)
    # of the objective's foci those in oil are as much closer together as its index is lower
    at, other_at = focus[intensity.argmax()], other_focus[other.argmax()]
    offsets = np.linspace(-0.2, 0.2, 9)
    shape = np.interp(at + offsets, focus, intensity) / intensity.max()
    other_shape = np.interp(other_at + offsets * OIL / 1.52, other_focus, other) / other.max()
    np.testing.assert_allclose(shape, other_shape, atol=0.06)
    # it is no symmetric blur: the two sides of the focus differ by more than that
    assert shape[6] - shape[2] > 0.2
