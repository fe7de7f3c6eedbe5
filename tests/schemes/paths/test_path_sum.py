"""Fields of paths interpolated in k, beside the literal sum of their rays."""

import numpy as np
import pytest
from numpy.typing import NDArray

from octsim.schemes.light import Field
from octsim.schemes.paths.path_sum import field_of_paths

Array = NDArray[np.float64]
PATH = np.array([7, 7, 7, 3, 3, 12])
AMPLITUDE = np.array([1e-3, 2e-3, -1e-3, 3e-3, 1e-3, -2e-3])
LENGTH = np.array([0.5, 0.6, 0.8, 4.0, 4.1, -2.0])
K = np.linspace(7.0, 9.7, 301)  # more than are turned in a row


def literal(amplitude: Array, length: Array) -> NDArray[np.complex128]:
    waves: NDArray[np.complex128] = np.exp(1j * np.outer(K, length)) @ amplitude
    return waves


def found(rough: Array, length: Array, missing: float, accuracy: float) -> Field:
    return field_of_paths(PATH, AMPLITUDE, rough, length, missing, K, accuracy)


@pytest.mark.parametrize("accuracy", [1e-4, 1e-9])
def test_paths_add_up_to_their_rays(accuracy: float) -> None:
    field = found(AMPLITUDE, LENGTH, 0.0, accuracy)
    off = np.abs(field.values[0] - literal(AMPLITUDE, LENGTH)).max()
    # of the largest path; what is left out of each is said
    assert off <= field.error + 1e-15 <= 0.01 * accuracy * 4e-3


def test_rays_of_a_path_that_lie_far_apart_are_added_one_by_one() -> None:
    length = LENGTH + np.array([0.0, 150.0, 0.0, 0.0, -190.0, 0.0])
    rough = AMPLITUDE * np.array([1.01, 0.98, 1.0, 0.99, 1.05, 1.0])
    field = found(rough, length, 2e-6, 1e-9)
    assert field.values[0] == pytest.approx(literal(AMPLITUDE, length), abs=1e-14)
    # the error of each path is the largest over the band
    off = [(code == PATH) * (AMPLITUDE - rough) for code in (7, 3, 12)]
    expected = sum(float(np.abs(literal(part, length)).max()) for part in off)
    assert field.error == pytest.approx(expected + 2e-6, rel=1e-6)


def test_a_rougher_rule_s_difference_is_in_the_error_of_paths_that_are_interpolated() -> None:
    rough = 0.97 * AMPLITUDE
    field = found(rough, LENGTH, 0.0, 1e-9)
    expected = sum(
        float(np.abs(literal((code == PATH) * 0.03 * AMPLITUDE, LENGTH)).max())
        for code in (7, 3, 12)
    )
    # looked for at a few wavenumbers
    assert 0.98 * expected <= field.error <= expected * (1 + 1e-6)


def test_without_rays_there_is_no_field_but_what_is_missing() -> None:
    none = np.zeros(0)
    field = field_of_paths(np.zeros(0, np.int64), none, none, none, 3e-6, K, 1e-4)
    assert not field.values.any()
    assert field.values.shape == (1, K.size)
    assert field.error == 3e-6
