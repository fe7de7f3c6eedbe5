"""Rays that an aberration turns, beside differences of its wavefront."""

import math

import pytest

from octsim.optics.detector import fibre_detector
from octsim.optics.turned_rays import STRAIGHT, path_by_lens, turned, turning
from octsim.optics.zernike import Aberration

APERTURE, INDEX = 0.9, 1.52
ABERRATION = Aberration(((4, 0.02), (6, -0.03), (7, 0.05), (8, 0.01), (11, 0.04), (12, -0.02)))
LENS = turning(ABERRATION, APERTURE, INDEX)
DIRECTIONS = (0.0, 0.0), (0.3, 0.0), (0.0, -0.2), (0.25, 0.35), (-0.4, 0.1)


def wavefront(px: float, py: float) -> float:
    """Return W by Noll's Table I."""
    r, angle = math.hypot(px, py), math.atan2(py, px)
    by_number = {
        4: math.sqrt(3) * (2 * r**2 - 1),
        6: math.sqrt(6) * r**2 * math.cos(2 * angle),
        7: math.sqrt(8) * (3 * r**3 - 2 * r) * math.sin(angle),
        8: math.sqrt(8) * (3 * r**3 - 2 * r) * math.cos(angle),
        11: math.sqrt(5) * (6 * r**4 - 6 * r**2 + 1),
        12: math.sqrt(10) * (4 * r**4 - 3 * r**2) * math.cos(2 * angle),
    }
    return sum(a * by_number[number] for number, a in ABERRATION.coefficients)


def literal(vx: float, vy: float, sign: float) -> tuple[float, float, float]:
    """Return grad W / NA and W - p grad W at the ray's point of the pupil."""
    px, py = (sign * INDEX * one / APERTURE for one in (vx, vy))
    step = 1e-6
    w_x = (wavefront(px + step, py) - wavefront(px - step, py)) / (2 * step)
    w_y = (wavefront(px, py + step) - wavefront(px, py - step)) / (2 * step)
    return w_x / APERTURE, w_y / APERTURE, wavefront(px, py) - px * w_x - py * w_y


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize(("vx", "vy"), DIRECTIONS)
def test_a_ray_crosses_beside_the_focus_by_the_wavefront_s_gradient(
    vx: float, vy: float, sign: float
) -> None:
    assert turned(LENS, vx, vy, sign) == pytest.approx(literal(vx, vy, sign), abs=1e-8)
    assert turned(STRAIGHT, vx, vy, sign) == (0.0, 0.0, 0.0)


def test_a_turned_ray_s_path_out_is_that_of_the_place_that_it_is_taken_for() -> None:
    detector = fibre_detector(APERTURE, INDEX, 300.0, 20.0, 4.4)
    x, y, vx, vy = 0.7, -0.4, 0.25, 0.35
    across, along, path = literal(vx, vy, 1.0)

    def to_fibre(squared: float) -> float:
        return 20.0 * (math.sqrt(detector.focal_length**2 + squared) - detector.focal_length)

    less = to_fibre((x - across) ** 2 + (y - along) ** 2) - to_fibre(x * x + y * y)
    given = detector, x, y, vx, vy, x * x + y * y
    assert path_by_lens(LENS, *given) == pytest.approx(path + less, abs=1e-8)
    assert path_by_lens(STRAIGHT, *given) == 0
