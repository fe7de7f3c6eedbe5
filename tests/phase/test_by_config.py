"""Phases of measured spectra by the estimator that a config names, with the source's spectrum."""

import warnings
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from numpy.typing import NDArray

import octsim
from octsim.base.errors import ConfigError, DatasetError, OctsimWarning
from octsim.optics.source import GaussianSource

WAVENUMBER = np.linspace(2 * np.pi / 0.9, 2 * np.pi / 0.65, 800)
SOURCE = GaussianSource(0.77, 0.1)
PHASES = np.array([0.3, -2.0, 1.1])


def dataset(intensity: NDArray[np.float64]) -> xr.Dataset:
    return xr.Dataset(
        {"intensity": (("spectrum", "wavenumber"), np.atleast_2d(intensity))},
        {"wavenumber": ("wavenumber", WAVENUMBER, {"units": "um-1"})},
    )


def lit() -> xr.Dataset:
    turn = 2 * 1.95 * (WAVENUMBER - WAVENUMBER.mean()) + PHASES[:, np.newaxis]
    return dataset(700 * SOURCE.power(WAVENUMBER) * (2 + 0.6 * np.cos(turn)))


def reference() -> xr.Dataset:
    return dataset(4e4 * SOURCE.power(WAVENUMBER) * np.array([[1.0], [1.02]]))


def test_phases_with_the_source_s_spectrum_are_those_of_a_flat_source(tmp_path: Path) -> None:
    reference().to_netcdf(tmp_path / "source.nc")
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        for given in (reference(), tmp_path / "source.nc", SOURCE):
            found = octsim.phase_of(lit(), reference=given)
            assert np.abs(found.phase - PHASES).max() < 1e-6
            assert np.abs(found.visibility - 0.3).max() < 1e-6


def test_without_the_source_s_spectrum_it_is_warned_of() -> None:
    with pytest.warns(OctsimWarning, match="poor_fit at 1 of 3 spectra: divide"):
        octsim.phase_of(lit())


@pytest.mark.parametrize(
    ("given", "message"),
    [
        (dataset(-SOURCE.power(WAVENUMBER)), "powers from -1 to"),
        (reference().isel(wavenumber=slice(100, None)), "the source is known from"),
        (dataset(np.zeros(WAVENUMBER.size)), "powers from 0 to 0"),
    ],
    ids=["negative", "too narrow", "dark"],
)
def test_a_reference_that_is_no_source_is_refused(given: xr.Dataset, message: str) -> None:
    with pytest.raises(DatasetError, match=f"^reference: .*{message}"):
        octsim.phase_of(lit(), reference=given)


def test_the_samples_of_a_band_alone_may_be_used() -> None:
    turned = lit()
    # beyond the band something else is seen
    beyond = 2 * np.pi / WAVENUMBER > 0.85
    turned["intensity"][:, beyond] = 0.0
    inner = WAVENUMBER[~beyond]
    found = octsim.phase_of(turned, reference=SOURCE, band=(0.65, 0.85))
    expected = PHASES + 2 * 1.95 * ((inner[0] + inner[-1]) / 2 - WAVENUMBER.mean())
    assert np.abs(np.angle(np.exp(1j * (found.phase - expected)))).max() < 1e-6
    with pytest.raises(ConfigError, match=r"^band: 0\.6 um to 0\.85 um given, but dataset"):
        octsim.phase_of(turned, reference=SOURCE, band=(0.6, 0.85))
