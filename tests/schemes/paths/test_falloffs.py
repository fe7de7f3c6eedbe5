"""Falloffs as compiled code takes them, beside those of the optics."""

import numpy as np
import pytest

from octsim.optics.falloff import Parabolic
from octsim.schemes.paths.falloffs import Parabola, Series, falloff_at, series_of


class Cosine:
    """A falloff that is known in closed form."""

    def amplitude(self, squared: np.ndarray, wavenumber: float) -> np.ndarray:
        return np.cos(0.3 * wavenumber * squared)


def test_a_series_is_the_falloff_that_it_is_made_of() -> None:
    series = series_of(Cosine(), 1.5, 2.0)
    assert isinstance(series, Series)
    for x, y in ((0.0, 0.0), (0.1, 0.25), (0.3, 0.0), (0.0, 0.77), (0.6, 0.4)):
        expected = np.cos(0.6 * 1.5**2 * (x + y))
        assert falloff_at(series, x, y) == pytest.approx(expected, abs=1e-12)
    assert series.edge == pytest.approx(np.cos(0.6 * 1.5**2), abs=1e-14)


def test_beyond_its_edge_a_series_is_what_it_is_there() -> None:
    series = series_of(Cosine(), 1.5, 2.0)
    assert falloff_at(series, 0.9, 0.4) == pytest.approx(series.edge, abs=1e-12)


def test_the_thesis_s_is_the_parabola() -> None:
    assert series_of(Parabolic(), 1.0, 8.0) == Parabola()
    assert falloff_at(Parabola(), 0.25, 0.5) == 0.25
