"""Dispersion over the band: what is put on a fringe is found, where enough oscillations are."""

import numpy as np
import pytest
from numpy.typing import NDArray

from octsim.base.errors import ConfigError
from octsim.measured.dispersion import fitted, phase_over

K = np.linspace(7.0, 9.6, 1024)


def fringe(depth: float, a2: float, a3: float) -> NDArray[np.float64]:
    envelope = np.exp(-4 * ((K - K.mean()) / np.ptp(K)) ** 2 * 2)
    return np.asarray(envelope * np.cos(2 * depth * (K - K.mean()) + 0.7 + phase_over(K, a2, a3)))


@pytest.mark.parametrize(("a2", "a3"), [(0.0, 0.0), (12.0, 0.0), (-20.0, 3.0), (4.0, -2.0)])
def test_the_sharpest_peak_is_the_one_without_it(a2: float, a3: float) -> None:
    found = fitted(fringe(60.0, a2, a3), K)
    assert found[0] == pytest.approx(a2, abs=0.02)
    # a part of the third order is a shift of the depth, by which a peak is as sharp
    left = phase_over(K, found[0] - a2, found[1] - a3)
    x = np.linspace(-1, 1, K.size)
    weight = np.exp(-8 * (x / 2) ** 2 * 4)
    line = np.polynomial.Polynomial.fit(x, left, 1, w=np.sqrt(weight))(x)
    assert np.sqrt((weight * (left - line) ** 2).mean()) < 0.05


def test_few_oscillations_tell_nothing_of_it() -> None:
    with pytest.raises(ConfigError, match=r"dispersion: fit given, but the fringe has"):
        fitted(fringe(4.0, 0.0, 0.0), K)


def test_it_is_given_at_the_edge_of_the_band() -> None:
    found = phase_over(K, 2.0, 0.5)
    assert found[0] == pytest.approx(1.5)
    assert found[-1] == pytest.approx(2.5)
