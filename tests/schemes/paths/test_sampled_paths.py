"""Fields at samples of a band, of light that differs between them, beside closed forms."""

import math
from typing import ClassVar

import numpy as np
import pytest
from numpy.typing import NDArray
from plane_light import APERTURE, GLASS, MAGNIFICATION, objective, plane, returned

from octsim.optics.materials import Constant, Material, Table
from octsim.optics.polarisation import UNPOLARISED
from octsim.optics.pupil import FibrePupil, Pupil, UniformPupil
from octsim.schemes.light import AccuracyStatus, Optics, Sampled
from octsim.schemes.paths.sampled_paths import sampled_paths

MODE = 30.0


class Filter:
    """A pupil that lets light of one part of the band through, and a fifth of the other."""

    varies: ClassVar[bool] = True

    def amplitude(
        self, sine: NDArray[np.float64], aperture: float, wavenumber: float | NDArray[np.float64]
    ) -> NDArray[np.float64]:
        del aperture
        return np.ones_like(sine) * np.where(np.asarray(wavenumber) < 8.2, 1.0, 0.2)


def found(
    beyond: Material, height: float, pupil: Pupil, samples: int, accuracy: float, first: float = 7.0
) -> Sampled:
    k = np.linspace(first, 9.6, samples)
    optics = Optics(
        objective(), (first, 9.6), 11, APERTURE, pupil, UNPOLARISED, k, dispersive=beyond.dispersive
    )
    return sampled_paths(optics, plane(beyond), height, accuracy, False)


def check(light: Sampled, expected: list[complex], accuracy: float) -> None:
    largest = np.abs(expected).max()
    assert light.status == AccuracyStatus.REACHED
    assert light.values.shape == (1, len(expected))
    assert np.abs(light.values[0] - expected).max() <= light.error
    assert 2 * light.error <= accuracy * largest


@pytest.mark.parametrize("height", [0.0, 1.0])
def test_light_that_varies_evenly_is_interpolated_over_the_band(height: float) -> None:
    light = found(Constant(1.33), height, FibrePupil(MODE, MAGNIFICATION), 49, 1e-4)

    def mode(k: float, sine: float) -> float:
        return math.exp(-((k * MODE / 2 * GLASS * sine / (2 * MAGNIFICATION)) ** 2))

    expected = [
        returned(k, height, 1.33, lambda sine, k=k: mode(k, sine))  # type: ignore[misc]
        for k in light.wavenumber.tolist()
    ]
    check(light, expected, 1e-4)


@pytest.mark.parametrize("samples", [12, 25, 40])
def test_where_light_changes_at_once_the_band_is_halved_until_it_does_no_more(
    samples: int,
) -> None:
    light = found(Constant(1.33), 1.0, Filter(), samples, 1e-2)
    weight = np.where(light.wavenumber < 8.2, 1.0, 0.2)
    expected = [
        returned(k, 1.0, 1.33) * w
        for k, w in zip(light.wavenumber.tolist(), weight.tolist(), strict=True)
    ]
    check(light, expected, 1e-2)


def test_with_dispersion_each_sample_is_that_of_its_own_index() -> None:
    table = Table((0.6, 0.74, 0.76, 0.78, 0.95), (1.33, 1.33, 1.36, 1.38, 1.38))
    light = found(table, 1.0, UniformPupil(), 10, 1e-2)
    expected = [returned(k, 1.0, table.index(k).real) for k in light.wavenumber.tolist()]
    check(light, expected, 1e-2)
    # of all nodes together
    assert light.segments > 10 * 100
