"""Light through an immersion's slide beside the same slide as a layer that is traced."""

from typing import Any

import numpy as np
import pytest

import octsim
from octsim.config.derive import merge
from octsim.optics.slide import slide_aberration

THICK, OIL, GLASS, APERTURE = 30.0, 1.45, 1.52, 0.9
SLIDE = {"medium": "glass", "thickness": f"{THICK} um"}


def scan(overlay: dict[str, Any], start: float, stop: float) -> tuple[Any, Any]:
    config = merge(
        {
            "tracing": {"rays": 5000},
            "objective": {"numerical_aperture": APERTURE},
            "scene": {"refractive_index": {"oil": OIL}},
            "sweep": {"diameters": {"start": "1.4 um", "stop": "1.5 um", "num": 2}},
            "focus_scan": {
                "diameter": "1.4 um",
                "focus": {"start": f"{start} um", "stop": f"{stop} um", "num": 41},
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
    # where a wave in glass focuses that is, but for the aberration, one in oil to another focus
    s2 = APERTURE**2 * (np.arange(1000) + 0.5) / 1000
    in_oil, in_glass = np.sqrt(OIL**2 - s2), np.sqrt(GLASS**2 - s2)
    closer = np.cov(in_oil, in_glass)[0, 1] / np.var(in_glass, ddof=1)
    raised = slide_aberration(APERTURE, OIL, GLASS, THICK).focus
    at, other_at = focus[intensity.argmax()], other_focus[other.argmax()]
    assert at == pytest.approx(raised + closer * (other_at - THICK), abs=0.03)
    offsets = np.linspace(-0.2, 0.2, 9)
    shape = np.interp(at + offsets, focus, intensity) / intensity.max()
    other_shape = np.interp(other_at + offsets / closer, other_focus, other) / other.max()
    np.testing.assert_allclose(shape, other_shape, atol=0.06)
    # it is no symmetric blur: the two sides of the focus differ by more than that
    assert shape[6] - shape[2] > 0.2
