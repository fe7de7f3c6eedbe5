"""Detected intensity beside a literal Jones calculus, and what it keeps."""

from math import cos, pi, sin, sqrt

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from octsim.optics.polarisation import LEFT, RIGHT, UNPOLARISED, Polarisation, jones_rows, linear

ANGLES = st.floats(-pi, pi)
D = np.array([0.3 - 0.4j, -0.7 + 0.2j])


def intensity(polarisation: Polarisation, azimuth: float, d: NDArray[np.complex128] = D) -> float:
    return float(np.mean(np.abs(jones_rows(polarisation, azimuth) @ d) ** 2))


def literal(polarisation: Polarisation, azimuth: float) -> float:
    """Turn the field into the cylinder's frame, return it, turn it back, and project it."""
    axis, across = np.array([-sin(azimuth), cos(azimuth)]), np.array([cos(azimuth), sin(azimuth)])
    returned = D[0] * np.outer(across, across) + D[1] * np.outer(axis, axis)
    states = [polarisation.input] if polarisation.input else [LEFT, RIGHT]  # any two orthogonal
    found = []
    for state in states:
        field = returned @ np.array(state)
        if polarisation.analyser is not None:
            a = polarisation.analyser
            field = np.array([cos(a) * field[0] + sin(a) * field[1]])
        found.append(np.sum(np.abs(field) ** 2))
    return float(np.mean(found))


@given(ANGLES, st.none() | ANGLES | st.sampled_from([LEFT, RIGHT]), st.none() | ANGLES)
def test_intensity_is_that_of_a_literal_jones_calculus(
    azimuth: float, given: float | tuple[complex, complex] | None, analyser: float | None
) -> None:
    state = linear(given) if isinstance(given, float) else given
    polarisation = Polarisation(state, analyser)
    assert intensity(polarisation, azimuth) == pytest.approx(literal(polarisation, azimuth))


@given(ANGLES, st.none() | ANGLES)
def test_two_crossed_analysers_share_out_all_light(azimuth: float, angle: float | None) -> None:
    state = None if angle is None else linear(angle)
    parts = [intensity(Polarisation(state, analyser), azimuth) for analyser in (0.4, 0.4 + pi / 2)]
    assert sum(parts) == pytest.approx(intensity(Polarisation(state), azimuth))


def test_unpolarised_light_is_the_mean_of_both_whatever_the_azimuth() -> None:
    for azimuth in (0.0, 0.7):
        assert jones_rows(UNPOLARISED, azimuth).tolist() == [[1, 0], [0, 1]]


def test_a_quarter_turn_swaps_across_and_along() -> None:
    for state in (linear(0.3), LEFT):
        turned = intensity(Polarisation(state), pi / 2)
        assert turned == pytest.approx(intensity(Polarisation(state), 0.0, D[::-1]))
    assert intensity(Polarisation(linear(0.0)), 0.0) == pytest.approx(abs(D[0]) ** 2)
    assert intensity(Polarisation(linear(0.0)), pi / 2) == pytest.approx(abs(D[1]) ** 2)


def test_a_crossed_analyser_sees_what_differs_between_across_and_along() -> None:
    crossed = Polarisation(linear(pi / 4), -pi / 4)
    assert intensity(crossed, 0.0) == pytest.approx(abs(D[0] - D[1]) ** 2 / 4)
    assert intensity(crossed, 0.0, np.array([0.6, 0.6 + 0j])) == pytest.approx(0, abs=1e-30)


def test_circular_light_has_a_quarter_period_between_its_parts_and_no_preferred_axis() -> None:
    for state, sign in ((LEFT, 1), (RIGHT, -1)):
        assert state[1] / state[0] == pytest.approx(sign * 1j)
        assert sqrt(sum(abs(part) ** 2 for part in state)) == pytest.approx(1)
        for azimuth in (0.0, 0.5):
            mean = float(np.mean(np.abs(D) ** 2))
            assert intensity(Polarisation(state), azimuth) == pytest.approx(mean)
