"""Outliers: samples that stand alone, and none that are part of what moves."""

import numpy as np
import pytest
from numpy.typing import NDArray

from octsim.phase.measured_series import Series
from octsim.phase.outliers import outliers

TIME = 5e-5 * np.arange(400, dtype=np.float64)
NOISE = 1e-3 * np.random.default_rng(7).normal(size=400)


def pulse(width: float) -> NDArray[np.float64]:
    """Give a Gaussian pulse of 24 mrad, and of some width at half height, in samples."""
    at = np.arange(400)
    shape: NDArray[np.float64] = np.exp(-4 * np.log(2) * ((at - 200) / width) ** 2)
    return 0.024 * shape


@pytest.mark.parametrize("places", [[0], [399], [57], [57, 58], [3, 130, 131, 390]])
@pytest.mark.parametrize("size", [0.05, -2.0])
def test_a_sample_or_two_far_from_the_others_are_outliers(places: list[int], size: float) -> None:
    phase = pulse(20) + NOISE
    phase[places] += size
    assert np.flatnonzero(outliers(Series(TIME, phase))).tolist() == places


@pytest.mark.parametrize("width", [2, 3, 5, 20, 100])
def test_what_a_neuron_does_is_none(width: float) -> None:
    assert not outliers(Series(TIME, pulse(width) + NOISE)).any()
    assert not outliers(Series(TIME, pulse(width))).any()


def test_edges_ramps_wraps_and_rounding_are_none() -> None:
    edge = np.where(np.arange(400) < 200, 0.0, 0.5)
    ramp = np.maximum(np.arange(400) - 200, 0) * 0.3
    wrapped = np.angle(np.exp(1j * (3.1 + ramp + NOISE)))
    rounded = 0.01 * np.round((pulse(20) + 5 * NOISE) / 0.01)
    for phase in (edge, edge + NOISE, ramp, wrapped, rounded, np.zeros(400)):
        assert not outliers(Series(TIME, phase)).any()


def test_noise_has_hardly_any() -> None:
    noise = np.random.default_rng(1).normal(size=200_000)
    assert outliers(Series(np.arange(200_000.0), 1e-3 * noise)).sum() <= 5


def test_missing_samples_and_large_errors_are_none() -> None:
    phase = pulse(20) + NOISE
    phase[57] += 0.5
    phase[[56, 58, 200]] = np.nan
    assert np.flatnonzero(outliers(Series(TIME, phase))).tolist() == [57]
    error = np.full(400, 1e-3)
    assert np.flatnonzero(outliers(Series(TIME, phase, error))).tolist() == [57]
    error[57] = 0.2
    assert not outliers(Series(TIME, phase, error)).any()
    assert not outliers(Series(TIME[:4], np.array([0.0, 0, 9, 0]))).any()
