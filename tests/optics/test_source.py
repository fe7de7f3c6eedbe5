"""Sources: a Gaussian by its width, a measured one through its rows."""

import numpy as np
import pytest

from octsim.optics.source import GaussianSource, MeasuredSource


def at(*wavelengths: float) -> np.ndarray[tuple[int], np.dtype[np.float64]]:
    return 2 * np.pi / np.array(wavelengths)


def test_a_gaussian_is_half_as_bright_half_a_width_away() -> None:
    source = GaussianSource(0.84, 0.05)
    np.testing.assert_allclose(
        source.power(at(0.84, 0.815, 0.865, 0.89)), [1, 0.5, 0.5, 1 / 16], rtol=1e-12
    )


def test_a_measured_source_goes_through_its_rows_and_no_higher() -> None:
    source = MeasuredSource((0.7, 0.75, 0.8, 0.85), (0.0, 40.0, 10.0, 10.0))
    np.testing.assert_allclose(
        source.power(at(0.7, 0.75, 0.8, 0.85)), [0, 1, 0.25, 0.25], atol=1e-12
    )
    between = source.power(at(*np.linspace(0.7, 0.85, 301)))
    assert between.min() >= 0
    assert between.max() <= 1


def test_beyond_its_rows_it_is_not_known() -> None:
    with pytest.raises(ValueError, match=r"known from 0\.7 to 0\.85 um"):
        MeasuredSource((0.7, 0.85), (1.0, 1.0)).power(at(0.86))
