"""Samples that a camera cut are seen; those that noise or rounding make equal are not."""

import numpy as np
import pytest

from octsim.phase.cut_samples import are_cut

X = np.linspace(-1, 1, 1024)


def fringes(level: float, oscillations: float, count: int = 300) -> np.ndarray:
    phase = np.linspace(0, 2 * np.pi, count)[:, np.newaxis]
    return np.asarray(level * (1 + 0.95 * np.cos(np.pi * oscillations * X + phase)))


@pytest.mark.parametrize("level", [5, 50, 2600])
@pytest.mark.parametrize("oscillations", [0.8, 1.7, 20.0])
def test_whole_numbers_are_not_cut(level: float, oscillations: float) -> None:
    random = np.random.default_rng(4)
    expected = fringes(level, oscillations)
    assert not are_cut(np.round(expected)).any()
    assert not are_cut(expected).any()
    # three of a kind may happen, four with none near are rare
    assert are_cut(random.poisson(expected).astype(float)).mean() <= 0.01


@pytest.mark.parametrize("oscillations", [1.7, 5.0])
def test_samples_cut_at_the_top_or_the_bottom_are_seen(oscillations: float) -> None:
    random = np.random.default_rng(5)
    noisy = np.round(fringes(2600, oscillations) + 20 * random.normal(size=(300, X.size)))
    assert are_cut(np.minimum(noisy, 4095)).all()
    assert are_cut(np.maximum(noisy, 600)).all()
    assert are_cut(np.minimum(fringes(1.0, oscillations), 1.9)).all()


def test_a_constant_spectrum_is_not_cut() -> None:
    assert not are_cut(np.ones((1, 50))).any()
