"""Conical reflection beside Fresnel's coefficients of s and p light."""

import numpy as np
import pytest

from octsim.schemes.fullwave.plane import fresnel, normal, reflection


@pytest.mark.parametrize(("n", "beyond", "upwards"), [(1.52, 1.33, True), (1.33, 1.52, False)])
@pytest.mark.parametrize("across", [0.2, 0.7, -0.7])
@pytest.mark.parametrize("along", [0.3, -0.9])
def test_it_is_fresnels_for_the_light_turned_into_s_and_p(
    n: float, beyond: float, upwards: bool, across: float, along: float
) -> None:
    up = 1 if upwards else -1
    sine = np.hypot(across, along)
    c, s = across / sine, along / sine
    here, there = (np.sqrt(index**2 - sine**2) for index in (n, beyond))
    e_s = (here - there) / (here + there)
    h_p = (here / n**2 - there / beyond**2) / (here / n**2 + there / beyond**2)

    def turned(sign: int) -> np.ndarray:
        """E_y and Z₀H_y of s light and of p light that travels upwards, or downwards."""
        cosine = sign * here / n
        return np.array([[c, cosine * s], [-n * cosine * s, n * c]])

    expected = turned(-up) @ np.diag([e_s, h_p]) @ np.linalg.inv(turned(up))
    found = reflection(
        np.array(along), np.array(across), np.array(here), np.array(there), n, beyond, upwards
    )
    matrix = np.array([[found.ee, found.eh], [found.he, found.hh]])
    np.testing.assert_allclose(matrix, expected, rtol=0, atol=1e-14)


def test_a_plane_between_equal_media_reflects_exactly_nothing() -> None:
    along, across = np.array([0.0, 0.4, 0.9]), np.array([0.1, 0.5, 0.7])
    here = normal(1.33, np.hypot(along, across))
    assert all(
        (part == 0).all() for part in reflection(along, across, here, here, 1.33, 1.33, True)
    )
    assert all((part == 0).all() for part in fresnel(here, here, 1.33, 1.33))
