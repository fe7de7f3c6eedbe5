"""What a detector accepts, and how it weighs what arrives."""

import math

import numpy as np
import pytest

from octsim.config.load import load_config
from octsim.instrument.build import detector_of, scene_of
from octsim.optics.beam import aim, vogel_beam
from octsim.optics.detector import (
    Acceptance,
    Outcome,
    acceptance,
    falloff,
    fate,
    rim_margin,
    weight,
)
from octsim.tracing.tree import arrivals

CONFIG = load_config({"tracing": {"rays": 400}})
DETECTOR = detector_of(CONFIG)


def test_the_falloff_is_a_parabola_that_ends_at_the_detector_s_radius() -> None:
    assert (falloff(0.0), falloff(1.0)) == (1.0, 0.0)
    assert falloff(0.3**2, 0.4**2) == pytest.approx(0.75, rel=1e-15)
    x = np.array([0.0, 0.3, 0.0, 0.6]) * DETECTOR.radius
    y = np.array([0.0, 0.4, 1.0, 0.8]) * DETECTOR.radius
    assert weight(DETECTOR, x, y) == pytest.approx([1.0, 0.75, 0.0, 0.0], abs=1e-15)


def test_infinite_radii_accept_every_ray_that_returns() -> None:
    within = acceptance(DETECTOR)
    far = 4 * DETECTOR.objective_radius**2
    assert fate(within, far, 0.0) == Outcome.OFF_DETECTOR
    assert fate(within, 0.0, far) == Outcome.OFF_OBJECTIVE
    assert fate(Acceptance(math.inf, math.inf), far, far) == Outcome.DETECTED


def test_the_margin_at_the_rim_changes_sign_where_rays_are_no_longer_accepted() -> None:
    for part in (0.0, 0.5, 0.999, 1.001, 2.0):
        vx, vy, vz = aim(part * DETECTOR.objective_radius, 0.0, DETECTOR.focus_distance)
        assert (rim_margin(DETECTOR, 0.0, 0.0, vx, vy, vz) > 0) == (part < 1)


def test_the_margin_at_the_rim_is_that_of_where_a_ray_meets_the_objective() -> None:
    x, y, vx, vy = 1.5, -2.5, 0.31, -0.42
    vz = math.sqrt(1 - vx**2 - vy**2)
    # on to the objective: it returns downwards, and the objective's plane lies below the focus
    at_x, at_y = (at + DETECTOR.focus_distance * v / vz for at, v in ((x, vx), (y, vy)))
    expected = vz**2 * (1 - (at_x**2 + at_y**2) / DETECTOR.objective_radius**2)
    for sign in (1, -1):
        given = sign * x * vz, sign * y * vz, sign * vx, sign * vy
        assert rim_margin(DETECTOR, *given, vz) == pytest.approx(expected, rel=1e-9)


def test_arrivals_are_within_the_detector_and_the_objective() -> None:
    beam = vogel_beam(400, DETECTOR.objective_radius, DETECTOR.focus_distance)
    found = arrivals(scene_of(CONFIG, 1.4), beam, DETECTOR, 0.5)
    assert 0 < found.x.size < 4000
    assert (np.hypot(found.x, found.y) < DETECTOR.radius).all()
    vz = np.sqrt(1 - found.vx**2 - found.vy**2)  # heading down, taken back to the objective
    at_x = found.x + DETECTOR.focus_distance * found.vx / vz
    at_y = found.y + DETECTOR.focus_distance * found.vy / vz
    assert (np.hypot(at_x, at_y) <= DETECTOR.objective_radius * (1 + 1e-9)).all()
